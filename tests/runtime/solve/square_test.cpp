// The paper's figure 1 and 8: a square with three example shapes dragged by its right handle.
#include <gtest/gtest.h>

#include "bake/bake.h"
#include "solve/pose_solver.h"
#include "support/test_meshes.h"

namespace limber {
namespace {

std::shared_ptr<const Rig> BakeSquare() {
  bake::RawCharacter raw = test::MakeStretchSquare(20);
  Result<bake::BakedCharacter> baked = bake::Bake(raw, raw.marked_handles, {}, {});
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  if (!baked.ok()) return nullptr;
  Result<std::shared_ptr<const Rig>> rig =
      Rig::Create("square", std::move(baked->tables), std::move(baked->mesh));
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? *rig : nullptr;
}

TEST(Square, Drag) {
  std::shared_ptr<const Rig> rig = BakeSquare();
  ASSERT_NE(rig, nullptr);
  printf("k %d G %d r %d rank %d r1 %d\n", rig->dimension(), rig->num_groups(),
         rig->tables().num_modes, rig->tables().residual_rank, rig->tables().num_single_modes);
  Result<PoseState> state = PoseState::Create(rig);
  ASSERT_TRUE(state.ok());
  for (float x : {0.8f, 1.0f, 1.2f, 1.4f, 1.6f, 1.8f, 2.0f, 2.4f, 2.8f}) {
    ASSERT_TRUE(state->SetTarget(rig->FindHandle("right"), {x, 0, 0}).ok());
    PoseOptions options;
    options.iterations = 50;
    options.settle_tolerance = 1e-9;
    PoseReport report;
    ASSERT_TRUE(state->Solve(options, &report).ok());
    double mean[3] = {0, 0, 0};
    for (int g = 0; g < rig->num_groups(); ++g)
      for (int s = 0; s < 3; ++s) mean[s] += state->blend_weights()[g * 3 + s] / rig->num_groups();
    printf("x %.2f B %.4f %.4f %.4f energy %.3e elastic %.3e it %d change %.2e opt %.1e\n", x,
           mean[0], mean[1], mean[2], report.energy, report.elastic, report.iterations,
           report.change, report.optimality);
  }
}

}  // namespace
}  // namespace limber
