#include "cli/obj_text.h"

#include "core/vector.h"

#include <algorithm>
#include <cstdio>

namespace limber::cli {

std::string ObjText(const SkinMesh& mesh, const bake::SourceFaces& faces,
                    std::span<const Vec3> solve_positions) {
  Vector<Vec3> positions(std::max(mesh.num_source_vertices, faces.num_vertices));
  for (uint32_t d = 0; d < mesh.num_draw_vertices; ++d) {
    positions[mesh.source_vertex[d]] = solve_positions[mesh.solve_vertex[d]];
  }
  std::string text;
  text.reserve(positions.size() * 44 + faces.corners.size() * 8);
  char line[96];
  for (const Vec3& p : positions) {
    const int length = std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x, p.y, p.z);
    text.append(line, static_cast<size_t>(length));
  }
  size_t corner = 0;
  for (const uint32_t size : faces.sizes) {
    text += 'f';
    for (uint32_t i = 0; i < size; ++i) {
      text += ' ';
      text += std::to_string(uint64_t{faces.corners[corner++]} + 1);
    }
    text += '\n';
  }
  return text;
}

}  // namespace limber::cli
