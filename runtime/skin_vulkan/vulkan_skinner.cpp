#include "skin_vulkan/vulkan_skinner.h"

#include "shared/skin_layout.h"

#include <algorithm>
#include <cstring>

namespace limber {
namespace {

// Buffers and sets grow beyond what is asked for, so that a crowd that grows one by one does not
// make new ones each time.
template <class Count>
Count WithRoom(Count count) {
  return count + count / 2;
}

constexpr VkDeviceSize kPositionBytes = 16;  // of a solve vertex in the scratch

constexpr SkinConsumer kCompute = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT};

uint32_t NumWorkGroups(uint32_t count) {
  return count / LIMBER_SKIN_GROUP_SIZE + (count % LIMBER_SKIN_GROUP_SIZE != 0 ? 1 : 0);
}

// The matrices as they are, but for the translations: their sum over the shapes goes into shape 0,
// so that the shader need not add one in every step. Mapped memory may be uncached: it is written
// in order and never read.
void WriteMatrices(const SkinRigCounts& counts, std::span<const float> matrices, float* out) {
  const size_t handle_floats = size_t{counts.num_shapes} * 12;
  for (size_t begin = 0; begin < matrices.size(); begin += handle_floats) {
    float sums[3] = {};
    for (size_t i = begin; i < begin + handle_floats; i += 12) {
      for (size_t row = 0; row < 3; ++row)
        sums[row] += matrices[i + row * 4 + 3];
    }
    std::memcpy(out + begin, matrices.data() + begin, handle_floats * sizeof(float));
    for (size_t row = 0; row < 3; ++row)
      out[begin + row * 4 + 3] = sums[row];
  }
}

}  // namespace

VulkanSkinner::~VulkanSkinner() = default;

Result<std::unique_ptr<VulkanSkinner>> VulkanSkinner::Create(const VulkanHost& host,
                                                             const VulkanSkinnerOptions& options) {
  if (options.frames_in_flight < 1 || options.frames_in_flight > 16) {
    return Error(StatusCode::kInvalidArgument, "vulkan skinner: %u frames in flight; take 1 to 16",
                 options.frames_in_flight);
  }
  VulkanApi api;
  LIMBER_RETURN_IF_ERROR(LoadVulkanApi(host, &api));
  if (api.limits.maxPerStageDescriptorStorageBuffers < kNumSkinBuffers) {
    return Error(StatusCode::kLimitExceeded,
                 "vulkan skinner: the device takes %u storage buffers in a stage, %u are needed; "
                 "skin on the CPU",
                 api.limits.maxPerStageDescriptorStorageBuffers, kNumSkinBuffers);
  }
  using Dispatch = VulkanSkinnerOptions::Dispatch;
  const bool many = options.dispatch == Dispatch::kAsTheDeviceLikes
                        ? api.device_type != VK_PHYSICAL_DEVICE_TYPE_CPU
                        : options.dispatch == Dispatch::kMany;
  std::unique_ptr<VulkanSkinner> skinner(new VulkanSkinner(api, options, many));
  LIMBER_RETURN_IF_ERROR(skinner->pipelines_.Create(skinner->api_, {many, host.pipeline_cache}));
  skinner->slots_.resize(options.frames_in_flight);
  return skinner;
}

Result<const VulkanSkinRig*> VulkanSkinner::AddRig(const SkinMesh& mesh, const RigSpace& space) {
  auto rig = VulkanSkinRig::Create(api_, &pipelines_, mesh, space, options_.force_staging);
  if (!rig.ok()) return rig.status();
  rigs_.push_back(std::move(rig).value());
  return rigs_.back().get();
}

void VulkanSkinner::RemoveRig(const VulkanSkinRig* rig) {
  const auto found =
      std::find_if(rigs_.begin(), rigs_.end(), [rig](const auto& r) { return r.get() == rig; });
  if (found == rigs_.end()) return;
  if (last_slot_ != nullptr) last_slot_->old_rigs.push_back(std::move(*found));
  rigs_.erase(found);
}

Status VulkanSkinner::Record(VkCommandBuffer commands, uint32_t frame,
                             std::span<const VulkanSkinJob> jobs, const SkinConsumer& consumer) {
  if (frame >= options_.frames_in_flight) {
    return Error(StatusCode::kInvalidArgument, "vulkan skinner: frame %u of %u", frame,
                 options_.frames_in_flight);
  }
  Slot& slot = slots_[frame];
  LIMBER_RETURN_IF_ERROR(batches_.Plan(jobs));
  slot.old_buffers.clear();
  slot.old_rigs.clear();
  LIMBER_RETURN_IF_ERROR(MakeRoom(&slot));
  last_slot_ = &slot;
  scratch().places.clear();
  for (size_t i = 0; i < batches_.batches().size(); ++i) {
    WriteBatch(batches_.batches()[i], jobs, slot, (*slot.sets)[i]);
  }
  auto& places = scratch().places;
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.instance < b.instance; });
  if (!jobs.empty()) {
    RecordUploads(commands, &slot);
    RecordPass(commands, slot, true);
    RecordBarrier(commands, {kCompute.stage | consumer.stage, VK_ACCESS_SHADER_WRITE_BIT},
                  kCompute);
    RecordPass(commands, slot, false);
    if (consumer.stage != 0)
      RecordBarrier(commands, {kCompute.stage, VK_ACCESS_SHADER_WRITE_BIT}, consumer);
  }
  ++num_frames_;
  return {};
}

