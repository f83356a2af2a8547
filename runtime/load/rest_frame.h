// Rest normals and tangents where a file has none.
#pragma once

#include "core/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limber {

// Area-weighted smooth normals over the welded surface, for each draw vertex; unit length, also
// where there is no area ((0, 0, 1) then). positions [D]; solve_vertex [D], below D: draw vertices
// of the same solve vertex share a normal; triangles 3 each, below D.
std::vector<Vec3> SmoothNormals(std::span<const Vec3> positions,
                                std::span<const uint32_t> solve_vertex,
                                std::span<const uint32_t> triangles);

// Fills vertices whose normal is zero, and all when *normals is empty, from SmoothNormals; makes
// all of unit length.
void CompleteNormals(std::span<const Vec3> positions, std::span<const uint32_t> solve_vertex,
                     std::span<const uint32_t> triangles, std::vector<Vec3>* normals);

// Fills tangents ([4 * D] xyz, handedness) that are zero, and all when *tangents is empty, from the
// first texture coordinates ([2 * D]): the direction of growing u, orthogonal to the normal; the
// handedness says where v grows. Any orthogonal direction where the texture is degenerate.
void CompleteTangents(std::span<const Vec3> positions, std::span<const Vec3> normals,
                      std::span<const float> texcoords, std::span<const uint32_t> triangles,
                      std::vector<float>* tangents);

}  // namespace limber
