/* Limber: skinning on the host's Vulkan device. Goes with limber.h; needs the Vulkan headers.
 *
 * The host hands over its device and loader; Limber records compute dispatches into the host's
 * command buffer and writes into the host's vertex buffers. It makes no device, owns no queue,
 * submits nothing, waits for nothing and links no Vulkan library.
 *
 *   limberCreateVulkan       once for each VkDevice and queue
 *   limberRecordVulkanSkins  once a frame: every instance that is to be seen in it
 *
 * What the device must have: Vulkan 1.1, a queue family with compute,
 * LIMBER_VULKAN_STORAGE_BUFFERS storage buffers in one stage (all but some phones do; else skin on
 * the CPU). No feature, no extension. What the vertex buffers must have: the usage
 * VK_BUFFER_USAGE_STORAGE_BUFFER_BIT beside the host's own.
 *
 * Threads: calls about one LimberVulkanId, and about the instances that it records, come from one
 * thread at a time. */
#ifndef LIMBER_LIMBER_VULKAN_H
#define LIMBER_LIMBER_VULKAN_H
/* NOLINTBEGIN(readability-identifier-naming,modernize-*): C's own names and ways */

#include "limber/limber.h"

#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of VkPhysicalDeviceLimits::maxPerStageDescriptorStorageBuffers. */
#define LIMBER_VULKAN_STORAGE_BUFFERS 13

typedef struct LimberVulkanId {
  uint32_t index, generation; /* both zero: none */
} LimberVulkanId;

/* A buffer with its memory, as the host's allocator made it. */
typedef struct LimberVulkanBuffer {
  VkBuffer buffer;
  void* mapped;     /* needed where `required` has HOST_VISIBLE, else may be null */
  void* allocation; /* the allocator's own, handed back to the second function */
} LimberVulkanBuffer;

/* Makes a buffer in memory that has all of the `required` properties, and the `preferred` ones
 * where it can; mapped while it lives where it is host-visible and coherent. Called while a rig is
 * first prepared and when a crowd grows beyond all before it, not in a steady frame; on the thread
 * of the call, with no lock held. */
typedef VkResult (*LimberVulkanCreateBufferFunction)(void* user, const VkBufferCreateInfo* info,
                                                     VkMemoryPropertyFlags required,
                                                     VkMemoryPropertyFlags preferred,
                                                     LimberVulkanBuffer* buffer);
typedef void (*LimberVulkanDestroyBufferFunction)(void* user, const LimberVulkanBuffer* buffer);

typedef struct LimberVulkanDef {
  uint32_t cookie, struct_size; /* set by limberDefaultVulkanDef; leave them */
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr; /* volk's, SDL's, GLFW's or the loader's own */
  const VkAllocationCallbacks* callbacks;           /* may be null; copied by nobody */
  VkPipelineCache pipeline_cache;                   /* may be null */
  /* For example around vmaCreateBuffer. Both null: memory from the device itself, in few and large
   * pieces. */
  LimberVulkanCreateBufferFunction create_buffer;
  LimberVulkanDestroyBufferFunction destroy_buffer;
  void* buffer_user;
  uint32_t frames_in_flight; /* 1 to 16 (2) */
} LimberVulkanDef;

LIMBER_API LimberVulkanDef limberDefaultVulkanDef(void);

/* All handles stay the host's, and outlive the id. Milliseconds (a pipeline). Errors:
 * INVALID_ARGUMENT, STRUCT_NOT_DEFAULT, LIMIT_EXCEEDED (too few storage buffers), DEVICE,
 * DEVICE_LOST, OUT_OF_MEMORY. */
LIMBER_API LimberResult limberCreateVulkan(LimberContext* context, const LimberVulkanDef* def,
                                           LimberVulkanId* vulkan);

/* Frees all that was made on the device; the host has waited for the frames that used it, or has
 * lost the device. Before limberDestroyContext, which else does it. Errors: STALE_ID.
 *
 * A lost device: any call may answer LIMBER_ERROR_DEVICE_LOST, or the host learns it first. Then
 * destroy the id (before the VkDevice), and make another with the next device. Rigs, instances,
 * targets and poses are in the host's memory and go on as they were. */
