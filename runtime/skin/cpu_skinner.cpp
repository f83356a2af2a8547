#include "skin/cpu_skinner.h"

#include "core/out_of_memory.h"
#include "skin/skin_positions.h"
#include "skin/vec3_math.h"

namespace limber {

Result<CpuSkinner> CpuSkinner::Create(const SkinMesh& mesh, const RigSpace& space) {
  return CatchOutOfMemory("skin mesh", [&]() -> Result<CpuSkinner> {
    Result<SkinTopology> topology = BuildSkinTopology(mesh, space);
    if (!topology.ok()) return topology.status();
    CpuSkinner skinner;
    skinner.layout_ = SkinLayout(mesh);
    skinner.topology_ = std::move(*topology);
    skinner.relative_.resize(mesh.num_solve_vertices);
    skinner.solve_positions_.resize(mesh.num_solve_vertices);
    skinner.positions_.resize(mesh.num_draw_vertices);
    skinner.normals_.resize(mesh.num_draw_vertices);
    skinner.tangents_.resize(mesh.num_draw_vertices);
    skinner.frames_.resize(skinner.topology_.num_groups());
    return skinner;
  });
}

Status CpuSkinner::SkinPositionsOnly(const SkinTransforms& transforms) {
  LIMBER_RETURN_IF_ERROR(SkinPositions(layout_, {transforms.matrices, {}}, relative_));
  for (size_t v = 0; v < relative_.size(); ++v) {
    solve_positions_[v] = relative_[v] + transforms.origin;
  }
  for (size_t d = 0; d < positions_.size(); ++d) {
    positions_[d] = solve_positions_[topology_.draw_vertices[d].solve_vertex];
  }
  return {};
}

Status CpuSkinner::Skin(const SkinTransforms& transforms) {
  LIMBER_RETURN_IF_ERROR(SkinPositionsOnly(transforms));
  for (uint32_t g = 0; g < topology_.num_groups(); ++g) {
    frames_[g] = ComputeSurfaceFrame(topology_, g, relative_);
  }
  for (size_t d = 0; d < normals_.size(); ++d) {
    const SkinDrawVertex& vertex = topology_.draw_vertices[d];
    ApplyFrame(frames_[vertex.normal_group], vertex, &normals_[d], &tangents_[d]);
  }
  return {};
}

DeformedMesh CpuSkinner::result() const {
  return {solve_positions_, positions_, normals_, tangents_};
}

}  // namespace limber
