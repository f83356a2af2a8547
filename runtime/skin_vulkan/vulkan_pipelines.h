// The compute pipelines of skinning and the layouts that they share.
#pragma once

#include "core/vector.h"
#include "skin_vulkan/vulkan_api.h"

#include <array>

namespace limber {

struct SkinPipelineOptions {
  bool many_in_a_dispatch = true;  // else one instance each
  VkPipelineCache cache = VK_NULL_HANDLE;
};

class SkinPipelines {
 public:
  static constexpr size_t kNumSets = 2;

  SkinPipelines() = default;
  SkinPipelines(const SkinPipelines&) = delete;
  SkinPipelines& operator=(const SkinPipelines&) = delete;
  ~SkinPipelines();

  // The layouts and pass 2. `api` must outlive the object. Errors: kDeviceError. Once.
  Status Create(const VulkanApi& api, const SkinPipelineOptions& options);

  // Pass 1 for rigs of so many handles and shapes; made when it is first asked for, and kept.
  // Errors: kDeviceError.
  Status FindPositions(uint32_t num_handles, uint32_t num_shapes, VkPipeline* pipeline);

  // Of one of the sets in shaders/shared/skin_layout.h, all its descriptors storage buffers.
  VkDescriptorSetLayout set_layout(uint32_t set) const { return set_layouts_[set]; }

  VkPipelineLayout layout() const { return layout_; }

  VkPipeline vertices() const { return vertices_; }

 private:
  struct Positions {
    uint32_t num_handles, num_shapes;
    VkPipeline pipeline;
  };

  Status CreateSetLayout(uint32_t num_bindings, VkDescriptorSetLayout* layout);
  Status CreateLayout();
  Status CreatePipeline(const uint32_t* words, size_t bytes, uint32_t num_handles,
                        uint32_t num_shapes, VkPipeline* pipeline);

  const VulkanApi* api_ = nullptr;
  SkinPipelineOptions options_;
  std::array<VkDescriptorSetLayout, kNumSets> set_layouts_{};
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline vertices_ = VK_NULL_HANDLE;
  Vector<Positions> positions_;
};

}  // namespace limber
