#include "viewer/play_drag.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

namespace limber::viewer {
namespace {

using Eigen::Vector3d;

Vector3d ToEigen(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 FromEigen(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

PickRay RayTo(const Vector3d& eye, const Vector3d& through) {
  PickRay ray;
  ray.origin = FromEigen(eye);
  ray.direction = FromEigen(through - eye);
  return ray;
}

Vector3d Random(std::mt19937* random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return {unit(*random), unit(*random), unit(*random)};
}

TEST(ViewPlaneDrag, PointerStill_NothingMoves) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d eye = 5 * Vector3d(0.1, 0.2, 1), point = Random(&random);
    const Vector3d forward = (-eye + Random(&random)).normalized();
    const Vector3d beside = point + 0.02 * Random(&random);  // caught off its middle
    const PickRay pointer = RayTo(eye, beside);
    const auto drag =
        ViewPlaneDrag::Begin(pointer, FromEigen(point), FromEigen(point), FromEigen(forward));
    ASSERT_TRUE(drag);
    const std::optional<Vec3> same = drag->PositionAt(pointer);
    ASSERT_TRUE(same);
    EXPECT_LT((ToEigen(*same) - point).norm(), 1e-5);
  }
}

TEST(ViewPlaneDrag, Motion_StaysInThePlaneAndUnderThePointer) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const Vector3d eye(0.5, 1, 6), grabbed = Random(&random), moved = 3 * Random(&random);
    const Vector3d forward = (-eye + Random(&random)).normalized();
    const auto drag = ViewPlaneDrag::Begin(RayTo(eye, grabbed), FromEigen(grabbed),
                                           FromEigen(moved), FromEigen(forward));
    ASSERT_TRUE(drag);
    const PickRay pointer = RayTo(eye, Random(&random));
    const std::optional<Vec3> position = drag->PositionAt(pointer);
    ASSERT_TRUE(position);
    const Vector3d motion = ToEigen(*position) - moved;
    EXPECT_NEAR(motion.dot(forward), 0, 2e-6) << "parallel to the image";
    // The grabbed point, moved as far, lies under the pointer again.
    const Vector3d direction = ToEigen(pointer.direction).normalized();
    EXPECT_LT((grabbed + motion - eye).cross(direction).norm(), 1e-5);
  }
}

TEST(ViewPlaneDrag, ParallelRays_MotionIsThatOfTheRay) {
  PickRay pointer;
  pointer.origin = {0.25f, 0.5f, 10};
  const auto drag = ViewPlaneDrag::Begin(pointer, {0.25f, 0.5f, 1}, {2, 3, 4}, {0, 0, -1});
  ASSERT_TRUE(drag);
  pointer.origin = {1.25f, -0.5f, 10};
  EXPECT_EQ(drag->PositionAt(pointer), (Vec3{3, 2, 4}));
}

TEST(ViewPlaneDrag, RayAlongOrAwayFromThePlane_Nothing) {
  PickRay along;
  along.origin = {0, 0, 5};
  along.direction = {1, 0, 0};
  EXPECT_FALSE(ViewPlaneDrag::Begin(along, {}, {}, {0, 0, -1}));
  PickRay pointer = along;
  pointer.direction = {0, 0, -1};
  const auto drag = ViewPlaneDrag::Begin(pointer, {}, {}, {0, 0, -1});
  ASSERT_TRUE(drag);
  EXPECT_FALSE(drag->PositionAt(along));
  pointer.direction = {0, 0, 1};
  EXPECT_FALSE(drag->PositionAt(pointer)) << "the plane is behind the eye";
  pointer.direction = {0, std::numeric_limits<float>::quiet_NaN(), -1};
  EXPECT_FALSE(drag->PositionAt(pointer));
}

TEST(NearestPoint, SkipsUnusableOnesAndBreaksTiesByIndex) {
  const std::array<Vec3, 4> points = {Vec3{1, 0, 0}, Vec3{0.1f, 0, 0}, Vec3{-0.5f, 0, 0},
                                      Vec3{0.5f, 0, 0}};
  const std::array<bool, 4> usable = {true, false, true, true};
  EXPECT_EQ(NearestPoint({}, points, usable), 2);
  const std::array<bool, 4> none = {};
  EXPECT_EQ(NearestPoint({}, points, none), -1);
}

}  // namespace
}  // namespace limber::viewer
