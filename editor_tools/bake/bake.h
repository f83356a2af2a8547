// Bake: RawCharacter + handles -> Rig tables and skinning mesh (what the runtime needs).
// Stages: weld, connect, weights, reach, edge groups, reduce. Deterministic: same input, same
// bytes.
#pragma once

#include "bake/influences.h"
#include "bake/progress.h"
#include "bake/rig_cost.h"
#include "bake/skinning_weights.h"
#include "core/status.h"
#include "core/vector.h"
#include "import/raw_character.h"
#include "rig/local_group_factors.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"

#include <span>
#include <string>

namespace limber::bake {

inline constexpr int kGroupsPerHandle = 2;

enum class WeightKind {
  kBiharmonic,  // skinning_weights.h
  kHeat,        // heat_weights.h: a preview
};

struct BakeOptions {
  int num_groups = 0;  // G; 0: kGroupsPerHandle times the handles (eq. 7, section 5.2)
  WeightKind weights = WeightKind::kBiharmonic;  // where none are painted
  int influences = 0;     // most handles that a vertex follows; 0: all (influences.h)
  bool rotations = true;  // false: for the formulation without rotations only (smaller file)
  int num_threads = 0;    // 0: one per core
};

struct BakeTiming {
  std::string stage;
  double seconds = 0;
};

struct BakedCharacter {
  RigTables tables;
  LocalGroupFactors local_factors;  // two of the tables as the file has them; may be empty
  SkinMesh mesh;
  Vector<double> handle_stiffness;  // [H], for the handles' nodes
  Vector<int> vertex_groups;        // [V] edge group of each solve vertex, for tools
  WeightsReport weights;
  InfluenceReport influences;
  RigCost cost;
  Vector<BakeTiming> timings;
  Vector<std::string> warnings;
};

Result<BakedCharacter> Bake(const RawCharacter& raw, std::span<const HandleSpec> handles,
                            const BakeOptions& options, const ProgressCallback& progress);

}  // namespace limber::bake
