#include "engine_renderer.h"

#include <cmath>
#include <cstdlib>

namespace engine {
namespace {

constexpr VkFormat kColour = VK_FORMAT_R8G8B8A8_SRGB, kDepth = VK_FORMAT_D32_SFLOAT;

struct Push {
  glm::mat4 clip_from_world;
  glm::vec4 place, colour, turn;
};

void Require(VkResult result) {
  if (result != VK_SUCCESS) std::abort();  // a test's engine has no plan for this
}

}  // namespace

Renderer::Renderer(Device* device, BufferHeap* heap) : device_(device), heap_(heap) {
  auto pool = Tagged<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = device->queue_family;
  Require(vkCreateCommandPool(device->device, &pool, nullptr, &pool_));
  MakePass();
  MakePipeline();
  for (Slot& slot : slots_)
    MakeSlot(&slot);
}

Renderer::~Renderer() {
  WaitAll();
  for (const Slot& slot : slots_) {
    vkDestroyFence(device_->device, slot.done, nullptr);
    vkDestroyFramebuffer(device_->device, slot.framebuffer, nullptr);
    FreeImage(slot.colour);
    FreeImage(slot.depth);
    heap_->Free(slot.picture);
  }
  for (VkPipeline pipeline : pipelines_)
    vkDestroyPipeline(device_->device, pipeline, nullptr);
  vkDestroyPipelineLayout(device_->device, layout_, nullptr);
  vkDestroyRenderPass(device_->device, pass_, nullptr);
  vkDestroyCommandPool(device_->device, pool_, nullptr);
}

void Renderer::MakeImage(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
                         Image* image) {
  auto info = Tagged<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {kWidth, kHeight, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage;
  Require(vkCreateImage(device_->device, &info, nullptr, &image->image));
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device_->device, image->image, &needs);
  auto memory = Tagged<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  memory.allocationSize = needs.size;
  while ((needs.memoryTypeBits >> memory.memoryTypeIndex & 1) == 0)
    ++memory.memoryTypeIndex;
  Require(vkAllocateMemory(device_->device, &memory, nullptr, &image->memory));
  Require(vkBindImageMemory(device_->device, image->image, image->memory, 0));
  auto view = Tagged<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view.image = image->image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {aspect, 0, 1, 0, 1};
  Require(vkCreateImageView(device_->device, &view, nullptr, &image->view));
}

void Renderer::FreeImage(const Image& image) {
  vkDestroyImageView(device_->device, image.view, nullptr);
  vkDestroyImage(device_->device, image.image, nullptr);
  vkFreeMemory(device_->device, image.memory, nullptr);
}

void Renderer::MakePass() {
  VkAttachmentDescription attachments[2] = {};
  for (VkAttachmentDescription& attachment : attachments) {
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  }
  attachments[0].format = kColour;
  attachments[0].finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  attachments[1].format = kDepth;
  attachments[1].storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference colour = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass = {};
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pDepthStencilAttachment = &depth;
  const VkSubpassDependency to_copy = {0,
                                       VK_SUBPASS_EXTERNAL,
                                       VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                       VK_PIPELINE_STAGE_TRANSFER_BIT,
                                       VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                       VK_ACCESS_TRANSFER_READ_BIT,
                                       0};
  auto info = Tagged<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = 2;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 1;
  info.pDependencies = &to_copy;
  Require(vkCreateRenderPass(device_->device, &info, nullptr, &pass_));
}

void Renderer::MakeSlot(Slot* slot) {
  auto commands =
      Tagged<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  commands.commandPool = pool_;
  commands.commandBufferCount = 1;
  Require(vkAllocateCommandBuffers(device_->device, &commands, &slot->commands));
  auto fence = Tagged<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
  Require(vkCreateFence(device_->device, &fence, nullptr, &slot->done));
  MakeImage(kColour, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
            VK_IMAGE_ASPECT_COLOR_BIT, &slot->colour);
  MakeImage(kDepth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT,
            &slot->depth);
  const VkImageView views[2] = {slot->colour.view, slot->depth.view};
  auto info = Tagged<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  info.renderPass = pass_;
  info.attachmentCount = 2;
  info.pAttachments = views;
  info.width = kWidth;
  info.height = kHeight;
  info.layers = 1;
  Require(vkCreateFramebuffer(device_->device, &info, nullptr, &slot->framebuffer));
  slot->picture =
      heap_->MakeMapped(VkDeviceSize{kWidth} * kHeight * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
}

void Renderer::Frame(uint32_t number, const glm::mat4& clip_from_world, float frames_a_second,
                     const std::function<void(VkCommandBuffer)>& before_pass,
                     const std::vector<DrawCall>& draws) {
  const Slot& slot = slots_[number];
  vkWaitForFences(device_->device, 1, &slot.done, VK_TRUE, UINT64_MAX);
  vkResetFences(device_->device, 1, &slot.done);
  const auto begin = Tagged<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  Require(vkBeginCommandBuffer(slot.commands, &begin));
  before_pass(slot.commands);
  VkClearValue clear[2] = {};
  clear[0].color = {{0.32f, 0.42f, 0.52f, 1}};
  clear[1].depthStencil = {1, 0};
  auto pass = Tagged<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  pass.renderPass = pass_;
  pass.framebuffer = slot.framebuffer;
  pass.renderArea.extent = {kWidth, kHeight};
  pass.clearValueCount = 2;
  pass.pClearValues = clear;
  vkCmdBeginRenderPass(slot.commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
  RecordDraws(slot.commands, clip_from_world, frames_a_second, draws);
  vkCmdEndRenderPass(slot.commands);
  VkBufferImageCopy copy = {};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {kWidth, kHeight, 1};
  vkCmdCopyImageToBuffer(slot.commands, slot.colour.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                         slot.picture.buffer, 1, &copy);
  Require(vkEndCommandBuffer(slot.commands));
  auto submit = Tagged<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &slot.commands;
  Require(vkQueueSubmit(device_->queue, 1, &submit, slot.done));
}

void Renderer::RecordDraws(VkCommandBuffer commands, const glm::mat4& clip_from_world,
                           float frames_a_second, const std::vector<DrawCall>& draws) const {
  for (const DrawCall& draw : draws) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_[draw.is_flat ? 1 : 0]);
    Push push = {clip_from_world, draw.place, {draw.colour, std::cos(draw.turn)}, {}};
    push.turn = {std::sin(draw.turn), frames_a_second, 0, 0};
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                       0, sizeof(push), &push);
    const VkDeviceSize zero = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &draw.vertices, &zero);
    vkCmdBindIndexBuffer(commands, draw.indices, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, draw.num_indices, 1, 0, draw.first_vertex, 0);
  }
}

void Renderer::WaitAll() {
  for (const Slot& slot : slots_)
    vkWaitForFences(device_->device, 1, &slot.done, VK_TRUE, UINT64_MAX);
}

const uint8_t* Renderer::Picture(uint32_t slot) {
  vkWaitForFences(device_->device, 1, &slots_[slot].done, VK_TRUE, UINT64_MAX);
  return static_cast<const uint8_t*>(slots_[slot].picture.mapped);
}

}  // namespace engine
