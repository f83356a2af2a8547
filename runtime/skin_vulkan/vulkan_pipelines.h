// The two compute pipelines of one character and the layouts they share.
#pragma once

#include "skin_vulkan/vulkan_api.h"

namespace limber {

struct SkinPipelineOptions {
  uint32_t num_handles = 1, num_shapes = 1;  // specialisation constants
  bool matrices_in_storage = false;          // false: in a uniform buffer
  VkPipelineCache cache = VK_NULL_HANDLE;
};

class SkinPipelines {
 public:
  SkinPipelines() = default;
  SkinPipelines(const SkinPipelines&) = delete;
  SkinPipelines& operator=(const SkinPipelines&) = delete;
  ~SkinPipelines();

  // `api` must outlive the object. Errors: kDeviceError. May be called once.
  Status Create(const VulkanApi& api, const SkinPipelineOptions& options);

  VkDescriptorSetLayout set_layout() const { return set_layout_; }

  VkPipelineLayout layout() const { return layout_; }

  VkPipeline positions() const { return positions_; }

  VkPipeline frames() const { return frames_; }

  VkDescriptorType matrices_type() const { return matrices_type_; }

 private:
  Status CreateLayouts();
  Status CreatePipeline(const uint32_t* words, size_t bytes, const SkinPipelineOptions& options,
                        VkPipeline* pipeline);

  const VulkanApi* api_ = nullptr;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline positions_ = VK_NULL_HANDLE, frames_ = VK_NULL_HANDLE;
  VkDescriptorType matrices_type_ = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
};

}  // namespace limber
