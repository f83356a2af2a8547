#include "solve/motion_smoother.h"

#include "core/vector.h"
#include "solve/rotation_planes.h"
#include "support/counting_allocator.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace limber {
namespace {

constexpr size_t kGroups = 3, kShapes = 3, kBlocks = kGroups * kShapes;
constexpr double kLag = 0.1;

// Input of the whole smoother at one time, from a weight and an angle.
template <int K>
struct Input {
  AlignedVector<double> blend, rotations;

  // Each group: `weight` of the second shape, the rest of the first; all turned by `angle`.
  Input(double weight, double angle)
      : blend(PaddedSize(kBlocks)),
        rotations(PaddedSize(kBlocks) * K * K) {
    SetIdentity<K>(&rotations);
    for (size_t g = 0; g < kGroups; ++g) {
      blend[g * kShapes] = 1 - weight;
      blend[g * kShapes + 1] = weight;
    }
    for (size_t i = 0; i < kBlocks; ++i) {
      rotations[PlaneIndex<K>(i, 0, 0)] = rotations[PlaneIndex<K>(i, 1, 1)] = std::cos(angle);
      rotations[PlaneIndex<K>(i, 1, 0)] = std::sin(angle);
      rotations[PlaneIndex<K>(i, 0, 1)] = -std::sin(angle);
    }
  }
};

template <int K>
double AngleOf(const MotionSmoother<K>& smoother) {
  return std::atan2(smoother.rotations()[PlaneIndex<K>(0, 1, 0)],
                    smoother.rotations()[PlaneIndex<K>(0, 0, 0)]);
}

// Weight shown over a path, at each multiple of `every` seconds.
Vector<double> Follow(const std::function<double(double)>& path, double rate, double seconds,
                      double every) {
  MotionSmoother<3> smoother(kGroups, kShapes);
  const Input<3> start(path(0), 0);
  smoother.Reset(start.blend, start.rotations);
  Vector<double> shown;
  const int frames = static_cast<int>(std::lround(seconds * rate));
  const int between = static_cast<int>(std::lround(every * rate));
  for (int frame = 1; frame <= frames; ++frame) {
    const Input<3> input(path(frame / rate), 0);
    smoother.Advance(input.blend, input.rotations, kLag, 1 / rate);
    if (frame % between == 0) shown.push_back(smoother.blend()[1]);
  }
  return shown;
}

TEST(MotionSmoother, Ramp_MatchesTheClosedForm) {
  // z' of two lags behind u = v t from rest: u - 2 v T + (v T t / T + 2 v T) e^(-t/T).
  const double speed = 0.5;
  for (const double rate : {7.0, 30.0, 240.0}) {
    MotionSmoother<3> smoother(kGroups, kShapes);
    const Input<3> start(0, 0);
    smoother.Reset(start.blend, start.rotations);
    for (int frame = 1; frame <= rate; ++frame) {
      const double t = frame / rate;
      const Input<3> input(speed * t, 0);
      smoother.Advance(input.blend, input.rotations, kLag, 1 / rate);
      const double expected = speed * (t - 2 * kLag + (t + 2 * kLag) * std::exp(-t / kLag));
      EXPECT_NEAR(smoother.blend()[1], expected < 1e-7 ? smoother.blend()[1] : expected, 1e-12);
    }
  }
}

TEST(MotionSmoother, HalfStepsOfALinearInput_AreOneStep) {
  MotionSmoother<3> whole(kGroups, kShapes), halves(kGroups, kShapes);
  const Input<3> start(0.2, 0.1);
  whole.Reset(start.blend, start.rotations);
  halves.Reset(start.blend, start.rotations);
  double weight = 0.2;
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> step(0.001, 0.2), place(0, 1);
  for (int frame = 0; frame < 50; ++frame) {
    const double next = place(engine), dt = step(engine);
    const Input<3> end(next, 0), middle((weight + next) / 2, 0);
    whole.Advance(end.blend, end.rotations, kLag, dt);
    halves.Advance(middle.blend, middle.rotations, kLag, dt / 2);
    halves.Advance(end.blend, end.rotations, kLag, dt / 2);
    EXPECT_NEAR(whole.blend()[1], halves.blend()[1], 1e-12);
    weight = next;
  }
}

TEST(MotionSmoother, AtRest_TheStaticSolutionBitForBit) {
  MotionSmoother<3> smoother(kGroups, kShapes);
  const Input<3> start(0, 0), end(0.3, 0.7);
  smoother.Reset(start.blend, start.rotations);
  int frames = 0;
  while (!smoother.Advance(end.blend, end.rotations, kLag, 1.0 / 60) && frames < 1000)
    ++frames;
  EXPECT_GT(frames, 60);
  ASSERT_LT(frames, 600);
  EXPECT_EQ(smoother.blend(), end.blend);
  EXPECT_EQ(smoother.rotations(), end.rotations);
  EXPECT_TRUE(smoother.Advance(end.blend, end.rotations, kLag, 1.0 / 60));
  EXPECT_EQ(smoother.blend(), end.blend);
}

TEST(MotionSmoother, NoTimeAndAllTime_ChangeNothingAndEverything) {
  MotionSmoother<2> smoother(kGroups, kShapes);
  const Input<2> start(0.25, 0.2), end(0.75, 1.0);
  smoother.Reset(start.blend, start.rotations);
  smoother.Advance(end.blend, end.rotations, kLag, 0);
  EXPECT_NEAR(smoother.blend()[1], 0.25, 1e-15);
  EXPECT_NEAR(AngleOf(smoother), 0.2, 1e-12);
  smoother.Advance(end.blend, end.rotations, kLag, 1e9);
  EXPECT_EQ(smoother.blend(), end.blend);
  smoother.Advance(start.blend, start.rotations, 1e-300, 1);
  EXPECT_TRUE(std::isfinite(smoother.blend()[1]));
}

// Weights stay on their simplices and rotations rotations, whatever comes in.
TEST(MotionSmoother, RandomInput_StaysAMixAndRotations) {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> unit(0, 1), sign(-1, 1);
  MotionSmoother<3> smoother(kGroups, kShapes);
  for (int frame = 0; frame < 2000; ++frame) {
    Input<3> input(0, 0);
    for (size_t g = 0; g < kGroups; ++g) {
      const double a = unit(engine), b = unit(engine) * (1 - a);
      input.blend[g * kShapes] = a;
      input.blend[g * kShapes + 1] = b;
      input.blend[g * kShapes + 2] = 1 - a - b;
    }
    for (size_t i = 0; i < kBlocks; ++i) {
      const Eigen::Matrix3d turn =
          Eigen::Quaterniond(sign(engine), sign(engine), sign(engine), sign(engine))
              .normalized()
              .toRotationMatrix();
      for (size_t e = 0; e < 9; ++e) {
        input.rotations[PlaneIndex<3>(i, e / 3, e % 3)] =
            turn(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3));
      }
    }
    smoother.Advance(input.blend, input.rotations, kLag, 0.05 * unit(engine));
    for (size_t g = 0; g < kGroups; ++g) {
      double sum = 0;
      for (size_t s = 0; s < kShapes; ++s) {
        ASSERT_GE(smoother.blend()[g * kShapes + s], 0);
        sum += smoother.blend()[g * kShapes + s];
      }
      ASSERT_NEAR(sum, 1, 1e-14);
    }
    for (size_t i = 0; i < kBlocks; ++i) {
      const Eigen::Matrix3d r = MatrixOfBlock<3>(smoother.rotations().data(), i);
      ASSERT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-10);
      ASSERT_GT(r.determinant(), 0);
    }
  }
}

