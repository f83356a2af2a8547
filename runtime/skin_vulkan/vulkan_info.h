// Vulkan's tagged structures, zeroed but for their tag.
#pragma once

#include <vulkan/vulkan_core.h>

namespace limber {

template <class Info>
Info VulkanInfo(VkStructureType type) {
  Info info{};
  info.sType = type;
  return info;
}

}  // namespace limber
