// The Vulkan device of a GPU test, with validation and synchronization validation.
#pragma once

#include "viewer/device.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace limber::test {

// Pins VK_ICD_FILENAMES to Mesa's lavapipe where nothing is pinned yet, so that pictures and
// messages do not depend on the machine, and keeps the libraries of driver and validation layer
// loaded (they free part of their memory only at process exit, which a leak checker would report
// after an unload). Call before any use of Vulkan. Returns why there is no Vulkan to test with, or
// an empty string.
std::string PrepareVulkan();

// One device a test program, made at first use; null with a reason where there is none.
viewer::VulkanDevice* SharedDevice(std::string* reason);

// What every GPU test does: skips with a reason where there is no device, and fails if the
// validation layers said anything.
class GpuTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  viewer::VulkanDevice* device_ = nullptr;
};

}  // namespace limber::test
