// Even motion of the targets gives even motion of a real character, and rest gives rest.
#include "core/vector.h"
#include "pipeline/accuracy_character.h"

#include <algorithm>
#include <cstdio>

namespace limber {
namespace {

using test::AccuracyCharacter;
using test::Points;

constexpr int kSteps = 250;

// A switch of examples between two frames moves the mesh by tens of median steps; parts that swing
// faster than the handles do (a tail, a hoof) by two or so.
constexpr double kMostOverMedian = 3;
constexpr double kAtRest = 1e-5;  // diagonals a frame: a hundredth of a pixel
constexpr int kMostFramesToRest = 3000;

#define LIMBER_REQUIRE_DATA()                                                             \
  if (test::SharedDataFolder().empty()) {                                                 \
    GTEST_SKIP() << "the shared test data is absent (set LIMBER_DATA_DIR to its folder)"; \
  }

// Largest motion of a vertex since the last call, in diagonals.
class Motion {
 public:
  explicit Motion(const AccuracyCharacter& character)
      : character_(character),
        last_(character.Deformed()) {}

  double Next() {
    Points now = character_.Deformed();
    double largest = 0;
    for (size_t v = 0; v < now.size(); ++v)
      largest = std::max(largest, (now[v] - last_[v]).norm());
    last_ = std::move(now);
    return largest / static_cast<double>(character_.rig().diagonal());
  }

 private:
  const AccuracyCharacter& character_;
  Points last_;
};

// Drags from where the character is to `shape` and leaves it there until it rests.
void ExpectSmoothDrag(AccuracyCharacter* character, int shape) {
  const String& name = character->rig().tables().shape_names[static_cast<size_t>(shape)];
  Motion motion(*character);
  Vector<double> motions;
  character->DragTo(character->Shape(shape), kSteps, [&] { motions.push_back(motion.Next()); });
  const auto worst = std::max_element(motions.begin(), motions.end());
  const auto worst_frame = static_cast<int>(worst - motions.begin()) + 1;
  const double largest = *worst;
  std::nth_element(motions.begin(), motions.begin() + kSteps / 2, motions.end());
  const double median = motions[kSteps / 2];
  int frames = 0;
  double rest = 1;
  for (; frames < kMostFramesToRest && rest > kAtRest; ++frames) {
    ASSERT_TRUE(character->state().Solve(character->options(), nullptr).ok());
    rest = motion.Next();
  }
  std::printf(
      "%s: to %s: largest motion %.5f of the diagonal (frame %d), median %.5f, ratio %.2f; "
      "at rest after %d frames\n",
      character->rig().name().c_str(), name.c_str(), largest, worst_frame, median, largest / median,
      frames);
  EXPECT_LE(largest, kMostOverMedian * median) << name << ", frame " << worst_frame;
  EXPECT_LE(rest, kAtRest) << name;
}

TEST(Smoothness, Horse_MovesEvenlyThroughItsPosesAndRests) {
  LIMBER_REQUIRE_DATA();
  const test::TemporaryFolder folder;
  auto horse = AccuracyCharacter::Make(test::PackHorse(folder, "horse_smooth"), 10, true);
  ASSERT_TRUE(horse.has_value());
  for (int shape : {1, 2, 3, 4, 0})
    ExpectSmoothDrag(&*horse, shape);
}

TEST(Smoothness, Human_MovesEvenlyThroughItsPosesAndRests) {
  LIMBER_REQUIRE_DATA();
  const test::TemporaryFolder folder;
  // A name of its own: the baked file is called after it, and other programs bake this character.
  const std::filesystem::path source = folder.path() / "human_smooth.glb";
  std::filesystem::copy_file(test::SharedDataFolder() / "characters/makehuman_poses.glb", source);
  auto human = AccuracyCharacter::Make(source, 14, true);
  ASSERT_TRUE(human.has_value());
  for (const char* name : {"arms-up", "kick"})
    ExpectSmoothDrag(&*human, human->FindShape(name));
}

}  // namespace
}  // namespace limber