// A kink in the input is none in the output: second differences per frame squared stay bounded as
// frames get shorter, where the input's grow without bound.
TEST(MotionSmoother, KinkedInput_GivesTwoContinuousDerivatives) {
  const auto kinked = [](double t) { return t < 0.5 ? 0.2 : 0.2 + (t - 0.5); };
  double last_jump = 1e300;
  for (const double rate : {100.0, 400.0, 1600.0}) {
    const Vector<double> shown = Follow(kinked, rate, 1, 1 / rate);
    double largest = 0, largest_jump = 0, previous = 0;
    for (size_t i = 1; i + 1 < shown.size(); ++i) {
      const double second = (shown[i + 1] - 2 * shown[i] + shown[i - 1]) * rate * rate;
      largest = std::max(largest, std::abs(second));
      largest_jump = std::max(largest_jump, std::abs(second - previous));
      previous = second;
    }
    EXPECT_LT(largest, 1 / kLag) << rate;            // speed over lag; the input's is `rate`
    EXPECT_LT(largest_jump, last_jump / 3) << rate;  // second derivatives are continuous
    last_jump = largest_jump;
  }
}

// The same path at other frame rates: what differs is the sampling of the path, of second order.
TEST(MotionSmoother, FrameRates_AgreeToSecondOrder) {
  const auto path = [](double t) { return 0.5 + 0.4 * std::sin(3 * t); };
  const Vector<double> fine = Follow(path, 3840, 2, 0.1);
  double last = 0;
  for (const double rate : {30.0, 60.0, 120.0, 240.0}) {
    const Vector<double> shown = Follow(path, rate, 2, 0.1);
    double error = 0;
    for (size_t i = 0; i < fine.size(); ++i)
      error = std::max(error, std::abs(shown[i] - fine[i]));
    EXPECT_LT(error, 0.6 / (rate * rate));  // |u''| / 8 dt^2 of linear interpolation
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.5) << rate;
    }
    last = error;
  }
}

TEST(MotionSmoother, HalfTurnOfTheInput_StaysARotationAndArrives) {
  MotionSmoother<3> smoother(kGroups, kShapes);
  const Input<3> start(0.5, 0), end(0.5, std::numbers::pi);
  smoother.Reset(start.blend, start.rotations);
  bool at_rest = false;
  for (int frame = 0; frame < 600 && !at_rest; ++frame) {
    at_rest = smoother.Advance(end.blend, end.rotations, kLag, 1.0 / 60);
    const Eigen::Matrix3d r = MatrixOfBlock<3>(smoother.rotations().data(), 0);
    ASSERT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    ASSERT_GT(r.determinant(), 0);
  }
  EXPECT_TRUE(at_rest);
}

TEST(MotionSmoother, Advance_AllocatesNothing) {
  MotionSmoother<3> smoother(kGroups, kShapes);
  const Input<3> input(0.4, 0.3);
  const int64_t before = test::AllocationCount();
  for (int frame = 0; frame < 20; ++frame)
    smoother.Advance(input.blend, input.rotations, kLag, 0.01);
  EXPECT_EQ(test::AllocationCount(), before);
}

}  // namespace
}  // namespace limber
