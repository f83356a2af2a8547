// What is drawn into: a multisampled colour and depth pair resolved into one picture, and the
// shadow map; with the two render passes.
#pragma once

#include "viewer/gpu_image.h"

namespace limber::viewer {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_UNORM;  // sRGB-encoded by the shaders
inline constexpr uint32_t kShadowSize = 1024;

class RenderTargets {
 public:
  RenderTargets() = default;
  RenderTargets(const RenderTargets&) = delete;
  RenderTargets& operator=(const RenderTargets&) = delete;
  ~RenderTargets();

  // Once. Errors: kDeviceError.
  Status Create(VulkanDevice* device);
  // Makes the pictures of this size anew; the device must be idle. Errors: kInvalidArgument (zero,
  // or larger than the device can draw), kDeviceError.
  Status Resize(VkExtent2D extent);

  VkRenderPass color_pass() const { return color_pass_; }

  VkRenderPass shadow_pass() const { return shadow_pass_; }

  VkSampleCountFlagBits samples() const { return samples_; }

  VkExtent2D extent() const { return extent_; }

  VkImage picture() const { return resolved_.handle(); }

  VkImageView shadow_map() const { return shadow_.view(); }

  // Clear, viewport and scissor included; end with vkCmdEndRenderPass.
  void BeginColor(VkCommandBuffer commands) const;
  void BeginShadow(VkCommandBuffer commands) const;

 private:
  Status CreateColorPass();
  Status CreateShadowPass();
  Status CreateShadowMap();
  Status CreateFramebuffer(VkRenderPass pass, std::initializer_list<VkImageView> views,
                           VkExtent2D extent, VkFramebuffer* framebuffer);

  VulkanDevice* device_ = nullptr;
  VkSampleCountFlagBits samples_ = VK_SAMPLE_COUNT_4_BIT;
  VkFormat depth_format_ = VK_FORMAT_D32_SFLOAT;
  VkExtent2D extent_{0, 0};
  VkRenderPass color_pass_ = VK_NULL_HANDLE, shadow_pass_ = VK_NULL_HANDLE;
  GpuImage color_, depth_, resolved_, shadow_;
  VkFramebuffer framebuffer_ = VK_NULL_HANDLE, shadow_framebuffer_ = VK_NULL_HANDLE;
};

}  // namespace limber::viewer
