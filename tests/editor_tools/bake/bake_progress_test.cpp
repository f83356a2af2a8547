// Progress that only rises, and a stop that is heard wherever it comes.
#include "bake/bake.h"
#include "core/vector.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

namespace limber::bake {
namespace {

struct Told {
  std::string stage;
  double fraction = 0;
};

Vector<Told> RunAndListen(const RawCharacter& raw) {
  Vector<Told> told;
  const auto caller = std::this_thread::get_id();
  const auto baked = Bake(raw, raw.marked_handles, {}, [&](const char* stage, double fraction) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    told.push_back({stage, fraction});
    return true;
  });
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  return told;
}

TEST(BakeProgress, RisesFromZeroThroughEveryStage) {
  const Vector<Told> told = RunAndListen(test::MakeBendCylinder(24, 40));
  ASSERT_GE(told.size(), 6u);
  EXPECT_EQ(told.front().fraction, 0);
  Vector<std::string> stages;
  for (size_t i = 0; i < told.size(); ++i) {
    EXPECT_LE(told[i].fraction, 1);
    EXPECT_GE(told[i].fraction, told[i == 0 ? 0 : i - 1].fraction) << told[i].stage;
    if (stages.empty() || stages.back() != told[i].stage) stages.push_back(told[i].stage);
  }
  const Vector<std::string> expected = {"weld", "weights", "reach", "edge groups", "tensors"};
  EXPECT_EQ(stages, expected);
}

TEST(BakeProgress, AStopAtAnyCall_EndsTheBake) {
  const RawCharacter raw = test::MakeBendCylinder(12, 20);
  const auto num_calls = RunAndListen(raw).size();
  for (size_t stop = 0; stop < num_calls; ++stop) {
    size_t calls = 0;
    const auto baked =
        Bake(raw, raw.marked_handles, {}, [&](const char*, double) { return calls++ < stop; });
    // How often the weights tell depends on the clock: a run with fewer calls may get to its end.
    if (calls <= stop) continue;
    ASSERT_FALSE(baked.ok()) << "stopped at call " << stop;
    EXPECT_NE(baked.status().message().find("cancelled"), std::string::npos);
    EXPECT_EQ(calls, stop + 1) << "asked again after the answer was no";
  }
}

}  // namespace
}  // namespace limber::bake
