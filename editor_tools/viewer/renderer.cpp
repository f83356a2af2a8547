#include "viewer/renderer.h"

#include "shared/view_layout.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace limber::viewer {
namespace {

constexpr uint32_t kStamps = 3;  // begin, skinned, drawn

// From the left, above and in front of a character that faces +z.
const glm::vec3 kKeyDirection = glm::normalize(glm::vec3(-0.58f, 0.80f, 0.52f));

// The light's view of a ball: x and y to 0..1, depth to 0..1 with room for the floor behind.
glm::mat4 ShadowFromMesh(const Bounds& bounds) {
  const Vec3 c = bounds.centre();
  const glm::vec3 centre(c.x, c.y, c.z);
  const float radius = std::max(0.85f * bounds.diagonal(), 1e-12f);
  const glm::mat4 view =
      glm::lookAt(centre + 3.0f * radius * kKeyDirection, centre, glm::vec3(0, 1, 0));
  const glm::mat4 projection =
      glm::orthoRH_ZO(-radius, radius, -radius, radius, 0.5f * radius, 8.0f * radius);
  glm::mat4 to_unit(1);
  to_unit[0][0] = to_unit[1][1] = 0.5f;
  to_unit[3][0] = to_unit[3][1] = 0.5f;
  return to_unit * projection * view;
}

struct GroundPatch {
  float x = 0, z = 0, half_x = 0, half_z = 0;
};

// The part of the floor that the shadow of the box falls on, with room to move. Small, because
// every pixel of it is paid for.
GroundPatch ShadowedGround(const Bounds& bounds, float height) {
  const glm::vec3 low(bounds.low.x, bounds.low.y, bounds.low.z);
  const glm::vec3 high(bounds.high.x, bounds.high.y, bounds.high.z);
  glm::vec2 first(low.x, low.z), last(high.x, high.z);
  for (const glm::vec3& corner : {low, high}) {
    for (const float top : {low.y, high.y}) {
      const float along = std::max(0.0f, top - height) / kKeyDirection.y;
      const glm::vec2 foot(corner.x - along * kKeyDirection.x, corner.z - along * kKeyDirection.z);
      first = glm::min(first, foot);
      last = glm::max(last, foot);
    }
  }
  const glm::vec2 centre = 0.5f * (first + last);
  const glm::vec2 half = 0.5f * (last - first) + 0.15f * bounds.diagonal();
  return {centre.x, centre.y, half.x, half.y};
}

uint32_t DotStyle(const HandleDot& dot) {
  return (dot.pinned ? LIMBER_VIEW_DOT_PINNED : 0u) | (dot.hovered ? LIMBER_VIEW_DOT_HOVERED : 0u) |
         (dot.grabbed ? LIMBER_VIEW_DOT_GRABBED : 0u);
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::Create(VulkanDevice* device,
                                                   const CharacterSource& source,
                                                   const RendererOptions& options) {
  if (options.frames_in_flight < 1 || options.frames_in_flight > 16) {
    return Error(StatusCode::kInvalidArgument, "renderer: %u frames in flight; take 1 to 16",
                 options.frames_in_flight);
  }
  std::unique_ptr<Renderer> renderer(new Renderer(device, options));
  LIMBER_RETURN_IF_ERROR(renderer->Initialize(source));
  return renderer;
}

Renderer::~Renderer() {
  vkDeviceWaitIdle(device_->handle());
  vkDestroyQueryPool(device_->handle(), queries_, nullptr);
}

Status Renderer::Initialize(const CharacterSource& source) {
  LIMBER_RETURN_IF_ERROR(targets_.Create(device_));
  LIMBER_RETURN_IF_ERROR(targets_.Resize({options_.width, options_.height}));
  LIMBER_RETURN_IF_ERROR(pipelines_.Create(device_, targets_));
  Result<std::unique_ptr<CharacterModel>> model = CharacterModel::Create(
      device_, source, pipelines_.material_layout(), options_.frames_in_flight);
  if (!model.ok()) return model.status();
  model_ = std::move(*model);
  space_ = source.space;
  flat_ = source.dimension == 2;
  bounds_ = ShapeBounds(*source.mesh, space_);
  const Bounds rest = ShapeBounds(*source.mesh, space_, 0);
  ground_height_ = rest.low.y;
  // Of a solid character extreme shapes must not make the usual ones small: two thirds of the way
  // from the first shape to all of them. A flat one is shown with everything it can reach.
  const float share = flat_ ? 1.0f : 0.65f;
  for (int axis = 0; axis < 3; ++axis) {
    view_bounds_.low[axis] = std::lerp(rest.low[axis], bounds_.low[axis], share);
    view_bounds_.high[axis] = std::lerp(rest.high[axis], bounds_.high[axis], share);
  }
  return CreateSlots();
}

Status Renderer::CreateSlots() {
  const uint32_t count = options_.frames_in_flight;
  const VkDescriptorPoolSize of_each[2] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                           {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1}};
  LIMBER_RETURN_IF_ERROR(sets_.Create(device_->api(), pipelines_.frame_layout(), count, of_each));
  slots_.resize(count);
  for (size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    LIMBER_RETURN_IF_ERROR(slot.uniforms.Create(device_->api(), sizeof(shaders::FrameUniforms),
                                                VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, kUploadMemory));
    LIMBER_RETURN_IF_ERROR(slot.dots.Create(device_->api(), kMaxDots * sizeof(shaders::DotVertex),
                                            VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, kUploadMemory));
    slot.set = sets_[i];
    WriteSet(slot);
  }
  if (device_->timestamp_period() <= 0) return {};
  auto queries = VulkanInfo<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
  queries.queryCount = kStamps * count;
  return VulkanStatus(vkCreateQueryPool(device_->handle(), &queries, nullptr, &queries_),
                      "vkCreateQueryPool");
}

void Renderer::WriteSet(const Slot& slot) const {
  const VkDescriptorBufferInfo buffer{slot.uniforms.handle(), 0, sizeof(shaders::FrameUniforms)};
  const VkDescriptorImageInfo image{pipelines_.shadow_sampler(), targets_.shadow_map(),
                                    VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  std::array<VkWriteDescriptorSet, 2> writes = {
      DescriptorWrite(slot.set, LIMBER_VIEW_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
      DescriptorWrite(slot.set, LIMBER_VIEW_SHADOW_MAP, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER)};
  writes[0].pBufferInfo = &buffer;
  writes[1].pImageInfo = &image;
  vkUpdateDescriptorSets(device_->handle(), 2, writes.data(), 0, nullptr);
}

Status Renderer::Resize(uint32_t width, uint32_t height) {
  vkDeviceWaitIdle(device_->handle());
  return targets_.Resize({width, height});
}

OrbitCamera Renderer::DefaultCamera() const {
  const VkExtent2D size = extent();
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  return flat_ ? OrbitCamera::FrameFlat(view_bounds_, space_, aspect)
               : OrbitCamera::Frame(view_bounds_, aspect);
}

void Renderer::WriteUniforms(const Slot& slot, const Scene& scene, uint32_t num_dots) const {
  shaders::FrameUniforms uniforms{};
  const glm::mat4 clip = scene.camera->ClipFromMesh(), shadow = ShadowFromMesh(bounds_);
  std::memcpy(uniforms.clip_from_mesh, glm::value_ptr(clip), sizeof(clip));
  std::memcpy(uniforms.shadow_from_mesh, glm::value_ptr(shadow), sizeof(shadow));
  const Vec3 eye = scene.camera->eye();
  const float size = bounds_.diagonal();
  const auto set = [](float* out, float x, float y, float z, float w) {
    out[0] = x;
    out[1] = y;
    out[2] = z;
    out[3] = w;
  };
  set(uniforms.eye, eye.x, eye.y, eye.z, flat_ ? 1 : 0);
  set(uniforms.key, kKeyDirection.x, kKeyDirection.y, kKeyDirection.z, 0.006f);
  const GroundPatch ground = ShadowedGround(bounds_, ground_height_);
  set(uniforms.ground, ground.x, ground_height_, ground.z, 0);
  set(uniforms.ground_half, ground.half_x, ground.half_z, 0.12f * size, 0);
  const auto width = static_cast<float>(extent().width);
  const auto height = static_cast<float>(extent().height);
  const float radius = options_.dot_radius > 0 ? options_.dot_radius : std::max(4.0f, height / 85);
  set(uniforms.viewport, width, height, radius, size);
  std::memcpy(slot.uniforms.mapped(), &uniforms, sizeof(uniforms));

  for (uint32_t i = 0; i < num_dots; ++i) {
    const HandleDot& dot = scene.dots[i];
    const shaders::DotVertex vertex{{dot.position.x, dot.position.y, dot.position.z},
                                    DotStyle(dot)};
    std::memcpy(slot.dots.mapped() + i * sizeof(vertex), &vertex, sizeof(vertex));
  }
}

Status Renderer::Record(VkCommandBuffer commands, uint32_t frame, const Scene& scene) {
  if (frame >= slots_.size() || scene.camera == nullptr) {
    return Error(StatusCode::kInvalidArgument, "renderer: frame %u of %zu, or no camera", frame,
                 slots_.size());
  }
  const auto num_dots = static_cast<uint32_t>(std::min<size_t>(scene.dots.size(), kMaxDots));
  WriteUniforms(slots_[frame], scene, num_dots);
  if (queries_ != VK_NULL_HANDLE) {
    vkCmdResetQueryPool(commands, queries_, frame * kStamps, kStamps);
  }
  Timestamp(commands, frame, 0);
  LIMBER_RETURN_IF_ERROR(model_->RecordSkin(commands, frame, scene.transforms));
  Timestamp(commands, frame, 1);
  RecordShadow(commands, frame);
  RecordColor(commands, frame, num_dots);
  Timestamp(commands, frame, 2);
  slots_[frame].timed = queries_ != VK_NULL_HANDLE;
  return {};
}

void Renderer::RecordShadow(VkCommandBuffer commands, uint32_t frame) const {
  targets_.BeginShadow(commands);
  if (!flat_) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.shadow());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout(), 0, 1,
                            &slots_[frame].set, 0, nullptr);
    model_->Bind(commands, frame);
    for (const CharacterDraw& draw : model_->draws()) {
      if (draw.material.alpha_mode != AlphaMode::kBlend) {
        vkCmdDrawIndexed(commands, draw.num_indices, 1, draw.first_index, 0, 0);
      }
    }
  }
  vkCmdEndRenderPass(commands);
}

