#include "skin_vulkan/vulkan_pipelines.h"

#include "shaders/skin_frames.spv.h"
#include "shaders/skin_positions.spv.h"
#include "shaders/skin_positions_storage.spv.h"
#include "shared/skin_layout.h"

#include <array>

namespace limber {

SkinPipelines::~SkinPipelines() {
  if (api_ == nullptr) return;
  api_->DestroyPipeline(api_->device, positions_, api_->callbacks);
  api_->DestroyPipeline(api_->device, frames_, api_->callbacks);
  api_->DestroyPipelineLayout(api_->device, layout_, api_->callbacks);
  api_->DestroyDescriptorSetLayout(api_->device, set_layout_, api_->callbacks);
}

Status SkinPipelines::Create(const VulkanApi& api, const SkinPipelineOptions& options) {
  api_ = &api;
  matrices_type_ = options.matrices_in_storage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                               : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  LIMBER_RETURN_IF_ERROR(CreateLayouts());
  using namespace shaders;
  LIMBER_RETURN_IF_ERROR(
      options.matrices_in_storage
          ? CreatePipeline(kSkinPositionsStorageSpirv, sizeof(kSkinPositionsStorageSpirv), options,
                           &positions_)
          : CreatePipeline(kSkinPositionsSpirv, sizeof(kSkinPositionsSpirv), options, &positions_));
  return CreatePipeline(kSkinFramesSpirv, sizeof(kSkinFramesSpirv), options, &frames_);
}

Status SkinPipelines::CreateLayouts() {
  std::array<VkDescriptorSetLayoutBinding, LIMBER_SKIN_NUM_BINDINGS> bindings{};
  for (uint32_t i = 0; i < bindings.size(); ++i) {
    bindings[i].binding = i;
    bindings[i].descriptorType =
        i == LIMBER_SKIN_MATRICES ? matrices_type_ : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  auto set_info = VulkanInfo<VkDescriptorSetLayoutCreateInfo>(
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set_info.bindingCount = static_cast<uint32_t>(bindings.size());
  set_info.pBindings = bindings.data();
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      api_->CreateDescriptorSetLayout(api_->device, &set_info, api_->callbacks, &set_layout_),
      "vkCreateDescriptorSetLayout"));

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(shaders::SkinPush)};
  auto info = VulkanInfo<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout_;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &push;
  return VulkanStatus(api_->CreatePipelineLayout(api_->device, &info, api_->callbacks, &layout_),
                      "vkCreatePipelineLayout");
}

Status SkinPipelines::CreatePipeline(const uint32_t* words, size_t bytes,
                                     const SkinPipelineOptions& options, VkPipeline* pipeline) {
  auto module_info =
      VulkanInfo<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module_info.codeSize = bytes;
  module_info.pCode = words;
  VkShaderModule module = VK_NULL_HANDLE;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(api_->CreateShaderModule(api_->device, &module_info, api_->callbacks, &module),
                   "vkCreateShaderModule"));

  const uint32_t constants[3] = {options.num_handles, options.num_shapes,
                                 options.num_handles * options.num_shapes * 3};
  const VkSpecializationMapEntry entries[3] = {
      {LIMBER_SKIN_CONSTANT_HANDLES, 0, 4},
      {LIMBER_SKIN_CONSTANT_SHAPES, 4, 4},
      {LIMBER_SKIN_CONSTANT_ROWS, 8, 4},
  };
  const VkSpecializationInfo specialization{3, entries, sizeof(constants), constants};
  auto info =
      VulkanInfo<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout_;
  const VkResult result = api_->CreateComputePipelines(api_->device, options.cache, 1, &info,
                                                       api_->callbacks, pipeline);
  api_->DestroyShaderModule(api_->device, module, api_->callbacks);
  return VulkanStatus(result, "vkCreateComputePipelines");
}

}  // namespace limber
