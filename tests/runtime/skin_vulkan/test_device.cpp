#include "runtime/skin_vulkan/test_device.h"

#include <dlfcn.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#ifdef __SANITIZE_ADDRESS__
// Read by the leak checker: the validation layer leaves some of its own objects behind. Nothing of
// Limber's is silenced: its allocations do not come from within that library.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the checker's own name
extern "C" const char* __lsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libVkLayer_khronos_validation";
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
#endif

namespace limber::test {
namespace {

std::string FindLavapipe() {
  for (const char* folder :
       {"/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"}) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().filename().string().starts_with("lvp_icd")) return entry.path().string();
    }
  }
  return {};
}

void KeepLoaded(const std::string& icd) {
  std::ifstream file(icd);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object()) return;
  const auto driver = json.value("ICD", nlohmann::json::object()).value("library_path", "");
  if (!driver.empty()) dlopen(driver.c_str(), RTLD_NOW | RTLD_NODELETE);
  dlopen("libVkLayer_khronos_validation.so", RTLD_NOW | RTLD_NODELETE);
}

}  // namespace

std::string PrepareVulkan() {
  std::string icd;
  if (const char* pinned = std::getenv("VK_ICD_FILENAMES"); pinned != nullptr) {
    icd = pinned;
  } else {
    icd = FindLavapipe();
    if (icd.empty()) return "Mesa's lavapipe (package mesa-vulkan-drivers) is not installed";
    setenv("VK_ICD_FILENAMES", icd.c_str(), 1);
  }
  KeepLoaded(icd);
  return {};
}

viewer::VulkanDevice* SharedDevice(std::string* reason) {
  static std::string failure = PrepareVulkan();
  static const std::unique_ptr<viewer::VulkanDevice> device =
      []() -> std::unique_ptr<viewer::VulkanDevice> {
    if (!failure.empty()) return nullptr;
    viewer::DeviceOptions options;
    options.validation = true;
    auto made = viewer::VulkanDevice::Create(options);
    if (made.ok()) return std::move(*made);
    failure = made.status().message();
    return nullptr;
  }();
  *reason = failure;
  return device.get();
}

void GpuTest::SetUp() {
  std::string reason;
  device_ = SharedDevice(&reason);
  if (device_ == nullptr) GTEST_SKIP() << "no Vulkan device: " << reason;
  device_->validation_log().Clear();
}

void GpuTest::TearDown() {
  if (device_ == nullptr) return;
  EXPECT_EQ(device_->validation_log().count(), 0);
  for (const std::string& message : device_->validation_log().messages()) {
    ADD_FAILURE() << message;
  }
}

}  // namespace limber::test
