// Even triangle meshes of outlines in the plane.
#pragma once

#include "generate/character.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace limber::content {

using PlaneField = std::function<double(const Vector2d&)>;  // negative inside, about a distance

struct PlanarMesh {
  std::vector<Vector2d> positions;  // those on the outline first
  uint32_t num_outline = 0;
  std::vector<uint32_t> triangles;  // counter-clockwise
};

// Triangles with edges of about `spacing` that fill the inside of `field` within the box: points
// evenly along each outline, a hexagonal grid within, Delaunay, relaxed. `field` must be smooth at
// the scale of `spacing`.
PlanarMesh FillOutline(const PlaneField& field, const Vector2d& low, const Vector2d& high,
                       double spacing);

}  // namespace limber::content
