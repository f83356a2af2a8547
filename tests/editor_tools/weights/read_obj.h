// The least of an OBJ reader, for test data.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <cstdint>
#include <filesystem>

namespace limber::test {

struct ObjMesh {
  geometry::PointMatrix points;
  Vector<uint32_t> triangles;  // polygons cut into fans
};

// Positions and faces of the file; empty where it cannot be read.
ObjMesh ReadObj(const std::filesystem::path& file);

}  // namespace limber::test
