#include "viewer/camera.h"

#include "runtime/skin/skin_fixtures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::viewer {
namespace {

constexpr float kWidth = 800, kHeight = 600;

Bounds Box() {
  return {{-1, 0, -0.5f}, {2, 3, 0.5f}};
}

float Distance(Vec3 a, Vec3 b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(OrbitCamera, Frame_ShowsEveryCornerAndIsNotFarAway) {
  const OrbitCamera camera = OrbitCamera::Frame(Box(), kWidth / kHeight);
  float widest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point = {(corner & 1) != 0 ? 2.0f : -1.0f, (corner & 2) != 0 ? 3.0f : 0.0f,
                        (corner & 4) != 0 ? 0.5f : -0.5f};
    const auto [x, y, depth] = camera.Project(point, kWidth, kHeight);
    EXPECT_GT(x, 0);
    EXPECT_LT(x, kWidth);
    EXPECT_GT(y, 0);
    EXPECT_LT(y, kHeight);
    EXPECT_GT(depth, 0);
    EXPECT_LT(depth, 1);
    widest = std::max({widest, std::abs(2 * x / kWidth - 1), std::abs(2 * y / kHeight - 1)});
  }
  EXPECT_GT(widest, 0.8f);
}

TEST(OrbitCamera, PixelRay_GoesThroughTheProjectedPoint) {
  OrbitCamera camera = OrbitCamera::Frame(Box(), kWidth / kHeight);
  camera.Orbit(0.7f, -0.3f);
  camera.Pan(40, 25, kHeight);
  camera.Zoom(0.8f);
  const Vec3 point = {0.4f, 1.7f, 0.2f};
  const auto [x, y, depth] = camera.Project(point, kWidth, kHeight);
  const Ray ray = camera.PixelRay(x, y, kWidth, kHeight);
  const float along = Distance(point, ray.origin);
  const Vec3 found = {ray.origin.x + along * ray.direction.x,
                      ray.origin.y + along * ray.direction.y,
                      ray.origin.z + along * ray.direction.z};
  EXPECT_LT(Distance(found, point), 1e-4f * along);
}

TEST(OrbitCamera, DragInViewPlane_LandsUnderThePointerAtTheSameDepth) {
  OrbitCamera camera = OrbitCamera::Frame(Box(), kWidth / kHeight);
  camera.Orbit(-0.5f, 0.2f);
  const Vec3 start = {0.4f, 1.7f, 0.2f};
  const auto before = camera.Project(start, kWidth, kHeight);
  const Vec3 moved = camera.DragInViewPlane(start, 510, 220, kWidth, kHeight);
  const auto after = camera.Project(moved, kWidth, kHeight);
  EXPECT_NEAR(after[0], 510, 0.01f);
  EXPECT_NEAR(after[1], 220, 0.01f);
  EXPECT_NEAR(after[2], before[2], 1e-5f);
  const Vec3 same = camera.DragInViewPlane(start, before[0], before[1], kWidth, kHeight);
  EXPECT_LT(Distance(same, start), 1e-4f);
}

TEST(OrbitCamera, UpIsUpOnTheScreen) {
  const OrbitCamera camera = OrbitCamera::Frame(Box(), kWidth / kHeight);
  const auto low = camera.Project({0, 1, 0}, kWidth, kHeight);
  const auto high = camera.Project({0, 2, 0}, kWidth, kHeight);
  EXPECT_LT(high[1], low[1]);
}

TEST(OrbitCamera, BehindTheEye_IsNotInView) {
  const OrbitCamera camera = OrbitCamera::Frame(Box(), 1);
  const Vec3 eye = camera.eye(), centre = Box().centre();
  const Vec3 behind = {2 * eye.x - centre.x, 2 * eye.y - centre.y, 2 * eye.z - centre.z};
  EXPECT_LT(camera.Project(behind, kWidth, kHeight)[2], 0);
}

TEST(OrbitCamera, FrameFlat_LooksStraightAtThePlane) {
  // Rig space turned so that its xy plane is the zy plane of the mesh.
  RigSpace space;
  space.basis = {0, 0, -1, 0, 1, 0, 1, 0, 0};
  const Bounds bounds = {{0, -1, -1}, {0, 1, 1}};
  const OrbitCamera camera = OrbitCamera::FrameFlat(bounds, space, 1);
  EXPECT_TRUE(camera.flat());
  EXPECT_NEAR(std::abs(camera.eye().x), camera.distance(), 1e-5f * camera.distance());
  EXPECT_LT(camera.Project({0, 1, 0}, 100, 100)[1], camera.Project({0, -1, 0}, 100, 100)[1]);
}

TEST(ShapeBounds, InMeshSpace_WhateverTheRigSpace) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(64, 64);
  const Bounds bounds = ShapeBounds(fixture.mesh, fixture.space);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds.low[axis], -1, 1e-5);
    EXPECT_NEAR(bounds.high[axis], 1, 1e-5);
  }
}

}  // namespace
}  // namespace limber::viewer
