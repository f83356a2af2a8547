// The guaranteed mode's guarantees, and that there is a reason for it.
#include "solve/trust_region.h"

#include "runtime/solve/guarded_pair.h"
#include "runtime/solve/solved_character.h"
#include "support/counting_allocator.h"

#include <cstring>

namespace limber {
namespace {

using test::GuardedPair;
using test::GuardedStudy;

// Shapes that turn far against each other: twisted about the axis, bent, scaled, in waves. Few
// groups, so that none of them can be rigid.
std::shared_ptr<const Rig> BakeWildCylinder(unsigned seed, int groups) {
  bake::RawCharacter raw = test::MakeBendCylinder(12, 16);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (size_t s = 1; s < raw.shapes.size(); ++s) {
    const double twist = 3 * uniform(engine), bend = 2 * uniform(engine);
    const double wide = std::exp(0.7 * uniform(engine)), tall = std::exp(0.7 * uniform(engine));
    const double wave = 6 * uniform(engine), height = 0.5 * uniform(engine);
    bake::PointMatrix& shape = raw.shapes[s];
    shape = raw.shapes[0];
    for (Eigen::Index v = 0; v < shape.rows(); ++v) {
      const double x = shape(v, 0) * wide, y = shape(v, 1) * tall, z = shape(v, 2);
      const double turn = twist * y, lean = bend * y;
      const double out = std::cos(turn) * x - std::sin(turn) * z + height * std::sin(wave * y);
      shape.row(v) << std::cos(lean) * out - 0.7 * std::sin(lean) * y,
          std::sin(lean) * out + 0.7 * std::cos(lean) * y, std::sin(turn) * x + std::cos(turn) * z;
    }
  }
  bake::BakeOptions options;
  options.num_groups = groups;
  return test::BakeInMemory(raw, options);
}

std::shared_ptr<const Rig> BakeOneShape(bake::RawCharacter raw) {
  raw.shapes.resize(1);
  raw.shape_names.resize(1);
  return test::BakeInMemory(raw);
}

// Poses at the examples (reach 0), near them and far away.
template <int K>
GuardedStudy Study(const std::string& name, GuardedPair<K>* pair, int poses) {
  GuardedStudy study;
  std::mt19937 engine(7);
  for (const double reach : {0.0, 0.01, 0.1, 0.3, 1.0}) {
    for (int i = 0; i < (reach > 0 ? poses : pair->model->num_shapes); ++i) {
      pair->Pose(pair->TargetsNear(i % pair->model->num_shapes, reach, &engine));
      test::StudyPose(1000, pair, &study);
    }
  }
  study.Print(name);
  EXPECT_EQ(study.increases, 0);
  return study;
}

// All targets at one point.
template <int K>
void StudyCoincident(GuardedPair<K>* pair) {
  GuardedStudy study;
  pair->Pose(AlignedVector<double>(pair->plain.targets.size(), 0.1));
  test::StudyPose(1000, pair, &study);
  EXPECT_EQ(study.increases, 0);
}

TEST(TrustRegion, TwoDimensions_NeverIncreases) {
  GuardedPair<2> pair(test::BakeInMemory(test::MakeStretchSquare(10)));
  const GuardedStudy study = Study("square", &pair, 25);
  EXPECT_EQ(study.settled, study.poses);
  EXPECT_EQ(study.higher, 0);
  StudyCoincident(&pair);
}

TEST(TrustRegion, ThreeDimensions_NeverIncreases) {
  GuardedPair<3> pair(test::BakeInMemory(test::MakeBendCylinder(12, 16)));
  const GuardedStudy study = Study("cylinder", &pair, 25);
  EXPECT_EQ(study.settled, study.poses);
  EXPECT_EQ(study.higher, 0);
  StudyCoincident(&pair);
}

// The reason for the mode. Both are local: a few times the plain one ends in a lower valley.
TEST(TrustRegion, ShapesThatTurnFar_NeverIncreasesWhereThePlainOneDoes) {
  int plain_increases = 0, higher = 0, lower = 0, poses = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    GuardedPair<3> pair(BakeWildCylinder(seed, 1 + static_cast<int>(seed)));
    const GuardedStudy study = Study("wild cylinder " + std::to_string(seed), &pair, 10);
    plain_increases += study.plain_increases;
    higher += study.higher;
    lower += study.lower;
    poses += study.poses;
    StudyCoincident(&pair);
  }
  std::printf("plain increases F in %d of %d; guaranteed ends lower in %d, higher in %d\n",
              plain_increases, poses, lower, higher);
  EXPECT_GT(plain_increases, 0);
  EXPECT_LE(higher, poses / 20);
  EXPECT_GT(lower, higher);
}

}  // namespace
}  // namespace limber
