#include "inspect/vertex_groups.h"

#include "core/vector.h"
#include "load/gltf_mesh.h"
#include "rig/rig_fields.h"

#include <cmath>

namespace limber::inspect {

Result<Vector<int>> ReadVertexGroups(const GltfFile& file, int gltf_mesh, const Rig& rig) {
  const Result<GltfMorphMesh> mesh = ReadMorphMesh(file, gltf_mesh);
  if (!mesh.ok()) return mesh.status();
  const Result<Vector<float>> read = ReadMeshAttribute(file, *mesh, kGroupAttribute, 1);
  if (!read.ok() && read.status().code() == StatusCode::kNotFound) {
    return Error(StatusCode::kNotFound,
                 "%s: mesh \"%s\": it was baked without %s; bake it again to see its edge groups",
                 file.name().c_str(), mesh->name.c_str(), kGroupAttribute);
  }
  if (!read.ok()) return read.status().WithContext(file.name());
  const int num_groups = rig.tables().num_groups;
  Vector<int> groups(rig.mesh().num_solve_vertices, 0);
  for (size_t d = 0; d < read->size(); ++d) {
    const float group = (*read)[d];
    if (!(group >= 0) || group >= static_cast<float>(num_groups) || group != std::floor(group)) {
      return Error(StatusCode::kMalformed, "%s: %s: vertex %zu has %g; expected 0 to %d",
                   file.name().c_str(), kGroupAttribute, d, static_cast<double>(group),
                   num_groups - 1);
    }
    groups[rig.mesh().solve_vertex[d]] = static_cast<int>(group);
  }
  return groups;
}

}  // namespace limber::inspect
