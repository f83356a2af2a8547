// A rotation as four floats in glTF's order, real part last.
#pragma once

namespace limber {

struct Quaternion {
  float x = 0, y = 0, z = 0, w = 1;

  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

}  // namespace limber
