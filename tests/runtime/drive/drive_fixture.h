// A baked character at rest.
#pragma once

#include "load/rig_loader.h"
#include "solve/pose_solver.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::test {

inline std::shared_ptr<const Rig> LoadTube() {
  const auto rig = LoadRig(std::string(LIMBER_SOURCE_DIR) + "/content/baked/v2/tube.glb");
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? *rig : nullptr;
}

inline float Distance(Vec3 a, Vec3 b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

}  // namespace limber::test
