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
    GuardedPair<3> pair(BakeWildCylinder(seed, seed <= 2 ? 2 : static_cast<int>(seed)));
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

// Runs the plain one until it rests and the guaranteed one from there. Where the plain one's rest
// is stationary the guaranteed one stays; elsewhere it goes down to where F is.
template <int K>
void CompareRests(const std::string& name, GuardedPair<K>* pair) {
  std::mt19937 engine(9);
  const double size = std::sqrt(pair->model->energy_scale);
  double plain_slope = 0, slope = 0, apart = 0;
  int stayed = 0;
  for (int pose = 0; pose < 12; ++pose) {
    pair->Pose(pair->TargetsNear(pose % pair->model->num_shapes, 0.1, &engine));
    double change = 1;
    for (int i = 0; i < 3000 && change > 1e-9; ++i)
      change = pair->plain.Run(*pair->model, pair->settings).change;
    pair->guarded.Adopt(*pair->model, pair->plain.blend(), pair->plain.rotations());
    typename TrustRegion<K>::Outcome outcome;
    for (int i = 0; i < 20000 && !outcome.settled; ++i)
      outcome = pair->RunGuarded();
    EXPECT_TRUE(outcome.settled) << pose;
    const auto plain = pair->PlainModes(), guarded = pair->GuardedModes();
    EXPECT_LE(pair->GuardedObjective(), pair->PlainObjective() * (1 + 1e-12));
    const double from = pair->SteepestOfModes(plain, pair->plain.blend());
    const double to = pair->SteepestOfModes(guarded, pair->trust.blend());
    EXPECT_LT(to, 1e-4) << pose;
    EXPECT_LT(pair->SteepestOfWeights(guarded, pair->trust.blend()), 1e-5 * size) << pose;
    const double distance = (plain - guarded).norm() / size;
    if (from < 1e-5 && change <= 1e-9) {
      ++stayed;
      EXPECT_LT(distance, 1e-5) << pose;
    }
    plain_slope = std::max(plain_slope, from);
    slope = std::max(slope, to);
    apart = std::max(apart, distance);
  }
  std::printf(
      "%s: slope of F at rest: plain up to %.1e, guaranteed up to %.1e; the same rest in %d "
      "of 12, otherwise up to %.1e of the size apart\n",
      name.c_str(), plain_slope, slope, stayed, apart);
  EXPECT_GE(stayed, 4);
}

TEST(TrustRegion, Rest_IsStationaryAndThePlainOnesWhereThatIs) {
  GuardedPair<2> square(test::BakeInMemory(test::MakeStretchSquare(10)));
  CompareRests("square", &square);
  GuardedPair<3> cylinder(test::BakeInMemory(test::MakeBendCylinder(12, 16)));
  CompareRests("cylinder", &cylinder);
  GuardedPair<3> wild(BakeWildCylinder(1, 2));
  CompareRests("wild cylinder", &wild);
}

// FAST: one energy for R and T^, so both descend, and to the same rest.
template <int K>
void ExpectPlainDescends(GuardedPair<K>* pair) {
  const GuardedStudy study = Study("one shape", pair, 5);
  EXPECT_EQ(study.plain_increases, 0);
  EXPECT_EQ(study.lower + study.higher, 0);
}

TEST(TrustRegion, OneShape_IsFastWhichDescendsByItself) {
  GuardedPair<2> square(BakeOneShape(test::MakeStretchSquare(10)));
  ExpectPlainDescends(&square);
  GuardedPair<3> cylinder(BakeOneShape(test::MakeBendCylinder(12, 16)));
  ExpectPlainDescends(&cylinder);
}

TEST(TrustRegion, OtherFormulations_NeverIncrease) {
  for (int which = 0; which < 3; ++which) {
    Alternation<3>::Settings settings;
    settings.square_roots = which != 0;
    settings.varying_blend = which != 1;
    if (which == 2) settings.lambda = 0;
    GuardedPair<3> pair(BakeWildCylinder(1, 2), settings);
    Study("formulation " + std::to_string(which), &pair, 5);
    for (int i = 0; i < pair.model->num_blocks && !settings.varying_blend; ++i) {
      const int shape = i % pair.model->num_shapes;
      EXPECT_EQ(pair.trust.blend()[static_cast<size_t>(i)],
                pair.trust.blend()[static_cast<size_t>(shape)]);
    }
  }
}

TEST(TrustRegion, WithoutRotations_IsThePlainOptimum) {
  for (const bool folded : {false, true}) {
    bake::BakeOptions options;
    options.rotations = !folded;
    const auto model =
        PoseModel::Create(test::BakeInMemory(test::MakeBendCylinder(12, 16), options)).value();
    Alternation<3> plain(*model), guarded(*model);
    TrustRegion<3> trust(*model);
    Alternation<3>::Settings settings;
    settings.rotations = false;
    plain.targets[0] = guarded.targets[0] = 0.3;
    plain.ResetToRest(*model);
    guarded.ResetToRest(*model);
    for (int i = 0; i < 3; ++i) {
      plain.Run(*model, settings);
      EXPECT_TRUE(trust.Run(*model, settings, &guarded).settled);
    }
    EXPECT_EQ(plain.blend(), trust.blend());
    double nearness = 0;
    EXPECT_EQ(trust.elastic(), plain.ElasticEnergy(*model, &nearness));
    EXPECT_EQ(trust.nearness(), nearness);
    const AlignedVector<double>& transforms = trust.Transforms(*model);
    const AlignedVector<double>& expected = plain.Transforms(*model);
    for (size_t i = 0; i < expected.size(); ++i)
      ASSERT_NEAR(transforms[i], expected[i], 1e-4 * (1 + std::abs(expected[i])));
  }
}

