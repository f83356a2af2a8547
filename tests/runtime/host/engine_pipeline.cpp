#include "engine_renderer.h"
#include "shaders/character_frag.spv.h"
#include "shaders/character_vert.spv.h"

#include <cstddef>
#include <cstdlib>

namespace engine {
namespace {

void Require(VkResult result) {
  if (result != VK_SUCCESS) std::abort();
}

VkShaderModule MakeModule(VkDevice device, const uint32_t* words, size_t bytes) {
  auto info = Tagged<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = bytes;
  info.pCode = words;
  VkShaderModule module = VK_NULL_HANDLE;
  Require(vkCreateShaderModule(device, &info, nullptr, &module));
  return module;
}

}  // namespace

void Renderer::MakePipeline() {
  const VkPushConstantRange push = {VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                    112};
  auto layout = Tagged<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  Require(vkCreatePipelineLayout(device_->device, &layout, nullptr, &layout_));

  using namespace limber::shaders;  // NOLINT(google-build-using-namespace): where the build puts
                                    // them
  VkPipelineShaderStageCreateInfo stages[2];
  stages[0] = stages[1] =
      Tagged<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = MakeModule(device_->device, kCharacterVertSpirv, sizeof(kCharacterVertSpirv));
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = MakeModule(device_->device, kCharacterFragSpirv, sizeof(kCharacterFragSpirv));
  stages[0].pName = stages[1].pName = "main";

  const VkVertexInputBindingDescription binding = {0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX};
  const VkVertexInputAttributeDescription attributes[3] = {
      {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
      {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, normal)},
      {2, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, last)}};
  auto input = Tagged<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = 1;
  input.pVertexBindingDescriptions = &binding;
  input.vertexAttributeDescriptionCount = 3;
  input.pVertexAttributeDescriptions = attributes;
  auto assembly = Tagged<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const VkViewport viewport = {0, 0, kWidth, kHeight, 0, 1};
  const VkRect2D scissor = {{0, 0}, {kWidth, kHeight}};
  auto view = Tagged<VkPipelineViewportStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  view.viewportCount = view.scissorCount = 1;
  view.pViewports = &viewport;
  view.pScissors = &scissor;
  auto raster = Tagged<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;  // as in glTF
  raster.lineWidth = 1;
  auto samples = Tagged<VkPipelineMultisampleStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  auto depth = Tagged<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS;
  VkPipelineColorBlendAttachmentState written = {};
  written.colorWriteMask = 0xF;
  auto blend = Tagged<VkPipelineColorBlendStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = 1;
  blend.pAttachments = &written;

  auto info = Tagged<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &view;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.layout = layout_;
  info.renderPass = pass_;
  for (VkPipeline& pipeline : pipelines_) {
    Require(
        vkCreateGraphicsPipelines(device_->device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline));
    depth.depthTestEnable = depth.depthWriteEnable = VK_FALSE;
  }
  for (const VkPipelineShaderStageCreateInfo& stage : stages)
    vkDestroyShaderModule(device_->device, stage.module, nullptr);
}

}  // namespace engine
