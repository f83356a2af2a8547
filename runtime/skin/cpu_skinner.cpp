#include "skin/cpu_skinner.h"

#include "core/out_of_memory.h"
#include "skin/skin_positions.h"
#include "skin/vec3_math.h"

namespace limber {

Result<std::shared_ptr<const SkinSurface>> SkinSurface::Create(const SkinMesh& mesh,
                                                               const RigSpace& space) {
  using Shared = std::shared_ptr<const SkinSurface>;
  return CatchOutOfMemory("skin mesh", [&]() -> Result<Shared> {
    Result<SkinTopology> topology = BuildSkinTopology(mesh, space);
    if (!topology.ok()) return topology.status();
    return Shared(new SkinSurface{SkinLayout(mesh), std::move(*topology)});
  });
}

Result<CpuSkinner> CpuSkinner::Create(std::shared_ptr<const SkinSurface> surface) {
  if (surface == nullptr) return Error(StatusCode::kInvalidArgument, "no skin surface was given");
  return CatchOutOfMemory("skin", [&]() -> Result<CpuSkinner> {
    CpuSkinner skinner;
    const size_t num_solve = surface->layout.num_vertices();
    const size_t num_draw = surface->topology.draw_vertices.size();
    skinner.relative_.resize(num_solve);
    skinner.solve_positions_.resize(num_solve);
    skinner.positions_.resize(num_draw);
    skinner.normals_.resize(num_draw);
    skinner.tangents_.resize(num_draw);
    skinner.frames_.resize(surface->topology.num_groups());
    skinner.surface_ = std::move(surface);
    return skinner;
  });
}

Result<CpuSkinner> CpuSkinner::Create(const SkinMesh& mesh, const RigSpace& space) {
  auto surface = SkinSurface::Create(mesh, space);
  if (!surface.ok()) return surface.status();
  return Create(std::move(surface).value());
}

Status CpuSkinner::SkinPositionsOnly(const SkinTransforms& transforms) {
  LIMBER_RETURN_IF_ERROR(SkinPositions(surface_->layout, {transforms.matrices, {}}, relative_));
  for (size_t v = 0; v < relative_.size(); ++v) {
    solve_positions_[v] = relative_[v] + transforms.origin;
  }
  for (size_t d = 0; d < positions_.size(); ++d) {
    positions_[d] = solve_positions_[topology().draw_vertices[d].solve_vertex];
  }
  return {};
}

Status CpuSkinner::Skin(const SkinTransforms& transforms) {
  LIMBER_RETURN_IF_ERROR(SkinPositionsOnly(transforms));
  for (uint32_t g = 0; g < topology().num_groups(); ++g) {
    frames_[g] = ComputeSurfaceFrame(topology(), g, relative_);
  }
  for (size_t d = 0; d < normals_.size(); ++d) {
    const SkinDrawVertex& vertex = topology().draw_vertices[d];
    ApplyFrame(frames_[vertex.normal_group], vertex, &normals_[d], &tangents_[d]);
  }
  return {};
}

DeformedMesh CpuSkinner::result() const {
  return {solve_positions_, positions_, normals_, tangents_};
}

}  // namespace limber
