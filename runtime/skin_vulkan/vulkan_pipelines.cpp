#include "skin_vulkan/vulkan_pipelines.h"

#include "core/vector.h"
#include "shaders/skin_positions.spv.h"
#include "shaders/skin_vertices.spv.h"
#include "shared/skin_layout.h"

namespace limber {
namespace {

// Rigs up to this size have the loops of pass 1 laid out: some 12 instructions for a matrix, which
// instruction caches hold, and three registers for a shape.
bool IsUnrolled(uint32_t num_handles, uint32_t num_shapes) {
  return num_shapes <= 12 && uint64_t{num_handles} * num_shapes <= 128;
}

}  // namespace

SkinPipelines::~SkinPipelines() {
  if (api_ == nullptr) return;
  for (const Positions& positions : positions_)
    api_->DestroyPipeline(api_->device, positions.pipeline, api_->callbacks);
  api_->DestroyPipeline(api_->device, vertices_, api_->callbacks);
  api_->DestroyPipelineLayout(api_->device, layout_, api_->callbacks);
  for (VkDescriptorSetLayout layout : set_layouts_)
    api_->DestroyDescriptorSetLayout(api_->device, layout, api_->callbacks);
}

Status SkinPipelines::Create(const VulkanApi& api, const SkinPipelineOptions& options) {
  api_ = &api;
  options_ = options;
  constexpr std::array<uint32_t, kNumSets> kNumBindings = {LIMBER_SKIN_NUM_RIG_BINDINGS,
                                                           LIMBER_SKIN_NUM_BATCH_BINDINGS};
  static_assert(kNumBindings[0] + kNumBindings[1] == kNumSkinBuffers);
  for (size_t set = 0; set < kNumSets; ++set)
    LIMBER_RETURN_IF_ERROR(CreateSetLayout(kNumBindings[set], &set_layouts_[set]));
  LIMBER_RETURN_IF_ERROR(CreateLayout());
  return CreatePipeline(shaders::kSkinVerticesSpirv, sizeof(shaders::kSkinVerticesSpirv), 1, 1,
                        &vertices_);
}

Status SkinPipelines::FindPositions(uint32_t num_handles, uint32_t num_shapes,
                                    VkPipeline* pipeline) {
  for (const Positions& positions : positions_) {
    if (positions.num_handles != num_handles || positions.num_shapes != num_shapes) continue;
    *pipeline = positions.pipeline;
    return {};
  }
  positions_.push_back({num_handles, num_shapes, VK_NULL_HANDLE});
  Status made = CreatePipeline(shaders::kSkinPositionsSpirv, sizeof(shaders::kSkinPositionsSpirv),
                               num_handles, num_shapes, &positions_.back().pipeline);
  *pipeline = positions_.back().pipeline;
  if (!made.ok()) positions_.pop_back();
  return made;
}

Status SkinPipelines::CreateSetLayout(uint32_t num_bindings, VkDescriptorSetLayout* layout) {
  Vector<VkDescriptorSetLayoutBinding> bindings(num_bindings);
  for (uint32_t i = 0; i < num_bindings; ++i) {
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  auto info = VulkanInfo<VkDescriptorSetLayoutCreateInfo>(
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  info.bindingCount = num_bindings;
  info.pBindings = bindings.data();
  return VulkanStatus(api_->CreateDescriptorSetLayout(api_->device, &info, api_->callbacks, layout),
                      "vkCreateDescriptorSetLayout");
}

Status SkinPipelines::CreateLayout() {
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(shaders::SkinPush)};
  auto info = VulkanInfo<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = static_cast<uint32_t>(set_layouts_.size());
  info.pSetLayouts = set_layouts_.data();
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &push;
  return VulkanStatus(api_->CreatePipelineLayout(api_->device, &info, api_->callbacks, &layout_),
                      "vkCreatePipelineLayout");
}

Status SkinPipelines::CreatePipeline(const uint32_t* words, size_t bytes, uint32_t num_handles,
                                     uint32_t num_shapes, VkPipeline* pipeline) {
  auto module_info =
      VulkanInfo<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module_info.codeSize = bytes;
  module_info.pCode = words;
  VkShaderModule module = VK_NULL_HANDLE;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(api_->CreateShaderModule(api_->device, &module_info, api_->callbacks, &module),
                   "vkCreateShaderModule"));

  const bool unrolled = IsUnrolled(num_handles, num_shapes);
  const std::array<uint32_t, 5> constants = {num_handles, num_shapes, unrolled ? VK_TRUE : VK_FALSE,
                                             options_.many_in_a_dispatch ? VK_TRUE : VK_FALSE,
                                             unrolled ? num_shapes : 1};
  constexpr std::array<VkSpecializationMapEntry, 5> kEntries = {{
      {LIMBER_SKIN_CONSTANT_HANDLES, 0, 4},
      {LIMBER_SKIN_CONSTANT_SHAPES, 4, 4},
      {LIMBER_SKIN_CONSTANT_UNROLLED, 8, 4},
      {LIMBER_SKIN_CONSTANT_MANY, 12, 4},
      {LIMBER_SKIN_CONSTANT_KEPT, 16, 4},
  }};
  const VkSpecializationInfo specialization{kEntries.size(), kEntries.data(), sizeof(constants),
                                            constants.data()};
  auto info =
      VulkanInfo<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout_;
  const VkResult result = api_->CreateComputePipelines(api_->device, options_.cache, 1, &info,
                                                       api_->callbacks, pipeline);
  api_->DestroyShaderModule(api_->device, module, api_->callbacks);
  return VulkanStatus(result, "vkCreateComputePipelines");
}

}  // namespace limber
