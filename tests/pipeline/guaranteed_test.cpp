// The guaranteed mode on a real character, beside the plain alternation.
#include "pipeline/accuracy_character.h"
#include "runtime/solve/guarded_pair.h"

namespace limber {
namespace {

TEST(Guaranteed, Horse_NeverIncreasesAndEndsNoHigher) {
  if (test::SharedDataFolder().empty()) {
    GTEST_SKIP() << "the shared test data is absent (set LIMBER_DATA_DIR to its folder)";
  }
  const test::TemporaryFolder folder;
  const auto horse =
      test::AccuracyCharacter::Make(test::PackHorse(folder, "horse_guaranteed"), 10, true);
  ASSERT_TRUE(horse.has_value());
  test::GuardedPair<3> pair(std::shared_ptr<const Rig>(&horse->rig(), [](const Rig*) {}));
  test::GuardedStudy study;
  std::mt19937 engine(7);
  for (const double reach : {0.0, 0.01, 0.05, 0.15}) {
    for (int shape = 0; shape < pair.model->num_shapes; ++shape) {
      pair.Pose(pair.TargetsNear(shape, reach, &engine));
      test::StudyPose(500, &pair, &study);
    }
  }
  study.Print("horse");
  EXPECT_EQ(study.increases, 0);
  EXPECT_EQ(study.higher, 0);
}

}  // namespace
}  // namespace limber
