#include "skin/frame_layout.h"

#include "core/vector.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace limber {
namespace {

static_assert(sizeof(SurfaceFrame) == kFrameFloats * sizeof(float) &&
                  offsetof(SurfaceFrame, t) == sizeof(float) &&
                  offsetof(SurfaceFrame, second) == 13 * sizeof(float),
              "as kernels write and read them");
static_assert(sizeof(SkinDrawVertex) == kDrawVertexFloats * sizeof(float) &&
                  offsetof(SkinDrawVertex, tangent) == 4 * sizeof(float),
              "as kernels read them");

uint32_t NumCorners(const SkinTopology& topology, uint32_t group) {
  return topology.group_corners[group + 1] - topology.group_corners[group];
}

}  // namespace

FrameLayout::FrameLayout(const SkinTopology& topology)
    : num_groups_(topology.num_groups()),
      inverse_scale_(topology.inverse_scale) {
  Vector<uint32_t> sorted(num_groups_);
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) {
    return NumCorners(topology, a) == NumCorners(topology, b)
               ? a < b
               : NumCorners(topology, a) < NumCorners(topology, b);
  });
  first_corner_.push_back(0);
  const std::span<const uint32_t> groups = sorted;
  for (size_t begin = 0; begin < groups.size(); begin += kSkinLanes)
    AddBlock(topology, groups.subspan(begin, std::min<size_t>(kSkinLanes, groups.size() - begin)));
  others_.shrink_to_fit();
  coefficients_.shrink_to_fit();
}

void FrameLayout::AddBlock(const SkinTopology& topology, std::span<const uint32_t> groups) {
  const uint32_t most = NumCorners(topology, groups.back());  // the last one has most of them
  const uint32_t first = first_corner_.back();
  first_corner_.push_back(first + most);
  others_.resize(size_t{first + most} * 2 * kSkinLanes);
  coefficients_.resize(size_t{first + most} * 4 * kSkinLanes);
  for (size_t lane = 0; lane < kSkinLanes; ++lane) {
    const bool is_there = lane < groups.size();
    const uint32_t group = is_there ? groups[lane] : num_groups_;
    const uint32_t centre = is_there ? 3 * topology.group_solve_vertex[group] : 0;
    order_.push_back(group);
    centres_.push_back(centre);
    for (uint32_t c = 0; c < most; ++c) {
      SkinCorner corner;
      corner.a = corner.b = centre / 3;
      if (is_there && c < NumCorners(topology, group))
        corner = topology.corners[topology.group_corners[group] + c];
      uint32_t* others = &others_[size_t{first + c} * 2 * kSkinLanes + lane];
      others[0] = 3 * corner.a;
      others[kSkinLanes] = 3 * corner.b;
      float* coefficients = &coefficients_[size_t{first + c} * 4 * kSkinLanes + lane];
      coefficients[0] = corner.first[0];
      coefficients[kSkinLanes] = corner.first[1];
      coefficients[size_t{2} * kSkinLanes] = corner.second[0];
      coefficients[size_t{3} * kSkinLanes] = corner.second[1];
    }
  }
}

FrameBlocks FrameLayout::blocks() const {
  FrameBlocks blocks;
  blocks.num_groups = num_groups_;
  blocks.inverse_scale = inverse_scale_;
  blocks.order = order_.data();
  blocks.centres = centres_.data();
  blocks.first_corner = first_corner_.data();
  blocks.others = others_.data();
  blocks.coefficients = coefficients_.data();
  return blocks;
}

void FrameScratch::Resize(uint32_t num_groups) {
  frames.resize(size_t{num_groups} + 1);
  unusual.resize(num_groups);
}

void ComputeSurfaceFrames(const SkinKernels& kernels, const FrameLayout& layout,
                          const SkinTopology& topology, std::span<const Vec3> positions,
                          FrameScratch* scratch) {
  const size_t num_unusual = kernels.compute_frames(
      layout.blocks(), reinterpret_cast<const float*>(positions.data()),
      reinterpret_cast<float*>(scratch->frames.data()), scratch->unusual.data());
  for (size_t i = 0; i < num_unusual; ++i) {
    const uint32_t group = scratch->unusual[i];
    scratch->frames[group] = ComputeSurfaceFrame(topology, group, positions);
  }
}

void ApplyFrames(const SkinKernels& kernels, std::span<const SurfaceFrame> frames,
                 std::span<const SkinDrawVertex> vertices, Vec3* normals, Tangent* tangents) {
  AppliedFrames applied;
  uint32_t groups[kSkinLanes];
  const SkinDrawVertex* from = vertices.data();
  SkinDrawVertex filled[kSkinLanes];
  if (vertices.size() < kSkinLanes) {
    std::copy(vertices.begin(), vertices.end(), filled);
    from = filled;
  }
  for (size_t lane = 0; lane < kSkinLanes; ++lane)
    groups[lane] = from[lane].normal_group;
  kernels.apply_frames(reinterpret_cast<const float*>(frames.data()),
                       reinterpret_cast<const float*>(from), groups, &applied);
  const auto& numbers = applied.numbers;
  for (size_t lane = 0; lane < vertices.size(); ++lane) {
    if (applied.usual[lane] == 0) {
      ApplyFrame(frames[groups[lane]], from[lane], &normals[lane], &tangents[lane]);
      continue;
    }
    normals[lane] = {numbers[0][lane], numbers[1][lane], numbers[2][lane]};
    tangents[lane] = {{numbers[3][lane], numbers[4][lane], numbers[5][lane]},
                      from[lane].handedness};
  }
}

}  // namespace limber
