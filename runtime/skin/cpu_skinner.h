// CPU skinning of a whole character: what the GPU path does, for tests, picking, export and
// machines without Vulkan.
#pragma once

#include "core/memory_source.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin/frame_layout.h"
#include "skin/skin_frames.h"
#include "skin/skin_layout.h"
#include "skin/skin_positions.h"
#include "skin/skin_topology.h"
#include "skin/skin_transforms.h"

#include <memory>
#include <span>

namespace limber {

// The deformed character: views into a CpuSkinner, valid until its next call. Mesh space.
// Draw vertices that share a solve vertex have bitwise equal positions; those of one normal group
// with equal rest normals have bitwise equal normals. Normals and tangents are finite whatever the
// transforms are; positions overflow where the transforms send them out of single precision.
struct DeformedMesh {
  std::span<const Vec3> solve_positions;  // [V]
  std::span<const Vec3> positions;        // [D] draw vertices
  std::span<const Vec3> normals;          // [D] unit
  std::span<const Tangent> tangents;      // [D], unit, orthogonal to the normal; where the mesh
                                          // has no tangents an arbitrary one
};

// Where one kind of the draw vertices' numbers goes: the first one's place, and bytes to the next.
// Any alignment; written in order, never read.
struct StridedOutput {
  void* data = nullptr;  // null: not wanted
  size_t stride = 0;
};

// A smallest and a largest corner.
struct Bounds {
  Vec3 min, max;
};

static_assert(sizeof(Bounds) == 6 * sizeof(float), "two corners, tightly packed");

struct SkinOutputs {
  StridedOutput positions, normals;  // Vec3
  StridedOutput tangents;            // Tangent
  Bounds* bounds = nullptr;          // of the positions; null: not wanted
};

// What all characters of a rig share: weights and shapes as skinning reads them, and the surface.
struct SkinSurface : NewFromSource {
  // Errors: kMalformed (CheckSkinMesh), kOutOfMemory.
  static Result<std::shared_ptr<const SkinSurface>> Create(const SkinMesh& mesh,
                                                           const RigSpace& space);

  SkinLayout layout;
  SkinTopology topology;
  FrameLayout frames;
};

// Skins one character at a time; one thread at a time. Calls allocate nothing.
class CpuSkinner : public NewFromSource {
 public:
  // Errors: kInvalidArgument (null), kOutOfMemory.
  static Result<CpuSkinner> Create(std::shared_ptr<const SkinSurface> surface);
  // With a surface of its own. Copies what it needs of `mesh`. Errors: kMalformed (CheckSkinMesh),
  // kOutOfMemory.
  static Result<CpuSkinner> Create(const SkinMesh& mesh, const RigSpace& space);
  // For SkinInto alone: without room for results.
  static Result<CpuSkinner> CreateWithoutResults(std::shared_ptr<const SkinSurface> surface);

  // Straight into the caller's memory. Errors: kInvalidArgument (wrong number of matrices).
  Status SkinInto(const SkinTransforms& transforms, const SkinOutputs& outputs);

  // Positions only. Errors as above; kInvalidArgument also where there is no room for results.
  Status SkinPositionsOnly(const SkinTransforms& transforms);
  // Positions, normals and tangents. Errors as above.
  Status Skin(const SkinTransforms& transforms);

  // The result of the last SkinPositionsOnly or Skin; normals and tangents that of the last Skin.
  DeformedMesh result() const;

  const SkinTopology& topology() const { return surface_->topology; }

 private:
  CpuSkinner() = default;
  std::span<Vec3> relative();
  void WriteFrames(Vec3 origin, const SkinOutputs& outputs);
  Status SkinResults(const SkinTransforms& transforms, bool with_frames);

  std::shared_ptr<const SkinSurface> surface_;
  SkinScratch scratch_;
  Vector<Vec3> relative_;  // [V + 1] without the origin: edges keep their digits
  FrameScratch frames_;
  bool has_results_ = false;
  Vector<Vec3> solve_positions_, positions_, normals_;
  Vector<Tangent> tangents_;
};

}  // namespace limber