LIMBER_API LimberResult limberDestroyVulkan(LimberContext* context, LimberVulkanId vulkan);

/* Makes a rig's tables and pipeline now, so that the first frame that shows the rig need not wait
 * for it (milliseconds; a pipeline for each pair of handle and shape counts). The next recorded
 * frame puts the tables in place. They are freed when the rig and all its instances are gone.
 * Errors: STALE_ID, LIMIT_EXCEEDED (a table larger than the device reads), DEVICE, DEVICE_LOST. */
LIMBER_API LimberResult limberPrepareVulkanRig(LimberContext* context, LimberVulkanId vulkan,
                                               LimberRigId rig);

/* Where one kind of numbers goes: the first vertex's first float, and bytes from vertex to vertex;
 * both multiples of 4. The host's own buffer and layout, interleaved or not. */
typedef struct LimberVulkanOutput {
  VkBuffer buffer; /* null: not wanted */
  VkDeviceSize offset;
  uint32_t stride;
} LimberVulkanOutput;

/* One instance in a frame; begin with limberDefaultVulkanSkinDef. */
typedef struct LimberVulkanSkinDef {
  uint32_t cookie, struct_size;
  LimberInstanceId instance;         /* LimberInstanceDef::skin may be 0: that is for the CPU */
  uint32_t num_vertices;             /* that there is room for: LimberRigInfo::num_vertices */
  LimberVulkanOutput positions;      /* 3 floats each, mesh space */
  LimberVulkanOutput normals;        /* 3 floats each, unit, recomputed from the deformed surface */
  LimberVulkanOutput tangents;       /* 4 floats each as in glTF: unit, and the bitangent's sign */
  LimberVulkanOutput last_positions; /* 3 floats each, for motion vectors: the positions of the
                                        frame recorded before, if the instance was in it with this
                                        rig, else this one's */
  int32_t jumps;                     /* 1: this one's as well, as after a cut or a teleport (0) */
} LimberVulkanSkinDef;

LIMBER_API LimberVulkanSkinDef limberDefaultVulkanSkinDef(void);

typedef struct LimberVulkanFrameDef {
  uint32_t cookie, struct_size;
  VkCommandBuffer commands; /* recording, outside a render pass, of a queue with compute */
  uint32_t slot;            /* below frames_in_flight; its last use is over on the device */
  /* Who reads the vertices first (vertex input's attributes): a barrier behind the last dispatch
   * makes them visible there, one before the first write waits for those reads of what was there
   * before. 0 and 0: no such barriers; then wait for VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT and
   * VK_ACCESS_SHADER_WRITE_BIT, as across queues. */
  VkPipelineStageFlags reader_stage;
  VkAccessFlags reader_access;
} LimberVulkanFrameDef;

LIMBER_API LimberVulkanFrameDef limberDefaultVulkanFrameDef(void);

/* Records the skins of the last solves: two dispatches and at most three barriers for all instances
 * of a rig whose vertices follow each other in one buffer, else two dispatches each. Once a frame;
 * the command buffer must be submitted, to one queue, in the order of recording. Leaves changed, of
 * the compute bind point: pipeline, descriptor sets 0 and 1, push constants. Instances are copied:
 * they may be solved again at once. [frame] but for what is new. Errors, nothing being recorded:
 * STALE_ID, STRUCT_NOT_DEFAULT, INVALID_ARGUMENT (an instance twice, a layout that does not fit, a
 * slot beyond frames_in_flight), LIMIT_EXCEEDED, DEVICE, DEVICE_LOST; the message names the
 * instance by its place in `skins`. */
LIMBER_API LimberResult limberRecordVulkanSkins(LimberContext* context, LimberVulkanId vulkan,
                                                const LimberVulkanFrameDef* frame,
                                                const LimberVulkanSkinDef* skins, uint32_t count);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(readability-identifier-naming,modernize-*) */
#endif /* LIMBER_LIMBER_VULKAN_H */
