// Bake: RawCharacter + handles -> Rig tables and skinning mesh (what the runtime needs).
// Stages: weld, connect, weights, reach, edge groups, reduce. Deterministic: same input, same
// bytes.
#pragma once

#include "core/status.h"
#include "import/raw_character.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace limber::bake {

struct BakeOptions {
  int num_groups = 0;     // G; 0: twice the number of handles (eq. 7, section 5.2)
  bool rotations = true;  // false: for the formulation without rotations only (smaller file)
  int num_threads = 0;    // 0: one per core
};

// Told before each stage and now and then within one; fraction runs from 0 to 1 over the bake.
// Returning false cancels: Bake then ends with kInvalidArgument "cancelled".
using ProgressCallback = std::function<bool(const char* stage, double fraction)>;

struct BakeTiming {
  std::string stage;
  double seconds = 0;
};

struct BakedCharacter {
  RigTables tables;
  SkinMesh mesh;
  std::vector<BakeTiming> timings;
  std::vector<std::string> warnings;
};

Result<BakedCharacter> Bake(const RawCharacter& raw, std::span<const HandleSpec> handles,
                            const BakeOptions& options, const ProgressCallback& progress);

}  // namespace limber::bake
