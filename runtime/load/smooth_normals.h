// Normals for surfaces whose file has none, or has them only in places.
#pragma once

#include "core/vec3.h"
#include "core/vector.h"

#include <cstdint>
#include <span>

namespace limber {

// Area-weighted smooth normals for each draw vertex; unit length, (0, 0, 1) where there is no area.
// positions [D]; shared [D], below D: draw vertices of one number share a normal (welded, or of one
// source vertex); triangles 3 each, below D.
Vector<Vec3> SmoothNormals(std::span<const Vec3> positions, std::span<const uint32_t> shared,
                           std::span<const uint32_t> triangles);

// Makes all of *normals [D] unit length; those that are zero are taken from SmoothNormals.
void CompleteNormals(std::span<const Vec3> positions, std::span<const uint32_t> shared,
                     std::span<const uint32_t> triangles, Vector<Vec3>* normals);

}  // namespace limber
