#include "viewer/play_presenter.h"

#include "skin_vulkan/vulkan_info.h"
#include "viewer/image.h"
#include "viewer/picture_reader.h"

#include <algorithm>
#include <utility>

namespace limber::viewer {
namespace {

bool SameSize(VkExtent2D a, VkExtent2D b) {
  return a.width == b.width && a.height == b.height;
}

bool IsEmpty(VkExtent2D size) {
  return size.width == 0 || size.height == 0;
}

}  // namespace

Result<std::unique_ptr<PlayPresenter>> PlayPresenter::Create(VulkanDevice* device,
                                                             const CharacterSource& source,
                                                             VkExtent2D size,
                                                             bool wait_for_display) {
  std::unique_ptr<PlayPresenter> presenter(new PlayPresenter(device));
  LIMBER_RETURN_IF_ERROR(presenter->Initialize(source, size, wait_for_display));
  return presenter;
}

Status PlayPresenter::Initialize(const CharacterSource& source, VkExtent2D size,
                                 bool wait_for_display) {
  const SwapchainDevice shared = {device_->physical_device(), device_->handle(), device_->queue()};
  Result<Swapchain> swapchain =
      Swapchain::Create(shared, device_->surface(), size, wait_for_display);
  if (!swapchain.ok()) return swapchain.status();
  swapchain_.emplace(std::move(*swapchain));

  const VkExtent2D fitted = IsEmpty(swapchain_->extent()) ? size : swapchain_->extent();
  RendererOptions options;
  options.width = std::max(1u, fitted.width);
  options.height = std::max(1u, fitted.height);
  options.frames_in_flight = 1;
  Result<std::unique_ptr<Renderer>> renderer = Renderer::Create(device_, source, options);
  if (!renderer.ok()) return renderer.status();
  renderer_ = std::move(*renderer);

  auto allocate =
      VulkanInfo<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = device_->command_pool();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkAllocateCommandBuffers(device_->handle(), &allocate, &commands_),
                   "vkAllocateCommandBuffers"));
  const auto fence = VulkanInfo<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  return VulkanStatus(vkCreateFence(device_->handle(), &fence, nullptr, &fence_), "vkCreateFence");
}

PlayPresenter::~PlayPresenter() {
  vkDeviceWaitIdle(device_->handle());
  vkDestroyFence(device_->handle(), fence_, nullptr);
  if (commands_ != VK_NULL_HANDLE) {
    vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &commands_);
  }
}

Status PlayPresenter::WaitForFrame() {
  if (!in_flight_) return {};
  in_flight_ = false;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "waiting for a frame"));
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkResetFences(device_->handle(), 1, &fence_), "vkResetFences"));
  times_ = renderer_->times(0);
  return {};
}

Result<bool> PlayPresenter::Fit(VkExtent2D window_size) {
  if (IsEmpty(window_size)) return false;
  if (!stale_ && SameSize(window_size, swapchain_->extent())) return false;
  LIMBER_RETURN_IF_ERROR(WaitForFrame());
  LIMBER_RETURN_IF_ERROR(swapchain_->Resize(window_size));
  stale_ = false;
  const VkExtent2D fitted = swapchain_->extent();
  if (IsEmpty(fitted) || SameSize(fitted, renderer_->extent())) return false;
  LIMBER_RETURN_IF_ERROR(renderer_->Resize(fitted.width, fitted.height));
  return true;
}

Result<bool> PlayPresenter::Show(const Scene& scene) {
  LIMBER_RETURN_IF_ERROR(WaitForFrame());
  Result<std::optional<WindowImage>> window = swapchain_->Acquire();
  if (!window.ok()) return window.status();
  if (!window->has_value()) {
    stale_ = true;
    return false;
  }
  LIMBER_RETURN_IF_ERROR(Record(scene, **window));
  LIMBER_RETURN_IF_ERROR(Submit(**window));
  in_flight_ = true;
  const Result<bool> fits = swapchain_->Present(**window);
  if (!fits.ok()) return fits.status();
  stale_ = !*fits;
  return true;
}

Status PlayPresenter::Record(const Scene& scene, const WindowImage& window) {
  auto begin = VulkanInfo<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer"));
  LIMBER_RETURN_IF_ERROR(renderer_->Record(commands_, 0, scene));
  RecordCopy(window);
  return VulkanStatus(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

void PlayPresenter::RecordCopy(const WindowImage& window) const {
  // The submission waits for the image at the transfer stage; so does the change of layout.
  VkImageMemoryBarrier to_copy =
      LayoutChange(window.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  to_copy.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                       0, nullptr, 0, nullptr, 1, &to_copy);

  const VkExtent2D from = renderer_->extent();
  VkImageBlit blit{};  // a blit, not a copy: the order of the channels may differ
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {static_cast<int32_t>(from.width), static_cast<int32_t>(from.height), 1};
  blit.dstOffsets[1] = {static_cast<int32_t>(window.extent.width),
                        static_cast<int32_t>(window.extent.height), 1};
  vkCmdBlitImage(commands_, renderer_->picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                 window.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_NEAREST);

  VkImageMemoryBarrier to_show = LayoutChange(window.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                              VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
  to_show.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, nullptr, 0, nullptr, 1,
                       &to_show);
}

Status PlayPresenter::Submit(const WindowImage& window) {
  const VkPipelineStageFlags wait_stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
  auto submit = VulkanInfo<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.waitSemaphoreCount = 1;
  submit.pWaitSemaphores = &window.ready;
  submit.pWaitDstStageMask = &wait_stage;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands_;
  submit.signalSemaphoreCount = 1;
  submit.pSignalSemaphores = &window.drawn;
  return VulkanStatus(vkQueueSubmit(device_->queue(), 1, &submit, fence_), "vkQueueSubmit");
}

Status PlayPresenter::Screenshot(const std::filesystem::path& path) {
  LIMBER_RETURN_IF_ERROR(WaitForFrame());
  PictureReader reader;
  LIMBER_RETURN_IF_ERROR(reader.Create(*device_, renderer_->extent()));
  LIMBER_RETURN_IF_ERROR(device_->SubmitAndWait(
      [&](VkCommandBuffer commands) { reader.Record(commands, renderer_->picture()); }));
  Image image;
  reader.Read(&image);
  return WritePng(path, image);
}

}  // namespace limber::viewer
