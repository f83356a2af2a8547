#include "viewer/render_pipelines.h"

#include "core/vector.h"
#include "shaders/background_frag.spv.h"
#include "shaders/character_frag.spv.h"
#include "shaders/character_vert.spv.h"
#include "shaders/dots_frag.spv.h"
#include "shaders/dots_vert.spv.h"
#include "shaders/fullscreen_vert.spv.h"
#include "shaders/ground_frag.spv.h"
#include "shaders/ground_vert.spv.h"
#include "shaders/shadow_vert.spv.h"
#include "shared/view_layout.h"
#include "skin_vulkan/vulkan_skinner.h"
#include "viewer/character_model.h"

#include <array>
#include <span>

namespace limber::viewer {
namespace {

enum class Depth { kNone, kTest, kTestAndWrite };
enum class VertexKind { kNone, kPosition, kCharacter, kDot };

struct VertexLayout {
  Vector<VkVertexInputBindingDescription> bindings;
  Vector<VkVertexInputAttributeDescription> attributes;
};

VertexLayout MakeVertexLayout(VertexKind kind) {
  VertexLayout layout;
  if (kind == VertexKind::kDot) {
    layout.bindings = {{0, sizeof(shaders::DotVertex), VK_VERTEX_INPUT_RATE_INSTANCE}};
    layout.attributes = {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(shaders::DotVertex, position)},
                         {1, 0, VK_FORMAT_R32_UINT, offsetof(shaders::DotVertex, style)}};
  } else if (kind != VertexKind::kNone) {
    layout.bindings = {{0, sizeof(SkinnedVertex), VK_VERTEX_INPUT_RATE_VERTEX}};
    layout.attributes = {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(SkinnedVertex, position)}};
  }
  if (kind == VertexKind::kCharacter) {
    layout.bindings.push_back({1, 2 * sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX});
    layout.attributes.push_back(
        {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(SkinnedVertex, normal)});
    layout.attributes.push_back(
        {2, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(SkinnedVertex, tangent)});
    layout.attributes.push_back({3, 1, VK_FORMAT_R32G32_SFLOAT, 0});
  }
  return layout;
}

VkPipelineColorBlendAttachmentState BlendState(bool blend) {
  VkPipelineColorBlendAttachmentState state{};
  state.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                         VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  state.blendEnable = blend ? VK_TRUE : VK_FALSE;
  state.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  return state;
}

// A shader module that lives as long as the pipeline is being made.
class ShaderModule {
 public:
  explicit ShaderModule(VkDevice device) : device_(device) {}

  ShaderModule(const ShaderModule&) = delete;
  ShaderModule& operator=(const ShaderModule&) = delete;

  ~ShaderModule() { vkDestroyShaderModule(device_, module_, nullptr); }

  Status Create(std::span<const uint32_t> words) {
    auto info = VulkanInfo<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    return VulkanStatus(vkCreateShaderModule(device_, &info, nullptr, &module_),
                        "vkCreateShaderModule");
  }

