// A character on the device: its skinner, triangles, texture coordinates, materials and textures.
#pragma once

#include "core/vector.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin_vulkan/vulkan_skinner.h"
#include "viewer/gpu_image.h"
#include "viewer/materials.h"
#include "viewer/texture.h"

#include <memory>

namespace limber::viewer {

// One vertex as skinning writes it; attribute formats in brackets.
struct SkinnedVertex {
  float position[3];  // mesh space                           [R32G32B32_SFLOAT]
  float normal[3];    // unit                                 [R32G32B32_SFLOAT]
  float tangent[4];   // unit, orthogonal to normal; handedness [R32G32B32A32_SFLOAT]
};

// What is to be drawn; everything is copied.
struct CharacterSource {
  const SkinMesh* mesh = nullptr;
  RigSpace space;
  int dimension = 3;  // 2: planar, drawn unlit and seen from the front
  MaterialSet materials;
};

// Triangles of one material.
struct CharacterDraw {
  Material material;
  uint32_t first_index = 0, num_indices = 0;
  VkDescriptorSet set = VK_NULL_HANDLE;
};

class CharacterModel {
 public:
  // Uploads and waits. `material_layout` has the two samplers of set 1 (view_layout.h).
  // Errors: kMalformed, kLimitExceeded, kDeviceError.
  static Result<std::unique_ptr<CharacterModel>> Create(VulkanDevice* device,
                                                        const CharacterSource& source,
                                                        VkDescriptorSetLayout material_layout,
                                                        uint32_t frames_in_flight);
  CharacterModel(const CharacterModel&) = delete;
  CharacterModel& operator=(const CharacterModel&) = delete;
  ~CharacterModel();

  // Records skinning into slot `frame` (see VulkanSkinner::Record), outside a render pass.
  Status RecordSkin(VkCommandBuffer commands, uint32_t frame, const SkinTransforms& transforms);
  // Binds vertices (bindings 0 and 1) and indices.
  void Bind(VkCommandBuffer commands, uint32_t frame) const;

  // Opaque ones first.
  const Vector<CharacterDraw>& draws() const { return draws_; }

  uint32_t num_indices() const { return num_indices_; }

 private:
  explicit CharacterModel(VulkanDevice* device) : device_(device) {}

  Status CreateSkinner(const CharacterSource& source, uint32_t frames_in_flight);
  VertexStream Stream(uint32_t frame, size_t offset) const;
  Status CreateMesh(const SkinMesh& mesh);
  void ListDraws(const CharacterSource& source);
  Status CreateTextures(const MaterialSet& set);
  Status CreateSets(VkDescriptorSetLayout layout);
  Status WriteSet(const CharacterDraw& draw);
  Status AddTexture(const Image& image, bool srgb, int* slot);
  VkSampler Sampler(const MaterialTexture& texture);

  VulkanDevice* device_;
  std::unique_ptr<VulkanSkinner> skinner_;
  const VulkanSkinRig* rig_ = nullptr;
  VulkanBuffer vertices_;  // of every slot, one after the other
  VulkanBuffer indices_, texcoords_;
  uint32_t num_indices_ = 0, num_vertices_ = 0;
  Vector<CharacterDraw> draws_;
  Vector<GpuImage> textures_;             // [0] is one white pixel
  Vector<int> color_slot_, normal_slot_;  // by image: index into textures_, -1 unused
  Vector<std::pair<uint32_t, VkSampler>> samplers_;
  VulkanDescriptors sets_;
};

}  // namespace limber::viewer