// The slot's last frame is over, so what is in the way can go at once; but the scratch may be read
// by the frame that was recorded last.
Status VulkanSkinner::MakeRoom(Slot* slot) {
  if (batches_.upload_bytes() > slot->upload.size()) {
    LIMBER_RETURN_IF_ERROR(slot->upload.Create(api_, WithRoom(batches_.upload_bytes()),
                                               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, kUploadMemory));
    NameVulkanObject(api_, VK_OBJECT_TYPE_BUFFER, VulkanObject(slot->upload.handle()),
                     "limber matrices");
  }
  if (batches_.batches().size() > slot->num_sets) {
    const size_t count = WithRoom(batches_.batches().size());
    auto sets = std::make_unique<VulkanDescriptors>();
    const VkDescriptorPoolSize of_each{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       LIMBER_SKIN_NUM_BATCH_BINDINGS};
    LIMBER_RETURN_IF_ERROR(
        sets->Create(api_, pipelines_.set_layout(LIMBER_SKIN_SET_BATCH), count, {&of_each, 1}));
    slot->sets = std::move(sets);
    slot->num_sets = count;
  }
  if (batches_.scratch_bytes() > scratch().buffer.size()) {
    VulkanBuffer larger;
    LIMBER_RETURN_IF_ERROR(larger.Create(api_, WithRoom(batches_.scratch_bytes()),
                                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, kDeviceMemory));
    NameVulkanObject(api_, VK_OBJECT_TYPE_BUFFER, VulkanObject(larger.handle()),
                     "limber positions");
    if (last_slot_ != nullptr) last_slot_->old_buffers.push_back(std::move(scratch().buffer));
    scratch().buffer = std::move(larger);
  }
  return {};
}

const VulkanSkinner::Place* VulkanSkinner::FindLast(const VulkanSkinJob& job) const {
  if (job.last_positions.buffer == VK_NULL_HANDLE || job.jumps) return nullptr;
  const auto& places = last_scratch().places;
  const auto found = std::lower_bound(
      places.begin(), places.end(), job.instance,
      [](const Place& place, uint64_t instance) { return place.instance < instance; });
  // Under another rig the instance had other vertices.
  const bool was_there =
      found != places.end() && found->instance == job.instance && found->rig == job.rig;
  return was_there ? &*found : nullptr;
}

// The part of the last scratch that a batch reads; where the device cannot bind as much, the
// instances beyond have no last positions.
BufferRange VulkanSkinner::LastRange(const SkinBatch& batch,
                                     std::span<const VulkanSkinJob> jobs) const {
  VkDeviceSize begin = last_scratch().buffer.size(), end = 0;
  for (const uint32_t number : batches_.order().subspan(batch.first, batch.count)) {
    const Place* last = FindLast(jobs[number]);
    if (last == nullptr) continue;
    const VkDeviceSize at = VkDeviceSize{last->position} * kPositionBytes;
    begin = std::min(begin, at);
    end = std::max(end, at + batch.rig->counts().num_solve_vertices * kPositionBytes);
  }
  if (begin >= end) return {};
  begin = begin / api_.limits.minStorageBufferOffsetAlignment *
          api_.limits.minStorageBufferOffsetAlignment;
  return {begin, std::min<VkDeviceSize>(end - begin, api_.limits.maxStorageBufferRange)};
}

shaders::SkinRecord VulkanSkinner::RecordOf(const SkinBatch& batch, const VulkanSkinJob& job,
                                            const BufferRange& last_range) const {
  shaders::SkinRecord record{};
  std::copy_n(&job.transforms.origin.x, 3, record.origin);
  record.last = LIMBER_SKIN_NO_LAST;
  const VkDeviceSize bytes = batch.rig->counts().num_solve_vertices * kPositionBytes;
  if (const Place* last = FindLast(job); last != nullptr) {
    const VkDeviceSize at = VkDeviceSize{last->position} * kPositionBytes - last_range.offset;
    if (at + bytes <= last_range.size) {
      record.last = static_cast<uint32_t>(at / kPositionBytes);
      std::copy_n(&last->origin.x, 3, record.last_origin);
    }
  }
  for (uint32_t stream = 0; stream < LIMBER_SKIN_NUM_STREAMS; ++stream) {
    const VertexStream& s = StreamOf(job, stream);
    if (s.buffer == VK_NULL_HANDLE) continue;
    const VkDeviceSize from = s.offset - batch.stream_ranges[stream].offset;
    record.stream_first[stream] = static_cast<uint32_t>(from / sizeof(float));
    record.stream_step[stream] = static_cast<uint32_t>(s.stride / sizeof(float));
  }
  return record;
}

