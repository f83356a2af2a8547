// Wavefront OBJ: positions, texture coordinates, normals and polygons, in the file's own order.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace limber::bake {

struct ObjCorner {
  uint32_t position = 0;
  int32_t texcoord = -1, normal = -1;  // -1: none
};

struct ObjMesh {
  std::string file;                         // for messages
  Vector<std::array<double, 3>> positions;  // v
  Vector<std::array<float, 2>> texcoords;   // vt, v growing upwards as OBJ has it
  Vector<std::array<float, 3>> normals;     // vn, any length
  Vector<uint32_t> face_sizes;              // corners of each face, 3 or more
  Vector<ObjCorner> corners;                // of all faces, one after the other
};

// Groups, materials, lines and whatever else OBJ has are passed over; indices may be negative
// (counted from the end). Errors "<file>:<line>: <reason>": kNotFound, kIoError, kMalformed (not a
// number, an index out of range, a face of fewer than three corners), kLimitExceeded.
Result<ObjMesh> ReadObj(const std::filesystem::path& path);
Result<ObjMesh> ParseObj(std::string_view text, const std::string& name);

}  // namespace limber::bake