class TrustRegionFrames : public testing::Test {
 protected:
  TrustRegionFrames() : pair_(BakeWildCylinder(1, 2)) {}

  // A pose for which both plain steps and models are needed.
  void Pose() {
    std::mt19937 engine(3);
    pair_.Pose(pair_.TargetsNear(1, 0.1, &engine));
  }

  GuardedPair<3> pair_;
};

TEST_F(TrustRegionFrames, Targets_AreMetByEveryStep) {
  Pose();
  const ConstraintSystem& system = pair_.model->pins->system;
  for (int i = 0; i < 100; ++i) {
    pair_.RunGuarded();
    const Eigen::MatrixXd gap =
        system.root().transpose() * (pair_.Targets() - system.modes() * pair_.GuardedModes());
    ASSERT_LT(gap.norm(), 1e-9 * system.root().norm());
  }
}

TEST_F(TrustRegionFrames, SameTargets_KeepOneObjectiveOnceNearnessIsHeld) {
  Pose();
  pair_.guarded.targets[4] += 0.2;  // D has a way to go
  double last = 0;
  for (int i = 0; i < 300; ++i) {
    const auto outcome = pair_.RunGuarded();
    if (i > 100) {
      ASSERT_EQ(outcome.before, last) << "iteration " << i;
    }
    last = outcome.objective;
    ASSERT_LE(outcome.objective, outcome.before);
    ASSERT_EQ(outcome.restarted, i == 0);
  }
}

TEST_F(TrustRegionFrames, NewTargetsOrAnotherState_StartAnew) {
  Pose();
  for (int i = 0; i < 3; ++i)
    pair_.RunGuarded();
  EXPECT_FALSE(pair_.RunGuarded().restarted);
  pair_.guarded.targets[0] += 1e-3;
  EXPECT_TRUE(pair_.RunGuarded().restarted);
  EXPECT_FALSE(pair_.RunGuarded().restarted);
  pair_.guarded.Run(*pair_.model, pair_.settings);  // someone else moved the alternation
  EXPECT_TRUE(pair_.RunGuarded().restarted);
  pair_.settings.lambda = 0.25;
  EXPECT_TRUE(pair_.RunGuarded().restarted);
  EXPECT_FALSE(pair_.RunGuarded().restarted);
}

// The plain alternation goes on from B and R; its transforms, which E_d alone chooses, cost less.
TEST_F(TrustRegionFrames, Alternation_HasTheWeightsAndRotations) {
  Pose();
  for (int i = 0; i < 200; ++i)
    pair_.RunGuarded();
  EXPECT_EQ(pair_.guarded.blend(), pair_.trust.blend());
  EXPECT_EQ(pair_.guarded.rotations(), pair_.trust.rotations());
  double nearness = 0;
  EXPECT_LE(pair_.guarded.ElasticEnergy(*pair_.model, &nearness),
            pair_.trust.elastic() * (1 + 1e-9));
  EXPECT_NEAR(nearness, pair_.trust.nearness(), 1e-12 * nearness);
}

TEST_F(TrustRegionFrames, Frames_AllocateNothing) {
  Pose();
  pair_.RunGuarded();
  int rejected = 0;
  const int64_t before = test::AllocationCount();
  for (int i = 0; i < 400; ++i) {
    rejected += pair_.RunGuarded().rejected;
    pair_.trust.Transforms(*pair_.model);
    if (i % 100 == 99) pair_.guarded.targets[4] += 0.05;
  }
  EXPECT_EQ(test::AllocationCount(), before);
  EXPECT_GT(rejected, 0) << "models must have been tried";
}

TEST_F(TrustRegionFrames, SameFrames_GiveTheSameBits) {
  GuardedPair<3> other(pair_.model->rig);
  std::mt19937 engine(3);
  const AlignedVector<double> targets = pair_.TargetsNear(1, 0.1, &engine);
  pair_.Pose(targets);
  other.Pose(targets);
  for (int i = 0; i < 300; ++i) {
    pair_.RunGuarded();
    other.RunGuarded();
  }
  const auto equal = [](const AlignedVector<double>& x, const AlignedVector<double>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
  };
  EXPECT_TRUE(equal(pair_.trust.modes(), other.trust.modes()));
  EXPECT_TRUE(equal(pair_.trust.blend(), other.trust.blend()));
  EXPECT_TRUE(equal(pair_.trust.rotations(), other.trust.rotations()));
}

}  // namespace
}  // namespace limber
