#include "skin_vulkan/vulkan_skin_batches.h"

#include "shared/skin_layout.h"

#include <algorithm>
#include <functional>
#include <tuple>

namespace limber {
namespace {

constexpr uint32_t kNumStreams = LIMBER_SKIN_NUM_STREAMS;
constexpr const char* kStreamNames[kNumStreams] = {"positions", "normals", "tangents",
                                                   "last positions"};
constexpr uint32_t kStreamBytes[kNumStreams] = {12, 12, 16, 12};

// The bytes that a stream touches, from its first float to behind its last.
BufferRange Touched(const VulkanSkinJob& job, uint32_t stream) {
  const VertexStream& s = StreamOf(job, stream);
  const VkDeviceSize last = job.rig->counts().num_draw_vertices - 1;
  return {s.offset, last * s.stride + kStreamBytes[stream]};
}

// Handles are pointers or numbers, as the machine is.
std::array<uint64_t, kNumStreams> BuffersOf(const VulkanSkinJob& job) {
  std::array<uint64_t, kNumStreams> buffers{};
  for (uint32_t stream = 0; stream < kNumStreams; ++stream)
    buffers[stream] = VulkanObject(StreamOf(job, stream).buffer);
  return buffers;
}

bool Before(const VulkanSkinJob& a, const VulkanSkinJob& b) {
  const auto a_buffers = BuffersOf(a), b_buffers = BuffersOf(b);
  if (a_buffers != b_buffers) return a_buffers < b_buffers;
  for (uint32_t stream = 0; stream < kNumStreams; ++stream) {
    const VkDeviceSize a_offset = StreamOf(a, stream).offset, b_offset = StreamOf(b, stream).offset;
    if (a_offset != b_offset) return a_offset < b_offset;
  }
  return a.instance < b.instance;
}

}  // namespace

const VertexStream& StreamOf(const VulkanSkinJob& job, uint32_t stream) {
  const VertexStream* streams[kNumStreams] = {&job.positions, &job.normals, &job.tangents,
                                              &job.last_positions};
  return *streams[stream];
}

Status SkinBatches::CheckStream(const VulkanSkinJob& job, size_t number, uint32_t stream) const {
  const VertexStream& s = StreamOf(job, stream);
  if (s.buffer == VK_NULL_HANDLE) return {};
  if (s.stride < kStreamBytes[stream] || s.stride % 4 != 0 || s.offset % 4 != 0) {
    return Error(StatusCode::kInvalidArgument,
                 "job %zu: %s: stride %u, offset %llu; multiples of 4 are needed, and a stride of "
                 "%u or more",
                 number, kStreamNames[stream], s.stride, static_cast<unsigned long long>(s.offset),
                 kStreamBytes[stream]);
  }
  const VkDeviceSize bytes =
      Touched(job, stream).size + api_.limits.minStorageBufferOffsetAlignment;
  if (bytes <= api_.limits.maxStorageBufferRange) return {};
  return Error(StatusCode::kLimitExceeded,
               "job %zu: %s: a stride of %u bytes makes %llu in all, the device writes at most %u "
               "at once",
               number, kStreamNames[stream], s.stride, static_cast<unsigned long long>(bytes),
               api_.limits.maxStorageBufferRange);
}

Status SkinBatches::Check(std::span<const VulkanSkinJob> jobs) const {
  for (size_t i = 0; i < jobs.size(); ++i) {
    const VulkanSkinJob& job = jobs[i];
    if (job.rig == nullptr) return Error(StatusCode::kInvalidArgument, "job %zu: no rig", i);
    if (job.transforms.matrices.size() != job.rig->counts().num_matrix_floats()) {
      return Error(StatusCode::kInvalidArgument,
                   "job %zu: transforms of %zu floats, expected %zu (handles x shapes x 12)", i,
                   job.transforms.matrices.size(), job.rig->counts().num_matrix_floats());
    }
    for (uint32_t stream = 0; stream < kNumStreams; ++stream)
      LIMBER_RETURN_IF_ERROR(CheckStream(job, i, stream));
  }
  return {};
}

SkinBatch SkinBatches::Begin(const VulkanSkinJob& job, uint32_t first) const {
  SkinBatch batch;
  batch.rig = job.rig;
  batch.first = first;
  batch.count = 1;
  for (uint32_t stream = 0; stream < kNumStreams; ++stream) {
    if (StreamOf(job, stream).buffer == VK_NULL_HANDLE) continue;
    batch.stream_buffers[stream] = StreamOf(job, stream).buffer;
    const BufferRange touched = Touched(job, stream);
    const VkDeviceSize begin = touched.offset / api_.limits.minStorageBufferOffsetAlignment *
                               api_.limits.minStorageBufferOffsetAlignment;
    batch.stream_ranges[stream] = {begin, touched.offset + touched.size - begin};
  }
  return batch;
}

bool SkinBatches::Extend(const VulkanSkinJob& job, SkinBatch* batch) const {
  const SkinRigCounts& counts = job.rig->counts();
  const VkDeviceSize most = api_.limits.maxStorageBufferRange, number = batch->count + 1;
  if (!many_ || job.rig != batch->rig || batch->count >= api_.limits.maxComputeWorkGroupCount[1] ||
      number * counts.num_rows() * 16 > most || number * counts.num_solve_vertices * 16 > most) {
    return false;
  }
  SkinBatch wider = *batch;
  for (uint32_t stream = 0; stream < kNumStreams; ++stream) {
    if (StreamOf(job, stream).buffer != batch->stream_buffers[stream]) return false;
    if (batch->stream_buffers[stream] == VK_NULL_HANDLE) continue;
    const BufferRange touched = Touched(job, stream);
    BufferRange& range = wider.stream_ranges[stream];
    if (touched.offset < range.offset) return false;
    range.size = std::max(range.size, touched.offset + touched.size - range.offset);
    if (range.size > most) return false;
  }
  ++wider.count;
  *batch = wider;
  return true;
}

// Ranges that are bound begin where the device allows it.
void SkinBatches::LayOut() {
  const VkDeviceSize alignment =
      std::max<VkDeviceSize>(16, api_.limits.minStorageBufferOffsetAlignment);
  BufferPlan upload(alignment), scratch(alignment);
  for (SkinBatch& batch : batches_) {
    const SkinRigCounts& counts = batch.rig->counts();
    const VkDeviceSize count = batch.count;
    batch.matrices = upload.Add(count * counts.num_rows() * 16);
    batch.records = upload.Add(count * sizeof(shaders::SkinRecord));
    batch.positions = scratch.Add(count * counts.num_solve_vertices * 16);
  }
  upload_bytes_ = upload.size();
  scratch_bytes_ = scratch.size();
}

Status SkinBatches::Plan(std::span<const VulkanSkinJob> jobs) {
  batches_.clear();
  order_.clear();
  LIMBER_RETURN_IF_ERROR(Check(jobs));
  for (uint32_t i = 0; i < jobs.size(); ++i)
    order_.push_back(i);
  std::sort(order_.begin(), order_.end(),
            [&](uint32_t a, uint32_t b) { return Before(jobs[a], jobs[b]); });
  for (uint32_t i = 0; i < order_.size(); ++i) {
    const VulkanSkinJob& job = jobs[order_[i]];
    if (batches_.empty() || !Extend(job, &batches_.back())) batches_.push_back(Begin(job, i));
  }
  LayOut();
  return {};
}

}  // namespace limber
