/* The README's lines for engines with a Vulkan renderer; tests/runtime/host runs them. */
#include "frame.h"

#include <stddef.h>

/* [the README's lines begin] */
#include <limber/limber_vulkan.h>

/* Once: the renderer's own device and loader. No library to link, no feature to enable. */
LimberResult Attach(LimberContext* context, const Renderer* renderer, LimberVulkanId* skinning) {
  LimberVulkanDef def = limberDefaultVulkanDef();
  def.instance = renderer->instance;
  def.physical_device = renderer->physical_device;
  def.device = renderer->device;
  def.get_instance_proc_addr = renderer->get_instance_proc_addr;
  def.frames_in_flight = renderer->frames_in_flight;
  return limberCreateVulkan(context, &def, skinning);
}

/* Each frame, before the render pass: into the renderer's vertex buffer (usage: storage as well).
 */
LimberResult RecordSkin(LimberContext* context, LimberVulkanId skinning, VkCommandBuffer commands,
                        uint32_t slot, LimberInstanceId character, VkBuffer vertices,
                        uint32_t num_vertices) {
  LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
  LimberVulkanSkinDef skin = limberDefaultVulkanSkinDef();
  frame.commands = commands;
  frame.slot = slot; /* of the frame in flight; vertices are ready for vertex input behind this */
  skin.instance = character;
  skin.num_vertices = num_vertices;
  skin.positions.buffer = skin.normals.buffer = vertices;
  skin.normals.offset = offsetof(Vertex, normal);
  skin.positions.stride = skin.normals.stride = sizeof(Vertex);
  return limberRecordVulkanSkins(context, skinning, &frame, &skin, 1);
}

/* [the README's lines end] */
