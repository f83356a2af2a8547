// Every graphics pipeline of the viewer, with the layouts and samplers that they share.
#pragma once

#include "viewer/device.h"
#include "viewer/render_targets.h"

namespace limber::viewer {

class RenderPipelines {
 public:
  RenderPipelines() = default;
  RenderPipelines(const RenderPipelines&) = delete;
  RenderPipelines& operator=(const RenderPipelines&) = delete;
  ~RenderPipelines();

  // Once. Errors: kDeviceError.
  Status Create(VulkanDevice* device, const RenderTargets& targets);

  VkDescriptorSetLayout frame_layout() const { return frame_layout_; }

  VkDescriptorSetLayout material_layout() const { return material_layout_; }

  VkPipelineLayout layout() const { return layout_; }

  VkSampler shadow_sampler() const { return shadow_sampler_; }

  VkPipeline background() const { return background_; }

  VkPipeline ground() const { return ground_; }

  VkPipeline dots() const { return dots_; }

  VkPipeline shadow() const { return shadow_; }

  VkPipeline character(bool blend, bool double_sided) const {
    return character_[blend ? 1 : 0][double_sided ? 1 : 0];
  }

 private:
  struct Recipe;

  Status CreateLayouts();
  Status CreateSampler();
  Status Build(const Recipe& recipe, VkPipeline* pipeline);

  VulkanDevice* device_ = nullptr;
  VkDescriptorSetLayout frame_layout_ = VK_NULL_HANDLE, material_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkSampler shadow_sampler_ = VK_NULL_HANDLE;
  VkPipeline background_ = VK_NULL_HANDLE, ground_ = VK_NULL_HANDLE, dots_ = VK_NULL_HANDLE;
  VkPipeline shadow_ = VK_NULL_HANDLE;
  VkPipeline character_[2][2] = {};
};

}  // namespace limber::viewer
