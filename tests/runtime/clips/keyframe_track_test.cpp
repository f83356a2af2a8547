// Values between keyframes against closed forms.
#include "clips/keyframe_track.h"

#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::test {
namespace {

constexpr double kExact = 1e-12;

KeyframeTrack ScalarTrack(Interpolation interpolation, Vector<double> times,
                          Vector<double> values) {
  return {interpolation, 1, std::move(times), std::move(values)};
}

Vector<double> AboutAxis(const Eigen::Vector3d& axis, double angle) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis.normalized()));
  return {q.x(), q.y(), q.z(), q.w()};
}

KeyframeTrack RotationTrack(const Vector<double>& from, const Vector<double>& to) {
  KeyframeTrack track{Interpolation::kLinear, 4, {1, 3}, from};
  track.values.insert(track.values.end(), to.begin(), to.end());
  return track;
}

double AngleBetween(const Eigen::Quaterniond& a, const Vector<double>& b) {
  return a.angularDistance(Eigen::Quaterniond(b[3], b[0], b[1], b[2]));
}

TEST(KeyframeTrack, BeforeFirstAndAfterLastKey_IsTheirValue) {
  for (const auto kind : {Interpolation::kStep, Interpolation::kLinear}) {
    const KeyframeTrack track = ScalarTrack(kind, {0.5, 1, 4}, {7, 8, 9});
    EXPECT_EQ(SampleTrack(track, 0)[0], 7);
    EXPECT_EQ(SampleTrack(track, 0.5)[0], 7);
    EXPECT_EQ(SampleTrack(track, 4)[0], 9);
    EXPECT_EQ(SampleTrack(track, 100)[0], 9);
  }
}

TEST(KeyframeTrack, Step_HoldsEachKeyUntilTheNext) {
  const KeyframeTrack track = ScalarTrack(Interpolation::kStep, {0, 1, 2}, {5, 6, 7});
  EXPECT_EQ(SampleTrack(track, 0.999)[0], 5);
  EXPECT_EQ(SampleTrack(track, 1)[0], 6);
  EXPECT_EQ(SampleTrack(track, 1.5)[0], 6);
}

TEST(KeyframeTrack, Linear_IsTheLineThroughItsKeys) {
  const KeyframeTrack track{Interpolation::kLinear, 3, {0, 1, 4}, {0, 10, -1, 1, 20, -1, 7, 2, 5}};
  for (const double u : {0.0, 0.25, 0.9}) {
    const Vector<double> value = SampleTrack(track, 1 + 3 * u);
    EXPECT_NEAR(value[0], 1 + 6 * u, kExact);
    EXPECT_NEAR(value[1], 20 - 18 * u, kExact);
    EXPECT_NEAR(value[2], -1 + 6 * u, kExact);
  }
}

TEST(KeyframeTrack, CubicSplineThroughACubicWithItsDerivatives_IsThatCubic) {
  const auto cubic = [](double t) { return 2 * t * t * t - 3 * t * t + 0.5 * t + 4; };
  const auto derivative = [](double t) { return 6 * t * t - 6 * t + 0.5; };
  KeyframeTrack track = ScalarTrack(Interpolation::kCubicSpline, {0.2, 0.5, 2}, {});
  for (const double t : track.times) {
    for (const double number : {derivative(t), cubic(t), derivative(t)})
      track.values.push_back(number);
  }
  ASSERT_EQ(track.values.size(), track.num_values());
  for (double t = 0.2; t <= 2; t += 0.1)
    EXPECT_NEAR(SampleTrack(track, t)[0], cubic(t), 1e-10) << t;
  EXPECT_EQ(SampleTrack(track, 0)[0], cubic(0.2));
  EXPECT_EQ(SampleTrack(track, 9)[0], cubic(2));
}

TEST(KeyframeTrack, CubicSpline_UsesOutTangentOfTheFirstAndInTangentOfTheSecondKey) {
  // Hermite's basis at u = 1/2: 1/2, 1/8, 1/2, -1/8, tangents times the 2 seconds between the keys.
  const KeyframeTrack track =
      ScalarTrack(Interpolation::kCubicSpline, {0, 2}, {100, 1, 3, 5, 2, 200});
  EXPECT_NEAR(SampleTrack(track, 1)[0], 0.5 * 1 + 0.5 * 2 + 2 * (3 - 5) / 8.0, kExact);
}

TEST(KeyframeTrack, LinearRotation_TurnsAtConstantSpeedAboutOneAxis) {
  const Eigen::Vector3d axis(1, 2, -0.5);
  const KeyframeTrack track = RotationTrack(AboutAxis(axis, 0.3), AboutAxis(axis, 2.5));
  for (const double u : {0.0, 0.1, 0.5, 0.8, 1.0}) {
    const Eigen::Quaterniond q = SampleRotation(track, 1 + 2 * u);
    EXPECT_NEAR(AngleBetween(q, AboutAxis(axis, 0.3 + 2.2 * u)), 0, 1e-7) << u;
    EXPECT_NEAR(q.norm(), 1, kExact);
  }
}

TEST(KeyframeTrack, LinearRotation_TakesTheShorterWayWhateverTheSignOfItsKeys) {
  const Eigen::Vector3d axis(0, 1, 0);
  Vector<double> to = AboutAxis(axis, 0.8);
  const Eigen::Quaterniond expected = SampleRotation(RotationTrack(AboutAxis(axis, 0), to), 1.5);
  EXPECT_NEAR(AngleBetween(expected, AboutAxis(axis, 0.2)), 0, 1e-7);
  for (double& number : to)
    number = -number;
  const Eigen::Quaterniond flipped = SampleRotation(RotationTrack(AboutAxis(axis, 0), to), 1.5);
  EXPECT_NEAR(flipped.angularDistance(expected), 0, 1e-7);
}

TEST(KeyframeTrack, Rotations_AreUnitEvenWhereKeysAreNot) {
  const KeyframeTrack spline{
      Interpolation::kCubicSpline, 4, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0.5, 0, 0, 0,  //
                                               0, 1, 0, 0, 1, 0, 0, 1, 0,   0, 0, 0}};
  EXPECT_NEAR(SampleRotation(spline, 0.4).norm(), 1, kExact);
  const KeyframeTrack zeros = RotationTrack({0, 0, 0, 0}, {0, 0, 0, 0});
  EXPECT_EQ(SampleRotation(zeros, 2).coeffs(), Eigen::Quaterniond::Identity().coeffs());
  const KeyframeTrack twice = RotationTrack({0, 0, 0, 2}, {0, 0, 2, 0});
  EXPECT_NEAR(AngleBetween(SampleRotation(twice, 2), AboutAxis({0, 0, 1}, M_PI / 2)), 0, 1e-7);
}

TEST(KeyframeTrack, NormalisedIntegers_StandForTheirFractions) {
  GltfParts parts = MakeAnimatedBar();
  const size_t input = parts.AddFloats({0, 1}, "SCALAR");
  const size_t output = parts.AddNormalisedShorts({0, 0, 0, 32767, 0, 0, 32767, -32768}, "VEC4");
  const auto file = GltfFile::Parse(parts.Glb(), "bar.glb");
  ASSERT_TRUE(file.ok()) << file.status().message();
  AnimationChannel channel;
  channel.input = static_cast<int>(input);
  channel.output = static_cast<int>(output);
  const auto track = ReadKeyframeTrack(*file, channel, 4, true);
  ASSERT_TRUE(track.ok()) << track.status().message();
  EXPECT_EQ(track->values, (Vector<double>{0, 0, 0, 1, 0, 0, 1, -1}));
}

}  // namespace
}  // namespace limber::test
