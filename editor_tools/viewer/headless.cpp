#include "viewer/headless.h"

#include <chrono>

namespace limber::viewer {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

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

  LIMBER_RETURN_IF_ERROR(
      headless->reader_.Create(*headless->device_, {options.width, options.height}));
  return headless;
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
    if (recorded.ok()) reader_.Record(commands, renderer_->picture());
  }));
  LIMBER_RETURN_IF_ERROR(recorded);
  const auto drawn = std::chrono::steady_clock::now();
  reader_.Read(image);
  const StageTimes stages = renderer_->times(0);
  times_ = {stages.skin_ms, stages.draw_ms, MillisecondsSince(drawn), MillisecondsSince(start)};
  return {};
}

}  // namespace limber::viewer