void Renderer::RecordColor(VkCommandBuffer commands, uint32_t frame, uint32_t num_dots) const {
  targets_.BeginColor(commands);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout(), 0, 1,
                          &slots_[frame].set, 0, nullptr);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.background());
  vkCmdDraw(commands, 3, 1, 0, 0);
  model_->Bind(commands, frame);
  RecordDraws(commands, false);
  if (!flat_) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.ground());
    vkCmdDraw(commands, 4, 1, 0, 0);
  }
  RecordDraws(commands, true);
  if (num_dots > 0) {
    const VkBuffer dots = slots_[frame].dots.handle();
    const VkDeviceSize offset = 0;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.dots());
    vkCmdBindVertexBuffers(commands, 0, 1, &dots, &offset);
    vkCmdDraw(commands, 4, num_dots, 0, 0);
  }
  vkCmdEndRenderPass(commands);
}

void Renderer::RecordDraws(VkCommandBuffer commands, bool blend) const {
  for (const CharacterDraw& draw : model_->draws()) {
    const Material& material = draw.material;
    if ((material.alpha_mode == AlphaMode::kBlend) != blend) continue;
    shaders::DrawPush push{};
    std::copy(material.base_color.begin(), material.base_color.end(), push.base_color);
    push.roughness = material.roughness;
    push.metallic = material.metallic;
    push.normal_scale = material.normal_texture.image >= 0 ? material.normal_scale : 0;
    push.alpha_cutoff = material.alpha_cutoff;
    push.shading = material.shading;
    push.flags = (material.unlit ? LIMBER_VIEW_UNLIT : 0u) |
                 (material.alpha_mode == AlphaMode::kMask ? LIMBER_VIEW_MASKED : 0u) |
                 (material.contours ? LIMBER_VIEW_CONTOURS : 0u);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                      pipelines_.character(blend, material.double_sided));
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout(), 1, 1,
                            &draw.set, 0, nullptr);
    vkCmdPushConstants(commands, pipelines_.layout(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(push),
                       &push);
    vkCmdDrawIndexed(commands, draw.num_indices, 1, draw.first_index, 0, 0);
  }
}

void Renderer::Timestamp(VkCommandBuffer commands, uint32_t frame, uint32_t index) const {
  if (queries_ == VK_NULL_HANDLE) return;
  vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                      frame * kStamps + index);
}

StageTimes Renderer::times(uint32_t frame) const {
  StageTimes times;
  if (frame >= slots_.size() || !slots_[frame].timed) return times;
  std::array<uint64_t, kStamps> stamps{};
  if (vkGetQueryPoolResults(device_->handle(), queries_, frame * kStamps, kStamps, sizeof(stamps),
                            stamps.data(), sizeof(uint64_t),
                            VK_QUERY_RESULT_64_BIT) != VK_SUCCESS) {
    return times;
  }
  const double ms = device_->timestamp_period() * 1e-6;
  times.skin_ms = static_cast<double>(stamps[1] - stamps[0]) * ms;
  times.draw_ms = static_cast<double>(stamps[2] - stamps[1]) * ms;
  return times;
}

}  // namespace limber::viewer
