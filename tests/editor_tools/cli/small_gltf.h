// A small good character as a GLB made in code, and the knobs that spoil it.
#pragma once

#include "core/vector.h"

#include <array>
#include <cstdint>
#include <string>

namespace limber::test {

// A bar of `length` x 1 x 1 quads along x with two morph targets: bent upwards, and shorter but
// puffed.
struct SmallGltf {
  Vector<std::array<float, 3>> positions;
  Vector<Vector<std::array<float, 3>>> targets;  // displacements
  Vector<uint32_t> indices;
  // A second primitive over the same vertices with only the first `targets_of_second` targets.
  bool has_second_primitive = false;
  size_t targets_of_second = 0;

  std::string ToGlb() const;
};

SmallGltf MakeBar(int length);

}  // namespace limber::test
