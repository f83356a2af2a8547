#include "viewer/character_model.h"

#include "shared/view_layout.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace limber::viewer {
namespace {

template <class T>
Result<VulkanBuffer> FilledBuffer(const VulkanDevice& device, const std::vector<T>& values,
                                  VkBufferUsageFlags usage) {
  Result<VulkanBuffer> buffer = VulkanBuffer::Create(
      device.api(), std::max<size_t>(values.size() * sizeof(T), 16), usage,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!buffer.ok()) return buffer;
  if (!values.empty()) {
    std::memcpy(buffer->mapped(), values.data(), values.size() * sizeof(T));
  }
  LIMBER_RETURN_IF_ERROR(buffer->Flush());
  return buffer;
}

}  // namespace

CharacterModel::~CharacterModel() {
  instance_.reset();
  vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
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
  Result<std::unique_ptr<VulkanSkinner>> skinner =
      VulkanSkinner::Create(device_->host(), *source.mesh, source.space, options);
  if (!skinner.ok()) return skinner.status();
  skinner_ = std::move(*skinner);
  LIMBER_RETURN_IF_ERROR(device_->SubmitAndWait(
      [this](VkCommandBuffer commands) { skinner_->RecordUpload(commands); }));
  skinner_->ReleaseStaging();
  Result<std::unique_ptr<VulkanSkinInstance>> instance = skinner_->CreateInstance();
  if (!instance.ok()) return instance.status();
  instance_ = std::move(*instance);
  return {};
}

Status CharacterModel::CreateMesh(const SkinMesh& mesh) {
  num_indices_ = static_cast<uint32_t>(mesh.triangles.size());
  Result<VulkanBuffer> indices =
      FilledBuffer(*device_, mesh.triangles, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
  if (!indices.ok()) return indices.status();
  indices_ = std::move(*indices);
  std::vector<float> coordinates = mesh.texcoords;
  coordinates.resize(size_t{mesh.num_draw_vertices} * 2, 0.0f);
  Result<VulkanBuffer> texcoords =
      FilledBuffer(*device_, coordinates, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  if (!texcoords.ok()) return texcoords.status();
  texcoords_ = std::move(*texcoords);
  return {};
}

void CharacterModel::ListDraws(const CharacterSource& source) {
  const SkinMesh& mesh = *source.mesh;
  const auto add = [&](int material, uint64_t first, uint64_t count) {
    CharacterDraw draw;
    const std::vector<Material>& materials = source.materials.materials;
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
  for (const CharacterDraw& draw : draws_) {
    const int color = draw.material.base_color_texture.image;
    const int normal = draw.material.normal_texture.image;
    if (color >= 0) {
      const auto i = static_cast<size_t>(color);
      LIMBER_RETURN_IF_ERROR(AddTexture(set.images.at(i), true, &color_slot_[i]));
    }
    if (normal >= 0) {
      const auto i = static_cast<size_t>(normal);
      LIMBER_RETURN_IF_ERROR(AddTexture(set.images.at(i), false, &normal_slot_[i]));
    }
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
  const auto count = static_cast<uint32_t>(std::max<size_t>(1, draws_.size()));
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * count};
  auto pool = VulkanInfo<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool.maxSets = count;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkCreateDescriptorPool(device_->handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool"));
  for (CharacterDraw& draw : draws_) {
    auto allocate =
        VulkanInfo<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
    allocate.descriptorPool = pool_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    LIMBER_RETURN_IF_ERROR(
        VulkanStatus(vkAllocateDescriptorSets(device_->handle(), &allocate, &draw.set),
                     "vkAllocateDescriptorSets"));
    std::array<VkDescriptorImageInfo, 2> images{};
    std::array<VkWriteDescriptorSet, 2> writes{};
    for (uint32_t i = 0; i < 2; ++i) {
      const MaterialTexture& texture = i == LIMBER_VIEW_BASE_COLOR
                                           ? draw.material.base_color_texture
                                           : draw.material.normal_texture;
      const std::vector<int>& slots = i == LIMBER_VIEW_BASE_COLOR ? color_slot_ : normal_slot_;
      const int slot = texture.image < 0 ? 0 : slots[static_cast<size_t>(texture.image)];
      images[i] = {Sampler(texture), textures_[static_cast<size_t>(slot)].view(),
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
      if (images[i].sampler == VK_NULL_HANDLE) {
        return Error(StatusCode::kDeviceError, "vulkan: vkCreateSampler failed");
      }
      writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      writes[i].dstSet = draw.set;
      writes[i].dstBinding = i;
      writes[i].descriptorCount = 1;
      writes[i].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
      writes[i].pImageInfo = &images[i];
    }
    vkUpdateDescriptorSets(device_->handle(), 2, writes.data(), 0, nullptr);
  }
  return {};
}

Status CharacterModel::RecordSkin(VkCommandBuffer commands, uint32_t frame,
                                  const SkinTransforms& transforms) {
  return skinner_->Record(commands, instance_.get(), frame, transforms, {});
}

void CharacterModel::Bind(VkCommandBuffer commands, uint32_t frame) const {
  const SkinnedVertices skinned = instance_->vertices(frame);
  const VkBuffer buffers[2] = {skinned.buffer, texcoords_.handle()};
  const VkDeviceSize offsets[2] = {skinned.offset, 0};
  vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
  vkCmdBindIndexBuffer(commands, indices_.handle(), 0, VK_INDEX_TYPE_UINT32);
}

}  // namespace limber::viewer
