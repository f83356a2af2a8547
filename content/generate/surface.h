// Closed triangle meshes of implicit surfaces.
#pragma once

#include "generate/character.h"

#include <functional>
#include <vector>

namespace limber::content {

using Field = std::function<double(const Vector3d&)>;  // negative inside

struct Surface {
  std::vector<Vector3d> positions;
  std::vector<Vector3d> normals;    // unit, outwards: the field's gradient
  std::vector<uint32_t> triangles;  // 3 per triangle
};

// The zero set of `field` inside the box, by surface nets on a grid of the given cell size, then
// evened out: edges flipped towards Delaunay, vertices relaxed along the surface and put back onto
// it. `field` must be smooth near its zero set, and its zero set well inside the box.
Surface ExtractSurface(const Field& field, const Vector3d& low, const Vector3d& high, double cell);

// The unit gradient of `field` by central differences over 2 * step.
Vector3d FieldNormal(const Field& field, const Vector3d& p, double step = 1e-4);

}  // namespace limber::content
