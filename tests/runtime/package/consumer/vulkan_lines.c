/* Compiles the README's lines for Vulkan renderers as C99; tests/runtime/host runs them. */
#include <vulkan/vulkan_core.h>

typedef struct Renderer { /* the engine's own */
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  uint32_t frames_in_flight;
} Renderer;

#include "frame_vulkan.h"
