// A context with a rig, for tests of the C interface.
#pragma once

#include "limber/limber.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace limber::test {

inline std::string BakedTube() {
  return std::string(LIMBER_SOURCE_DIR) + "/content/baked/v2/tube.glb";
}

inline Vector<char> ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class CapiTest : public ::testing::Test {
 protected:
  void SetUp() override {
    LimberContextDef def = limberDefaultContextDef();
    def.log_user = &log_;
    def.log = [](void* user, LimberSeverity severity, const char* message) {
      EXPECT_EQ(severity, LIMBER_SEVERITY_ERROR);
      static_cast<Vector<std::string>*>(user)->emplace_back(message);
    };
    ASSERT_EQ(limberCreateContext(&def, &context_), LIMBER_SUCCESS);
    ASSERT_EQ(limberLoadRig(context_, BakedTube().c_str(), nullptr, &rig_), LIMBER_SUCCESS)
        << Message();
    ASSERT_EQ(limberGetRigInfo(context_, rig_, &info_), LIMBER_SUCCESS);
    ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &instance_), LIMBER_SUCCESS)
        << Message();
  }

  void TearDown() override { limberDestroyContext(context_); }

  std::string Message() const {
    std::string message(limberGetLastMessage(context_, nullptr, 0), '\0');
    limberGetLastMessage(context_, message.data(), message.size() + 1);
    return message;
  }

  Vector<std::string> log_;
  LimberContext* context_ = nullptr;
  LimberRigId rig_ = {};
  LimberInstanceId instance_ = {};
  LimberRigInfo info_ = {};
};

}  // namespace limber::test
