#include "viewer/character_model.h"

#include "core/vector.h"
#include "shared/view_layout.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace limber::viewer {
namespace {

template <class T>
Status FillBuffer(const VulkanDevice& device, const Vector<T>& values, VkBufferUsageFlags usage,
                  VulkanBuffer* buffer) {
  const size_t bytes = values.size() * sizeof(T);
  LIMBER_RETURN_IF_ERROR(
      buffer->Create(device.api(), std::max<size_t>(bytes, 16), usage, kUploadMemory));
  if (bytes > 0) std::memcpy(buffer->mapped(), values.data(), bytes);
  return {};
}

}  // namespace

CharacterModel::~CharacterModel() {
  for (const auto& [key, sampler] : samplers_) {
    vkDestroySampler(device_->handle(), sampler, nullptr);
  }
}

Result<std::unique_ptr<CharacterModel>> CharacterModel::Create(
    VulkanDevice* device, const CharacterSource& source, VkDescriptorSetLayout material_layout,
    uint32_t frames_in_flight) {
  if (source.mesh == nullptr) return Error(StatusCode::kInvalidArgument, "no mesh to draw");
  std::unique_ptr<CharacterModel> model(new CharacterModel(device));
  LIMBER_RETURN_IF_ERROR(model->CreateSkinner(source, frames_in_flight));
  LIMBER_RETURN_IF_ERROR(model->CreateMesh(*source.mesh));
  model->ListDraws(source);
  LIMBER_RETURN_IF_ERROR(model->CreateTextures(source.materials));
  LIMBER_RETURN_IF_ERROR(model->CreateSets(material_layout));
  return model;
}

Status CharacterModel::CreateSkinner(const CharacterSource& source, uint32_t frames_in_flight) {
  VulkanSkinnerOptions options;
  options.frames_in_flight = frames_in_flight;
  Result<std::unique_ptr<VulkanSkinner>> skinner = VulkanSkinner::Create(device_->host(), options);
  if (!skinner.ok()) return skinner.status();
  skinner_ = std::move(*skinner);
  const Result<const VulkanSkinRig*> rig = skinner_->AddRig(*source.mesh, source.space);
  if (!rig.ok()) return rig.status();
  rig_ = *rig;
  num_vertices_ = source.mesh->num_draw_vertices;
  return vertices_.Create(
      device_->api(), VkDeviceSize{frames_in_flight} * num_vertices_ * sizeof(SkinnedVertex),
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, kDeviceMemory);
}

Status CharacterModel::CreateMesh(const SkinMesh& mesh) {
  num_indices_ = static_cast<uint32_t>(mesh.triangles.size());
  LIMBER_RETURN_IF_ERROR(
      FillBuffer(*device_, mesh.triangles, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, &indices_));
  Vector<float> coordinates = mesh.texcoords;
  coordinates.resize(size_t{mesh.num_draw_vertices} * 2, 0.0f);
  return FillBuffer(*device_, coordinates, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, &texcoords_);
}

void CharacterModel::ListDraws(const CharacterSource& source) {
  const SkinMesh& mesh = *source.mesh;
  const auto add = [&](int material, uint64_t first, uint64_t count) {
    CharacterDraw draw;
    const Vector<Material>& materials = source.materials.materials;
    const bool known = material >= 0 && static_cast<size_t>(material) < materials.size();
    draw.material = known ? materials[static_cast<size_t>(material)] : DefaultMaterial();
    if (source.dimension == 2) {
      draw.material.unlit = true;
      draw.material.double_sided = true;
    }
    const uint64_t end = std::min<uint64_t>(3 * (first + count), mesh.triangles.size());
    draw.first_index = static_cast<uint32_t>(std::min(3 * first, end));
    draw.num_indices = static_cast<uint32_t>(end) - draw.first_index;
    if (draw.num_indices > 0) draws_.push_back(draw);
  };
  for (const SkinPrimitive& primitive : mesh.primitives) {
    add(primitive.material, primitive.first_triangle, primitive.num_triangles);
  }
  if (mesh.primitives.empty()) add(-1, 0, mesh.num_triangles());
  std::stable_sort(draws_.begin(), draws_.end(), [](const auto& a, const auto& b) {
    return (a.material.alpha_mode == AlphaMode::kBlend) <
           (b.material.alpha_mode == AlphaMode::kBlend);
  });
}

Status CharacterModel::AddTexture(const Image& image, bool srgb, int* slot) {
  if (*slot >= 0) return {};
  Result<GpuImage> texture = UploadTexture(device_, image, srgb);
  if (!texture.ok()) return texture.status();
  *slot = static_cast<int>(textures_.size());
  textures_.push_back(std::move(*texture));
  return {};
}

