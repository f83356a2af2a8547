// An example that differs from the base in one region takes part there and nowhere else.
#include "bake/bake.h"
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

constexpr double kFrom = 1.2, kHeight = 2;
constexpr int kAround = 12, kAlong = 20;

// How far into the region: 0 below, 1 at the top, smooth.
double Into(double height) {
  const double t = std::clamp((height - kFrom) / (kHeight - kFrom), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// A straight cylinder and the same with a swollen, longer top; a handle on every fifth ring.
RawCharacter MakeSwollenCylinder(bool with_example) {
  RawCharacter raw = test::MakeBendCylinder(kAround, kAlong);
  raw.shapes.resize(1);
  raw.shape_names = {"straight"};
  if (with_example) {
    geometry::PointMatrix swollen = raw.shapes[0];
    for (auto point : swollen.rowwise()) {
      const double into = Into(point.y());
      point << point.x() * (1 + into), point.y() + 0.4 * into, point.z() * (1 + into);
    }
    raw.shapes.push_back(swollen);
    raw.shape_names.emplace_back("swollen");
  }
  const HandleSpec like = raw.marked_handles[0];
  raw.marked_handles.clear();
  const uint32_t bottom = kAround * (kAlong + 1);
  for (const uint32_t vertex :
       {bottom, 5U * kAround, 10U * kAround + 6, 15U * kAround, bottom + 1}) {
    raw.marked_handles.push_back(like);
    raw.marked_handles.back().source_vertex = vertex;
    raw.marked_handles.back().name = "v" + std::to_string(vertex);
  }
  return raw;
}

using Points = Vector<Eigen::Vector3d>;

// Handles at their place in one of the shapes, but for some moved on.
Points Pose(const std::shared_ptr<const Rig>& rig, int shape, int moved, Vec3 by) {
  PoseState state = PoseState::Create(rig).value();
  for (int h = 0; h < rig->num_handles(); ++h) {
    const Eigen::Vector3d at =
        test::ShapePosition(*rig, shape, rig->tables().handles[size_t(h)].vertex);
    Vec3 target{float(at.x()), float(at.y()), float(at.z())};
    if (h == moved) target = {target.x + by.x, target.y + by.y, target.z + by.z};
    EXPECT_TRUE(state.SetTarget(h, target).ok());
  }
  PoseOptions options;
  options.iterations = 3000;
  options.settle_tolerance = 1e-9;
  EXPECT_TRUE(state.Solve(options, nullptr).ok());
  return test::SkinNaively(*rig, state.transforms());
}

// The largest distance from a shape, of vertices whose height at rest lies between two.
double Distance(const Rig& rig, const Points& points, int shape, double low, double high) {
  double largest = 0;
  for (uint32_t v = 0; v < points.size(); ++v) {
    const double height = test::ShapePosition(rig, 0, v).y();
    if (height < low || height > high) continue;
    largest = std::max(largest, (points[v] - test::ShapePosition(rig, shape, v)).norm());
  }
  return largest;
}

TEST(LocalExamples, HandlesOfTheRegionBringTheExample_AndTheRestStays) {
  const auto rig = test::BakeInMemory(MakeSwollenCylinder(true));
  const Points points = Pose(rig, 1, -1, {});
  EXPECT_LT(Distance(*rig, points, 1, 0, kHeight), 0.002);
  EXPECT_LT(Distance(*rig, points, 0, 0, kFrom), 0.002);
  EXPECT_GT(Distance(*rig, points, 0, kFrom, kHeight), 0.3) << "the test moves something";
}

// The far end moves as it would in a character without the example, and the region stays as it was.
TEST(LocalExamples, HandlesElsewhere_DoNotBringTheExample) {
  const auto with = test::BakeInMemory(MakeSwollenCylinder(true));
  const auto without = test::BakeInMemory(MakeSwollenCylinder(false));
  const Points points = Pose(with, 0, 0, {0.3f, 0.1f, 0}),
               plain = Pose(without, 0, 0, {0.3f, 0.1f, 0});
  EXPECT_LT(Distance(*with, points, 0, 1.5, kHeight),
            Distance(*with, plain, 0, 1.5, kHeight) + 0.002);
  double apart = 0, moved = 0;
  for (uint32_t v = 0; v < points.size(); ++v) {
    apart = std::max(apart, (points[v] - plain[v]).norm());
    moved = std::max(moved, (points[v] - test::ShapePosition(*with, 0, v)).norm());
  }
  EXPECT_GT(moved, 0.3);
  EXPECT_LT(apart, 0.05 * moved);
}

}  // namespace
}  // namespace limber::bake
