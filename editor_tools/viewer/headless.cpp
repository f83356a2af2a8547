#include "viewer/headless.h"

#include <chrono>
#include <cstring>

namespace limber::viewer {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

HeadlessRenderer::~HeadlessRenderer() {
  renderer_.reset();
  pixels_ = VulkanBuffer();
}

Result<std::unique_ptr<HeadlessRenderer>> HeadlessRenderer::Create(
    const Rig& rig, const std::filesystem::path& materials_file, const HeadlessOptions& options) {
  CharacterSource source;
  source.mesh = &rig.mesh();
  source.space = rig.tables().space;
  source.dimension = rig.dimension();
  if (!materials_file.empty()) {
    Result<MaterialSet> materials = ReadMaterials(materials_file);
    if (!materials.ok()) return materials.status();
    source.materials = std::move(*materials);
  }
  return Create(source, options);
}

Result<std::unique_ptr<HeadlessRenderer>> HeadlessRenderer::Create(const CharacterSource& source,
                                                                   const HeadlessOptions& options) {
  DeviceOptions device_options;
  device_options.validation = options.validation;
  Result<std::unique_ptr<VulkanDevice>> device = VulkanDevice::Create(device_options);
  if (!device.ok()) return device.status();
  std::unique_ptr<HeadlessRenderer> headless(new HeadlessRenderer());
  headless->device_ = std::move(*device);
  headless->warnings_ = source.materials.warnings;

  RendererOptions renderer_options;
  renderer_options.width = options.width;
  renderer_options.height = options.height;
  renderer_options.frames_in_flight = 1;
  renderer_options.dot_radius = options.dot_radius;
  Result<std::unique_ptr<Renderer>> renderer =
      Renderer::Create(headless->device_.get(), source, renderer_options);
  if (!renderer.ok()) return renderer.status();
  headless->renderer_ = std::move(*renderer);

  Result<VulkanBuffer> pixels = VulkanBuffer::Create(
      headless->device_->api(), VkDeviceSize{options.width} * options.height * 4,
      VK_BUFFER_USAGE_TRANSFER_DST_BIT,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
      VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (!pixels.ok()) return pixels.status();
  headless->pixels_ = std::move(*pixels);
  return headless;
}

void HeadlessRenderer::RecordReadback(VkCommandBuffer commands) const {
  const VkExtent2D size = renderer_->extent();
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {size.width, size.height, 1};
  vkCmdCopyImageToBuffer(commands, renderer_->picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                         pixels_.handle(), 1, &copy);
  auto barrier = VulkanInfo<VkBufferMemoryBarrier>(VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.buffer = pixels_.handle();
  barrier.size = VK_WHOLE_SIZE;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 0,
                       nullptr, 1, &barrier, 0, nullptr);
}

Status HeadlessRenderer::RenderFrame(const SkinTransforms& transforms, const OrbitCamera& camera,
                                     std::span<const HandleDot> dots, Image* image) {
  const auto start = std::chrono::steady_clock::now();
  Scene scene;
  scene.transforms = transforms;
  scene.camera = &camera;
  scene.dots = dots;
  Status recorded;
  LIMBER_RETURN_IF_ERROR(device_->SubmitAndWait([&](VkCommandBuffer commands) {
    recorded = renderer_->Record(commands, 0, scene);
    if (recorded.ok()) RecordReadback(commands);
  }));
  LIMBER_RETURN_IF_ERROR(recorded);
  const auto drawn = std::chrono::steady_clock::now();
  image->width = renderer_->extent().width;
  image->height = renderer_->extent().height;
  image->rgba.resize(size_t{image->width} * image->height * 4);
  std::memcpy(image->rgba.data(), pixels_.mapped(), image->rgba.size());
  const StageTimes stages = renderer_->times(0);
  times_ = {stages.skin_ms, stages.draw_ms, MillisecondsSince(drawn), MillisecondsSince(start)};
  return {};
}

}  // namespace limber::viewer