  VkPipelineShaderStageCreateInfo Stage(VkShaderStageFlagBits stage) const {
    auto info = VulkanInfo<VkPipelineShaderStageCreateInfo>(
        VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
    info.stage = stage;
    info.module = module_;
    info.pName = "main";
    return info;
  }

 private:
  VkDevice device_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

}  // namespace

// What tells one pipeline from another.
struct RenderPipelines::Recipe {
  VkRenderPass pass = VK_NULL_HANDLE;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  std::span<const uint32_t> vertex, fragment;  // fragment may be empty: depth only
  VertexKind vertices = VertexKind::kNone;
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  Depth depth = Depth::kNone;
  bool blend = false, cull = false;
};

RenderPipelines::~RenderPipelines() {
  if (device_ == nullptr) return;
  const VkDevice device = device_->handle();
  for (VkPipeline pipeline : {background_, ground_, dots_, shadow_, character_[0][0],
                              character_[0][1], character_[1][0], character_[1][1]}) {
    vkDestroyPipeline(device, pipeline, nullptr);
  }
  vkDestroySampler(device, shadow_sampler_, nullptr);
  vkDestroyPipelineLayout(device, layout_, nullptr);
  vkDestroyDescriptorSetLayout(device, frame_layout_, nullptr);
  vkDestroyDescriptorSetLayout(device, material_layout_, nullptr);
}

Status RenderPipelines::Create(VulkanDevice* device, const RenderTargets& targets) {
  device_ = device;
  LIMBER_RETURN_IF_ERROR(CreateLayouts());
  LIMBER_RETURN_IF_ERROR(CreateSampler());
  using namespace shaders;
  Recipe recipe;
  recipe.pass = targets.color_pass();
  recipe.samples = targets.samples();
  recipe.vertex = kFullscreenVertSpirv;
  recipe.fragment = kBackgroundFragSpirv;
  LIMBER_RETURN_IF_ERROR(Build(recipe, &background_));

  recipe.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
  recipe.blend = true;
  recipe.vertex = kDotsVertSpirv;
  recipe.fragment = kDotsFragSpirv;
  recipe.vertices = VertexKind::kDot;
  LIMBER_RETURN_IF_ERROR(Build(recipe, &dots_));
  recipe.vertex = kGroundVertSpirv;
  recipe.fragment = kGroundFragSpirv;
  recipe.vertices = VertexKind::kNone;
  recipe.depth = Depth::kTest;
  LIMBER_RETURN_IF_ERROR(Build(recipe, &ground_));

  recipe.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  recipe.vertex = kCharacterVertSpirv;
  recipe.fragment = kCharacterFragSpirv;
  recipe.vertices = VertexKind::kCharacter;
  recipe.depth = Depth::kTestAndWrite;
  for (const size_t i : {0, 1, 2, 3}) {
    const size_t blend = i / 2, double_sided = i % 2;
    recipe.blend = blend == 1;
    recipe.cull = double_sided == 0;
    LIMBER_RETURN_IF_ERROR(Build(recipe, &character_[blend][double_sided]));
  }

  Recipe shadow;
  shadow.pass = targets.shadow_pass();
  shadow.vertex = kShadowVertSpirv;
  shadow.vertices = VertexKind::kPosition;
  shadow.depth = Depth::kTestAndWrite;
  return Build(shadow, &shadow_);
}

Status RenderPipelines::CreateLayouts() {
  const VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  const VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
  const VkDescriptorSetLayoutBinding frame[2] = {
      {LIMBER_VIEW_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, both, nullptr},
      {LIMBER_VIEW_SHADOW_MAP, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, fragment, nullptr}};
  const VkDescriptorSetLayoutBinding material[2] = {
      {LIMBER_VIEW_BASE_COLOR, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, fragment, nullptr},
      {LIMBER_VIEW_NORMAL_MAP, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, fragment, nullptr}};
  auto info = VulkanInfo<VkDescriptorSetLayoutCreateInfo>(
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  info.bindingCount = 2;
  info.pBindings = frame;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkCreateDescriptorSetLayout(device_->handle(), &info, nullptr, &frame_layout_),
                   "vkCreateDescriptorSetLayout"));
  info.pBindings = material;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkCreateDescriptorSetLayout(device_->handle(), &info, nullptr, &material_layout_),
      "vkCreateDescriptorSetLayout"));

  const VkDescriptorSetLayout sets[2] = {frame_layout_, material_layout_};
  const VkPushConstantRange push{fragment, 0, sizeof(shaders::DrawPush)};
  auto layout =
      VulkanInfo<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout.setLayoutCount = 2;
  layout.pSetLayouts = sets;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  return VulkanStatus(vkCreatePipelineLayout(device_->handle(), &layout, nullptr, &layout_),
                      "vkCreatePipelineLayout");
}

Status RenderPipelines::CreateSampler() {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device_->physical_device(), VK_FORMAT_D32_SFLOAT,
                                      &properties);
  const bool linear =
      (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
  auto info = VulkanInfo<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = info.minFilter = linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW =
      VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
  info.borderColor = VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE;  // lit outside the map
  info.compareEnable = VK_TRUE;
  info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  return VulkanStatus(vkCreateSampler(device_->handle(), &info, nullptr, &shadow_sampler_),
                      "vkCreateSampler");
}

Status RenderPipelines::Build(const Recipe& recipe, VkPipeline* pipeline) {
  ShaderModule vertex(device_->handle()), fragment(device_->handle());
  LIMBER_RETURN_IF_ERROR(vertex.Create(recipe.vertex));
  const bool has_fragment = !recipe.fragment.empty();
  if (has_fragment) LIMBER_RETURN_IF_ERROR(fragment.Create(recipe.fragment));
  const VkPipelineShaderStageCreateInfo stages[2] = {vertex.Stage(VK_SHADER_STAGE_VERTEX_BIT),
                                                     fragment.Stage(VK_SHADER_STAGE_FRAGMENT_BIT)};

  const VertexLayout vertices = MakeVertexLayout(recipe.vertices);
  auto input = VulkanInfo<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = static_cast<uint32_t>(vertices.bindings.size());
  input.pVertexBindingDescriptions = vertices.bindings.data();
  input.vertexAttributeDescriptionCount = static_cast<uint32_t>(vertices.attributes.size());
  input.pVertexAttributeDescriptions = vertices.attributes.data();
  auto assembly = VulkanInfo<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = recipe.topology;
  auto viewport = VulkanInfo<VkPipelineViewportStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster = VulkanInfo<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.cullMode = recipe.cull ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  auto multisample = VulkanInfo<VkPipelineMultisampleStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  multisample.rasterizationSamples = recipe.samples;
  auto depth = VulkanInfo<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = recipe.depth != Depth::kNone ? VK_TRUE : VK_FALSE;
  depth.depthWriteEnable = recipe.depth == Depth::kTestAndWrite ? VK_TRUE : VK_FALSE;
  // Equal passes: of the layers of a planar character the later one lies on top.
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  const VkPipelineColorBlendAttachmentState attachment = BlendState(recipe.blend);
  auto blend = VulkanInfo<VkPipelineColorBlendStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = has_fragment ? 1 : 0;
  blend.pAttachments = &attachment;
  const VkDynamicState states[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = VulkanInfo<VkPipelineDynamicStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = states;

  auto info =
      VulkanInfo<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = has_fragment ? 2 : 1;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_;
  info.renderPass = recipe.pass;
  return VulkanStatus(
      vkCreateGraphicsPipelines(device_->handle(), VK_NULL_HANDLE, 1, &info, nullptr, pipeline),
      "vkCreateGraphicsPipelines");
}

}  // namespace limber::viewer
