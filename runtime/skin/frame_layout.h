// Normals and tangents of all groups and draw vertices by wide arithmetic: the bits of
// ComputeSurfaceFrame and ApplyFrame (skin_frames.h), many at a time.
#pragma once

#include "core/aligned_vector.h"
#include "core/vector.h"
#include "skin/kernels/skin_kernels.h"
#include "skin/skin_frames.h"
#include "skin/skin_topology.h"

#include <cstdint>
#include <span>

namespace limber {

// The corners of a topology, regrouped: groups in blocks of kSkinLanes, sorted by how many corners
// they have, so that few are filled up to those of their block (with corners that add zero).
// Immutable.
class FrameLayout {
 public:
  FrameLayout() = default;
  explicit FrameLayout(const SkinTopology& topology);

  // What the kernels read; views into the layout.
  FrameBlocks blocks() const;

 private:
  void AddBlock(const SkinTopology& topology, std::span<const uint32_t> groups);

  uint32_t num_groups_ = 0;
  float inverse_scale_ = 1;
  Vector<uint32_t> order_, centres_, first_corner_;  // as in FrameBlocks
  AlignedVector<uint32_t> others_;
  AlignedVector<float> coefficients_;
};

// Room of a frame's computation.
struct FrameScratch {
  AlignedVector<SurfaceFrame> frames;  // [G + 1]
  Vector<uint32_t> unusual;            // [G]

  void Resize(uint32_t num_groups);
};

// scratch->frames: those of all groups; it has been resized for them before. positions: [V] and one
// more, which means nothing.
void ComputeSurfaceFrames(const SkinKernels& kernels, const FrameLayout& layout,
                          const SkinTopology& topology, std::span<const Vec3> positions,
                          FrameScratch* scratch);

// Normals and tangents of `vertices`, at most kSkinLanes, with those frames.
void ApplyFrames(const SkinKernels& kernels, std::span<const SurfaceFrame> frames,
                 std::span<const SkinDrawVertex> vertices, Vec3* normals, Tangent* tangents);

}  // namespace limber
