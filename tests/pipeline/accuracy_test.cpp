// How exactly examples come back on the real characters of the shared data, and drags of them
// without a crack, a spike or a number that is not one. Each case is one bake.
#include "core/vector.h"
#include "pipeline/accuracy_character.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace limber {
namespace {

using test::AccuracyCharacter;
using test::Points;

// The folder, or an empty path after saying why the test is skipped.
std::filesystem::path DataFolder() {
  return test::SharedDataFolder();
}

#define LIMBER_REQUIRE_DATA()                                                             \
  if (DataFolder().empty()) {                                                             \
    GTEST_SKIP() << "the shared test data is absent (set LIMBER_DATA_DIR to its folder)"; \
  }

// Drags from rest to each goal in 20 steps, lets it settle, and compares.
void ExpectShapesComeBack(AccuracyCharacter* character, double most_percent) {
  for (int s = 0; s < character->rig().num_shapes(); ++s) {
    character->state().ResetToRest();
    const Points goal = character->Shape(s);
    character->DragTo(goal, 20);
    const PoseReport report = character->Settle(400);
    const double rms = character->RmsPercent(goal);
    std::printf("%s: shape %s: RMS %.4f %% of the diagonal after %d more alternations\n",
                character->rig().name().c_str(),
                character->rig().tables().shape_names[static_cast<size_t>(s)].c_str(), rms,
                report.iterations);
    EXPECT_LE(rms, most_percent);
  }
}

TEST(Accuracy, Horse_EachPoseComesBackFromItsHandles) {
  LIMBER_REQUIRE_DATA();
  const test::TemporaryFolder folder;
  auto horse = AccuracyCharacter::Make(test::PackHorse(folder, "horse"), 10, true);
  ASSERT_TRUE(horse.has_value());
  EXPECT_EQ(horse->rig().num_shapes(), 5);
  ExpectShapesComeBack(&*horse, 0.2);
}

// The legs of one pose with everything else of another: a smooth step at the waist, where both
// poses hardly move; the hands hang lower than that and belong to the arms.
Points LegsOf(const Points& legs, const Points& rest_of_it, const Points& at_rest) {
  Points mixed = rest_of_it;
  for (size_t v = 0; v < mixed.size(); ++v) {
    if (std::abs(at_rest[v].x()) > 2.9) continue;
    const double t = std::clamp((at_rest[v].y() - 0.5) / 2.5, 0.0, 1.0);
    const double upper = t * t * (3 - 2 * t);
    mixed[v] = upper * rest_of_it[v] + (1 - upper) * legs[v];
  }
  return mixed;
}

TEST(Accuracy, Human_RaisesItsArmsAndKicksAtOnce) {
  LIMBER_REQUIRE_DATA();
  auto human = AccuracyCharacter::Make(DataFolder() / "characters/makehuman_poses.glb", 14, true);
  ASSERT_TRUE(human.has_value());
  EXPECT_EQ(human->rig().num_shapes(), 13);
  const Points goal = LegsOf(human->Shape(human->FindShape("kick")),
                             human->Shape(human->FindShape("arms-up")), human->Shape(0));
  human->DragTo(goal, 40, [&human] { human->ExpectSound(2.5, 0.1); });
  human->KeepFrames();
  human->Settle(400);
  const double rms = human->RmsPercent(goal);
  std::printf("human: arms up and kick: RMS %.4f %% of the diagonal\n", rms);
  EXPECT_LE(rms, 0.8);
  human->state().ResetToRest();
  ExpectShapesComeBack(&*human, 0.5);
}

// Through several examples' handle positions one after the other, and a little beyond.
void PlayThroughExamples(AccuracyCharacter* character, const Vector<int>& shapes, double longest,
                         double jump) {
  for (int s : shapes) {
    Points goal = character->Shape(s);
    const Points rest = character->Shape(0);
    for (size_t v = 0; v < goal.size(); ++v)
      goal[v] += 0.1 * (goal[v] - rest[v]);
    character->DragTo(goal, 25, [&] { character->ExpectSound(longest, jump); });
  }
  character->KeepFrames();
}

TEST(Accuracy, Lion_PlaysThroughItsPoses) {
  LIMBER_REQUIRE_DATA();
  auto lion = AccuracyCharacter::Make(DataFolder() / "characters/lion-poses.glb", 10, true);
  ASSERT_TRUE(lion.has_value());
  PlayThroughExamples(&*lion, {1, 2, 3, 4, 5, 6, 7, 8, 9, 0}, 3, 0.2);
}

TEST(Accuracy, Face_PlaysThroughItsExpressionsWithoutRotations) {
  LIMBER_REQUIRE_DATA();
  auto face =
      AccuracyCharacter::Make(DataFolder() / "characters/ict_facekit_expressions.glb", 8, false);
  ASSERT_TRUE(face.has_value());
  EXPECT_EQ(face->rig().num_shapes(), 58);
  // Eight handles cannot tell 57 expressions apart: where two serve equally well the convex problem
  // has no unique answer, and the face may pass from one to the other within a frame (2.8 % seen).
  PlayThroughExamples(&*face, {20, 24, 10, 30, 45, 0}, 2.5, 0.05);
  face->state().ResetToRest();
  face->Settle(20);
  EXPECT_LT(face->RmsPercent(face->Shape(0)), 0.01);
}

}  // namespace
}  // namespace limber