void VulkanSkinner::WriteBatch(const SkinBatch& batch, std::span<const VulkanSkinJob> jobs,
                               const Slot& slot, VkDescriptorSet set) {
  const SkinRigCounts& counts = batch.rig->counts();
  auto* matrices = reinterpret_cast<float*>(slot.upload.mapped() + batch.matrices.offset);
  std::byte* records = slot.upload.mapped() + batch.records.offset;
  const BufferRange last = LastRange(batch, jobs);
  for (uint32_t i = 0; i < batch.count; ++i) {
    const VulkanSkinJob& job = jobs[batches_.order()[batch.first + i]];
    WriteMatrices(counts, job.transforms.matrices, matrices + i * counts.num_matrix_floats());
    const shaders::SkinRecord record = RecordOf(batch, job, last);
    std::memcpy(records + i * sizeof(record), &record, sizeof(record));
    const VkDeviceSize position =
        batch.positions.offset / kPositionBytes + VkDeviceSize{i} * counts.num_solve_vertices;
    scratch().places.push_back(
        {job.instance, job.rig, static_cast<uint32_t>(position), job.transforms.origin});
  }
  BindBatch(batch, last, slot, set);
}

void VulkanSkinner::BindBatch(const SkinBatch& batch, const BufferRange& last, const Slot& slot,
                              VkDescriptorSet set) const {
  std::array<VkDescriptorBufferInfo, LIMBER_SKIN_NUM_BATCH_BINDINGS> buffers;
  const VkBuffer upload = slot.upload.handle();
  const Scratch& now = scratches_[num_frames_ % 2];
  buffers[LIMBER_SKIN_MATRICES] = {upload, batch.matrices.offset, batch.matrices.size};
  buffers[LIMBER_SKIN_RECORDS] = {upload, batch.records.offset, batch.records.size};
  buffers[LIMBER_SKIN_SOLVE_POSITIONS] = {now.buffer.handle(), batch.positions.offset,
                                          batch.positions.size};
  // What is not read or not wanted has to be bound as well: something that this batch owns.
  const VkDescriptorBufferInfo unused = buffers[LIMBER_SKIN_SOLVE_POSITIONS];
  buffers[LIMBER_SKIN_LAST_POSITIONS] =
      last.size == 0
          ? unused
          : VkDescriptorBufferInfo{last_scratch().buffer.handle(), last.offset, last.size};
  for (uint32_t stream = 0; stream < LIMBER_SKIN_NUM_STREAMS; ++stream) {
    const BufferRange& range = batch.stream_ranges[stream];
    buffers[LIMBER_SKIN_FIRST_STREAM + stream] =
        batch.stream_buffers[stream] == VK_NULL_HANDLE
            ? unused
            : VkDescriptorBufferInfo{batch.stream_buffers[stream], range.offset, range.size};
  }
  WriteStorageBuffers(api_, set, buffers);
}

// Rigs that are new, and the wait for the scratch's last readers.
void VulkanSkinner::RecordUploads(VkCommandBuffer commands, Slot* slot) {
  SkinConsumer before{VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT};
  for (const auto& rig : rigs_) {
    if (!rig->needs_upload()) continue;
    slot->old_buffers.push_back(rig->RecordUpload(commands));
    before.stage |= VK_PIPELINE_STAGE_TRANSFER_BIT;
    before.access |= VK_ACCESS_TRANSFER_WRITE_BIT;
  }
  RecordBarrier(commands, before, kCompute);
}

void VulkanSkinner::RecordPass(VkCommandBuffer commands, const Slot& slot, bool first_pass) const {
  VkPipeline bound = VK_NULL_HANDLE;
  for (size_t i = 0; i < batches_.batches().size(); ++i) {
    const SkinBatch& batch = batches_.batches()[i];
    const SkinRigCounts& counts = batch.rig->counts();
    const VkPipeline pipeline = first_pass ? batch.rig->positions() : pipelines_.vertices();
    if (pipeline != bound) {
      api_.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
      bound = pipeline;
    }
    const VkDescriptorSet sets[SkinPipelines::kNumSets] = {batch.rig->set(), (*slot.sets)[i]};
    api_.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_.layout(), 0,
                               SkinPipelines::kNumSets, sets, 0, nullptr);
    const shaders::SkinPush push{counts.num_solve_vertices, counts.num_draw_vertices,
                                 batch.rig->inverse_scale()};
    api_.CmdPushConstants(commands, pipelines_.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                          sizeof(push), &push);
    api_.CmdDispatch(
        commands, NumWorkGroups(first_pass ? counts.num_solve_vertices : counts.num_draw_vertices),
        batch.count, 1);
  }
}

void VulkanSkinner::RecordBarrier(VkCommandBuffer commands, const SkinConsumer& before,
                                  const SkinConsumer& after) const {
  auto barrier = VulkanInfo<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = before.access;
  barrier.dstAccessMask = after.access;
  api_.CmdPipelineBarrier(commands, before.stage, after.stage, 0, 1, &barrier, 0, nullptr, 0,
                          nullptr);
}

}  // namespace limber