Status CharacterModel::CreateTextures(const MaterialSet& set) {
  Image white;
  white.width = white.height = 1;
  white.rgba.assign(4, 255);
  int first = -1;
  LIMBER_RETURN_IF_ERROR(AddTexture(white, false, &first));
  color_slot_.assign(set.images.size(), -1);
  normal_slot_.assign(set.images.size(), -1);
  const auto add = [&](const MaterialTexture& texture, bool srgb, Vector<int>* slots) {
    if (texture.image < 0) return Status();
    const auto i = static_cast<size_t>(texture.image);
    return AddTexture(set.images.at(i), srgb, &slots->at(i));
  };
  for (const CharacterDraw& draw : draws_) {
    LIMBER_RETURN_IF_ERROR(add(draw.material.base_color_texture, true, &color_slot_));
    LIMBER_RETURN_IF_ERROR(add(draw.material.normal_texture, false, &normal_slot_));
  }
  return {};
}

VkSampler CharacterModel::Sampler(const MaterialTexture& texture) {
  const uint32_t key =
      (texture.repeat_u ? 1u : 0u) | (texture.repeat_v ? 2u : 0u) | (texture.nearest ? 4u : 0u);
  for (const auto& [known, sampler] : samplers_) {
    if (known == key) return sampler;
  }
  const auto mode = [](bool repeat) {
    return repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  };
  auto info = VulkanInfo<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = texture.nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
  info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = mode(texture.repeat_u);
  info.addressModeV = mode(texture.repeat_v);
  info.anisotropyEnable = device_->anisotropy() && !texture.nearest ? VK_TRUE : VK_FALSE;
  info.maxAnisotropy = info.anisotropyEnable == VK_TRUE
                           ? std::min(4.0f, device_->properties().limits.maxSamplerAnisotropy)
                           : 1;
  info.maxLod = VK_LOD_CLAMP_NONE;
  VkSampler sampler = VK_NULL_HANDLE;
  if (vkCreateSampler(device_->handle(), &info, nullptr, &sampler) != VK_SUCCESS) {
    return VK_NULL_HANDLE;
  }
  samplers_.emplace_back(key, sampler);
  return sampler;
}

Status CharacterModel::CreateSets(VkDescriptorSetLayout layout) {
  const VkDescriptorPoolSize two_samplers{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2};
  LIMBER_RETURN_IF_ERROR(sets_.Create(device_->api(), layout, draws_.size(), {&two_samplers, 1}));
  for (size_t i = 0; i < draws_.size(); ++i) {
    draws_[i].set = sets_[i];
    LIMBER_RETURN_IF_ERROR(WriteSet(draws_[i]));
  }
  return {};
}

Status CharacterModel::WriteSet(const CharacterDraw& draw) {
  std::array<VkDescriptorImageInfo, 2> images{};
  std::array<VkWriteDescriptorSet, 2> writes{};
  for (uint32_t i = 0; i < 2; ++i) {
    const bool is_color = i == LIMBER_VIEW_BASE_COLOR;
    const MaterialTexture& texture =
        is_color ? draw.material.base_color_texture : draw.material.normal_texture;
    const Vector<int>& slots = is_color ? color_slot_ : normal_slot_;
    const int slot = texture.image < 0 ? 0 : slots[static_cast<size_t>(texture.image)];
    images[i] = {Sampler(texture), textures_[static_cast<size_t>(slot)].view(),
                 VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    if (images[i].sampler == VK_NULL_HANDLE) {
      return Error(StatusCode::kDeviceError, "vulkan: vkCreateSampler failed");
    }
    writes[i] = DescriptorWrite(draw.set, i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
    writes[i].pImageInfo = &images[i];
  }
  vkUpdateDescriptorSets(device_->handle(), 2, writes.data(), 0, nullptr);
  return {};
}

VertexStream CharacterModel::Stream(uint32_t frame, size_t offset) const {
  return {vertices_.handle(), VkDeviceSize{frame} * num_vertices_ * sizeof(SkinnedVertex) + offset,
          sizeof(SkinnedVertex)};
}

Status CharacterModel::RecordSkin(VkCommandBuffer commands, uint32_t frame,
                                  const SkinTransforms& transforms) {
  VulkanSkinJob job;
  job.rig = rig_;
  job.transforms = transforms;
  job.positions = Stream(frame, offsetof(SkinnedVertex, position));
  job.normals = Stream(frame, offsetof(SkinnedVertex, normal));
  job.tangents = Stream(frame, offsetof(SkinnedVertex, tangent));
  return skinner_->Record(commands, frame, {&job, 1}, {});
}

void CharacterModel::Bind(VkCommandBuffer commands, uint32_t frame) const {
  const VkBuffer buffers[2] = {vertices_.handle(), texcoords_.handle()};
  const VkDeviceSize offsets[2] = {Stream(frame, 0).offset, 0};
  vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
  vkCmdBindIndexBuffer(commands, indices_.handle(), 0, VK_INDEX_TYPE_UINT32);
}

}  // namespace limber::viewer
