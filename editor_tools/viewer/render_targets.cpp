#include "viewer/render_targets.h"

#include <array>
#include <span>

namespace limber::viewer {
namespace {

VkAttachmentDescription Attachment(VkFormat format, VkSampleCountFlagBits samples,
                                   VkAttachmentStoreOp store, VkImageLayout final_layout) {
  VkAttachmentDescription attachment{};
  attachment.format = format;
  attachment.samples = samples;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  attachment.storeOp = store;
  attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  attachment.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  attachment.finalLayout = final_layout;
  return attachment;
}

constexpr VkPipelineStageFlags kDepthStages =
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;

void BeginPass(VkCommandBuffer commands, VkRenderPass pass, VkFramebuffer framebuffer,
               VkExtent2D extent, std::span<const VkClearValue> clears) {
  auto begin = VulkanInfo<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  begin.renderPass = pass;
  begin.framebuffer = framebuffer;
  begin.renderArea.extent = extent;
  begin.clearValueCount = static_cast<uint32_t>(clears.size());
  begin.pClearValues = clears.data();
  vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{
      0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &scissor);
}

}  // namespace

RenderTargets::~RenderTargets() {
  if (device_ == nullptr) return;
  const VkDevice device = device_->handle();
  vkDestroyFramebuffer(device, framebuffer_, nullptr);
  vkDestroyFramebuffer(device, shadow_framebuffer_, nullptr);
  vkDestroyRenderPass(device, color_pass_, nullptr);
  vkDestroyRenderPass(device, shadow_pass_, nullptr);
}

Status RenderTargets::Create(VulkanDevice* device) {
  device_ = device;
  const VkSampleCountFlags possible = device->properties().limits.framebufferColorSampleCounts &
                                      device->properties().limits.framebufferDepthSampleCounts;
  // Four samples are there on every conforming device.
  if ((possible & VK_SAMPLE_COUNT_4_BIT) == 0) {
    return Error(StatusCode::kDeviceError, "vulkan: the device has no fourfold multisampling");
  }
  LIMBER_RETURN_IF_ERROR(CreateColorPass());
  LIMBER_RETURN_IF_ERROR(CreateShadowPass());
  return CreateShadowMap();
}

Status RenderTargets::CreateColorPass() {
  // Colour must not be stored, only its resolved picture; the picture is copied or blitted next.
  std::array<VkAttachmentDescription, 3> attachments = {
      Attachment(kColorFormat, samples_, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL),
      Attachment(depth_format_, samples_, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                 VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL),
      Attachment(kColorFormat, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_STORE_OP_STORE,
                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL)};
  attachments[0].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;  // the backdrop covers all of it
  attachments[2].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolve{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &color;
  subpass.pResolveAttachments = &resolve;
  subpass.pDepthStencilAttachment = &depth;

  const VkPipelineStageFlags color_stage = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  std::array<VkSubpassDependency, 2> dependencies{};
  // The frame before: its attachments were written, its picture was read by a transfer.
  dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[0].srcStageMask = color_stage | kDepthStages | VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[0].dstStageMask = color_stage | kDepthStages;
  dependencies[0].srcAccessMask =
      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[0].dstAccessMask =
      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT |
      VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[1].srcStageMask = color_stage;
  dependencies[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;

  auto info = VulkanInfo<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = static_cast<uint32_t>(attachments.size());
  info.pAttachments = attachments.data();
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = static_cast<uint32_t>(dependencies.size());
  info.pDependencies = dependencies.data();
  return VulkanStatus(vkCreateRenderPass(device_->handle(), &info, nullptr, &color_pass_),
                      "vkCreateRenderPass");
}

Status RenderTargets::CreateShadowPass() {
  const VkAttachmentDescription attachment =
      Attachment(depth_format_, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_STORE_OP_STORE,
                 VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  const VkAttachmentReference depth{0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.pDepthStencilAttachment = &depth;
  std::array<VkSubpassDependency, 2> dependencies{};
  dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[0].srcStageMask = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | kDepthStages;
  dependencies[0].dstStageMask = kDepthStages;
  dependencies[0].srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[0].dstAccessMask =
      VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[1].srcStageMask = kDepthStages;
  dependencies[1].dstStageMask = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
  dependencies[1].srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstAccessMask = VK_ACCESS_SHADER_READ_BIT;

  auto info = VulkanInfo<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = 1;
  info.pAttachments = &attachment;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = static_cast<uint32_t>(dependencies.size());
  info.pDependencies = dependencies.data();
  return VulkanStatus(vkCreateRenderPass(device_->handle(), &info, nullptr, &shadow_pass_),
                      "vkCreateRenderPass");
}

Status RenderTargets::CreateShadowMap() {
  GpuImageOptions options;
  options.format = depth_format_;
  options.extent = {kShadowSize, kShadowSize};
  options.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  options.aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
  LIMBER_RETURN_IF_ERROR(shadow_.Create(*device_, options));
  return CreateFramebuffer(shadow_pass_, {shadow_.view()}, options.extent, &shadow_framebuffer_);
}

Status RenderTargets::CreateFramebuffer(VkRenderPass pass, std::initializer_list<VkImageView> views,
                                        VkExtent2D extent, VkFramebuffer* framebuffer) {
  auto info = VulkanInfo<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  info.renderPass = pass;
  info.attachmentCount = static_cast<uint32_t>(views.size());
  info.pAttachments = views.begin();
  info.width = extent.width;
  info.height = extent.height;
  info.layers = 1;
  return VulkanStatus(vkCreateFramebuffer(device_->handle(), &info, nullptr, framebuffer),
                      "vkCreateFramebuffer");
}

Status RenderTargets::Resize(VkExtent2D extent) {
  const uint32_t largest = device_->properties().limits.maxFramebufferWidth;
  if (extent.width < 1 || extent.height < 1 || extent.width > largest ||
      extent.height > device_->properties().limits.maxFramebufferHeight) {
    return Error(StatusCode::kInvalidArgument, "a picture of %u x %u pixels; take 1 to %u a side",
                 extent.width, extent.height, largest);
  }
  vkDestroyFramebuffer(device_->handle(), framebuffer_, nullptr);
  framebuffer_ = VK_NULL_HANDLE;
  extent_ = extent;
  GpuImageOptions options;
  options.extent = extent;
  options.format = kColorFormat;
  options.samples = samples_;
  options.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
  LIMBER_RETURN_IF_ERROR(color_.Create(*device_, options));

  options.format = depth_format_;
  options.usage =
      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
  options.aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
  LIMBER_RETURN_IF_ERROR(depth_.Create(*device_, options));

  GpuImageOptions picture;
  picture.extent = extent;
  picture.format = kColorFormat;
  picture.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  LIMBER_RETURN_IF_ERROR(resolved_.Create(*device_, picture));
  return CreateFramebuffer(color_pass_, {color_.view(), depth_.view(), resolved_.view()}, extent,
                           &framebuffer_);
}

void RenderTargets::BeginColor(VkCommandBuffer commands) const {
  std::array<VkClearValue, 2> clears{};
  clears[0].color = {{0, 0, 0, 1}};
  clears[1].depthStencil = {1, 0};
  BeginPass(commands, color_pass_, framebuffer_, extent_, clears);
}

void RenderTargets::BeginShadow(VkCommandBuffer commands) const {
  std::array<VkClearValue, 1> clears{};
  clears[0].depthStencil = {1, 0};
  BeginPass(commands, shadow_pass_, shadow_framebuffer_, {kShadowSize, kShadowSize}, clears);
}

}  // namespace limber::viewer
