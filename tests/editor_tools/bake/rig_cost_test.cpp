// What a rig is said to cost, against what it costs.
#include "bake/rig_cost.h"

#include "bake/bake.h"
#include "bake/pack_tables.h"
#include "core/vector.h"
#include "rig/rig_fields.h"
#include "solve/pose_model.h"
#include "solve/pose_workspaces.h"
#include "support/counting_allocator.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

namespace limber::bake {
namespace {

BakedCharacter Baked(const RawCharacter& raw, const BakeOptions& options) {
  auto baked = Bake(raw, raw.marked_handles, options, {});
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  return std::move(baked).value();
}

size_t TableBytes(const RigTables& tables) {
  size_t floats = 0;
  VisitRigTables(tables, [&floats](const char*, const Vector<float>& table, const auto&) {
    floats += table.size();
  });
  return floats * sizeof(float);
}

TEST(RigCost, AfterABake_SaysWhatItHolds) {
  for (const bool rotations : {true, false}) {
    for (const RawCharacter& raw : {test::MakeBendCylinder(12, 16), test::MakeStretchSquare(9)}) {
      BakeOptions options;
      options.rotations = rotations;
      BakedCharacter baked = Baked(raw, options);
      const size_t vertices = baked.mesh.num_draw_vertices;
      const auto packed = PackRigTables(baked.tables, baked.local_factors);
      ASSERT_TRUE(packed.ok()) << packed.status().message();
      EXPECT_EQ(baked.cost.file_bytes, NumBytes(*packed) + vertices * (4 + 2) * 4);
      EXPECT_EQ(baked.cost.mesh_bytes,
                baked.mesh.weights.size() * 4 + baked.mesh.shape_positions.size() * 12);

      const size_t table_bytes = TableBytes(baked.tables);
      auto rig = Rig::Create(raw.name, std::move(baked.tables), std::move(baked.mesh));
      ASSERT_TRUE(rig.ok()) << rig.status().message();
      const auto model = PoseModel::Create(*rig);
      ASSERT_TRUE(model.ok());
      // Padding to registers and the small tables are left out of the estimate.
      const double held = static_cast<double>((*model)->bytes() + table_bytes);
      EXPECT_GT(static_cast<double>(baked.cost.model_bytes), 0.5 * held);
      EXPECT_LT(static_cast<double>(baked.cost.model_bytes), 1.2 * held);

      const auto workspaces = std::make_shared<PoseWorkspaces>(*model, PoseRoom());
      const PoseState first = PoseState::Create(workspaces).value();
      const int64_t before = test::AllocatedBytes();
      const PoseState state = PoseState::Create(workspaces).value();
      const auto kept = static_cast<double>(test::AllocatedBytes() - before);
      EXPECT_GT(static_cast<double>(baked.cost.character_bytes), 0.6 * kept);
      EXPECT_LT(static_cast<double>(baked.cost.character_bytes), 1.1 * kept);
    }
  }
}

TEST(RigCost, BeforeABake_IsAnUpperBound) {
  const RawCharacter raw = test::MakeBendCylinder(12, 16);
  const BakedCharacter baked = Baked(raw, {});
  RigSize size = SizeOf(baked.tables, baked.mesh.num_solve_vertices, baked.mesh.num_draw_vertices);
  const RigCost before = EstimateCost(size);
  EXPECT_GE(before.file_bytes, baked.cost.file_bytes);
  EXPECT_GE(before.model_bytes, baked.cost.model_bytes);
  EXPECT_EQ(before.mesh_bytes, baked.cost.mesh_bytes);
  EXPECT_EQ(before.alternation_seconds, baked.cost.alternation_seconds);
}

TEST(RigCost, MoreOfAnything_CostsMore) {
  const RigSize size = {3, 8, 4, 16, true, 5000, 5000};
  const RigCost cost = EstimateCost(size);
  for (int RigSize::*number : {&RigSize::num_handles, &RigSize::num_shapes, &RigSize::num_groups}) {
    RigSize larger = size;
    larger.*number *= 2;
    const RigCost more = EstimateCost(larger);
    EXPECT_GT(more.file_bytes, cost.file_bytes);
    EXPECT_GT(more.model_bytes, cost.model_bytes);
    EXPECT_GT(more.character_bytes, cost.character_bytes);
    EXPECT_GT(more.alternation_seconds, cost.alternation_seconds);
  }
}

TEST(CheckRigSize, RefusesExactlyWhatTheSolverRefuses_AndSaysWhatFits) {
  RigSize size = {3, 30, 40, 100, true, 1000, 1000};
  EXPECT_TRUE(CheckRigSize(size).ok());  // 12,000 columns
  size.num_groups = 101;
  const Status refused = CheckRigSize(size);
  EXPECT_EQ(refused.code(), StatusCode::kLimitExceeded);
  EXPECT_NE(refused.message().find("--groups 100 or fewer, or --no-rotations"), std::string::npos)
      << refused.message();
  size.rotations = false;
  EXPECT_TRUE(CheckRigSize(size).ok());
  size.num_shapes = 12001;
  EXPECT_NE(CheckRigSize(size).message().find("too many even with one edge group"),
            std::string::npos);
}

// Refused before any work: no stage but the weld was begun.
TEST(BakeErrors, BeginWithTheFileOnce) {
  RawCharacter raw = test::MakeStretchSquare(5);
  raw.file = "somewhere/square.glb";
  const std::string message = Bake(raw, {}, {}, {}).status().message();
  EXPECT_EQ(message.rfind("somewhere/square.glb: handles: ", 0), 0u) << message;
  EXPECT_EQ(message.find("square.glb", 20), std::string::npos) << message;
}

TEST(CheckRigSize, InABake_RefusesEarly) {
  const RawCharacter raw = test::MakeStretchSquare(9);
  BakeOptions options;
  options.num_groups = 4000;
  std::string stages;
  const auto baked = Bake(raw, raw.marked_handles, options, [&stages](const char* stage, double) {
    stages += stage;
    return true;
  });
  EXPECT_EQ(baked.status().code(), StatusCode::kLimitExceeded);
  EXPECT_EQ(stages, "weld");
  EXPECT_EQ(baked.status().message().rfind(raw.file + ": rig: ", 0), 0u)
      << baked.status().message();
}

}  // namespace
}  // namespace limber::bake
