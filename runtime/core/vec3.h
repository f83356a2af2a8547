// Three floats as they lie in files and buffers. Mathematics is done in Eigen inside the rooms.
#pragma once

namespace limber {

struct Vec3 {
  float x = 0, y = 0, z = 0;

  float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  float& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }

  friend bool operator==(const Vec3&, const Vec3&) = default;
};

static_assert(sizeof(Vec3) == 12, "tightly packed, as in a vertex buffer");

}  // namespace limber
