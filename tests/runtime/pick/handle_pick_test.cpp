#include "core/vector.h"
#include "pick/picker.h"
#include "pick_scene.h"

#include <gtest/gtest.h>

#include <limits>

namespace limber {
namespace {

using test::TorusScene;

// The torus lies around the z axis: seen from above, its top side is at z = 0.4, its bottom at
// -0.4.
class HandlePick : public testing::Test {
 protected:
  HandlePick() : scene_(40, 24), picker_(Picker::Create(scene_.mesh, scene_.rest)) {
    ray_.origin = {1, 0, 5};
    ray_.direction = {0, 0, -2};
  }

  std::optional<HandleHit> Pick(const Vector<Vec3>& handles,
                                const HandlePickOptions& options) const {
    return picker_->PickHandle(ray_, handles, options);
  }

  TorusScene scene_;
  Result<Picker> picker_;
  PickRay ray_;
};

TEST_F(HandlePick, NearestToTheRay_Wins) {
  const Vector<Vec3> handles = {{1.2f, 0, 0.4f}, {1.05f, 0, 0.4f}, {0.9f, 0, 0.4f}};
  const std::optional<HandleHit> hit = Pick(handles, {.radius = 0.3f});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->handle, 1);
  EXPECT_NEAR(hit->offset, 0.05, 1e-6);
  EXPECT_NEAR(hit->distance, 4.6, 1e-6);
}

TEST_F(HandlePick, OutOfReach_Nothing) {
  EXPECT_FALSE(Pick({{1.2f, 0, 0.4f}}, {.radius = 0.19f}));
  EXPECT_TRUE(Pick({{1.2f, 0, 0.4f}}, {.radius = 0.21f}));
  EXPECT_FALSE(Pick({{1.2f, 0, 0.4f}}, {.cone_tangent = 0.19f / 4.6f}));
  EXPECT_TRUE(Pick({{1.2f, 0, 0.4f}}, {.cone_tangent = 0.21f / 4.6f}));
  EXPECT_FALSE(Pick({{1, 0, 6}}, {.radius = 1})) << "behind the eye";
  EXPECT_FALSE(Pick({}, {.radius = 1}));
}

TEST_F(HandlePick, Cone_MeasuresInScreenSpace) {
  // The far one is 0.12 off at 4.6 (0.026), the near one 0.10 off at 2 (0.05): on the screen the
  // far one is nearer.
  const Vector<Vec3> handles = {{1.1f, 0, 3}, {1.12f, 0, 0.4f}};
  EXPECT_EQ(Pick(handles, {.cone_tangent = 0.06f})->handle, 1);
  EXPECT_EQ(Pick(handles, {.radius = 0.3f})->handle, 0);
}

TEST_F(HandlePick, BehindTheSurface_OnlyWhenAsked) {
  const Vector<Vec3> handles = {{1, 0, -0.4f}};
  for (const HandlePickOptions& base :
       {HandlePickOptions{.radius = 0.1f}, HandlePickOptions{.cone_tangent = 0.02f}}) {
    HandlePickOptions options = base;
    EXPECT_FALSE(Pick(handles, options));
    options.occlusion = false;
    EXPECT_TRUE(Pick(handles, options));
    options.occlusion = true;
    options.depth_tolerance = 0.9f / picker_->diagonal();
    EXPECT_TRUE(Pick(handles, options)) << "0.8 below the surface, 0.9 allowed";
  }
}

TEST_F(HandlePick, HiddenOneNearer_TheVisibleOneIsPicked) {
  const Vector<Vec3> handles = {{1, 0, -0.4f}, {1.04f, 0, 0.4f}};
  EXPECT_EQ(Pick(handles, {.radius = 0.1f})->handle, 1);
  EXPECT_EQ(Pick(handles, {.radius = 0.1f, .occlusion = false})->handle, 0);
}

TEST_F(HandlePick, Orthographic_LooksAlongTheRayNotFromItsOrigin) {
  // Beside the tube and below its middle: in plain sight along the ray's direction, but from the
  // ray's origin the tube is in between.
  ray_.origin = {1, 0, 1};
  const Vector<Vec3> handles = {{1.5f, 0, -0.3f}};
  EXPECT_TRUE(Pick(handles, {.radius = 0.6f}));
  EXPECT_FALSE(Pick(handles, {.cone_tangent = 0.6f}));
  EXPECT_TRUE(Pick(handles, {.cone_tangent = 0.6f, .occlusion = false}));
}

TEST_F(HandlePick, EveryVertexOfTheSurface_IsVisibleFromAlongItsNormal) {
  // Handles are vertices: the surface next to them must not hide them.
  for (size_t v = 0; v < scene_.rest.size(); ++v) {
    const test::Vec3d p = test::ToEigen(scene_.rest[v]);
    const test::Vec3d centre = test::Vec3d(p.x(), p.y(), 0).normalized();
    const test::Vec3d normal = (p - centre).normalized();
    ray_.origin = test::FromEigen(p + 0.5 * normal);
    ray_.direction = test::FromEigen(-normal);
    const std::optional<HandleHit> hit = Pick(scene_.rest, {.cone_tangent = 0.01f});
    ASSERT_TRUE(hit) << v;
    EXPECT_EQ(hit->handle, static_cast<int>(v));
  }
}

TEST_F(HandlePick, Ties_NearestThenLowestIndex) {
  const Vector<Vec3> handles = {{1, 0, 1}, {1, 0, 3}, {1, 0, 3}, {1, 0, 2}};
  EXPECT_EQ(Pick(handles, {.radius = 0.1f})->handle, 1);
  EXPECT_EQ(Pick(handles, {.cone_tangent = 0.1f})->handle, 1);
}

TEST_F(HandlePick, NotFinite_NeverPicked) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Vector<Vec3> handles = {{1, nan, 1}, {1, 0, -infinity}, {1.05f, 0, 0.4f}};
  EXPECT_EQ(Pick(handles, {.radius = 0.1f, .occlusion = false})->handle, 2);
  ray_.direction = {0, 0, nan};
  EXPECT_FALSE(Pick(handles, {.radius = 0.1f}));
}

}  // namespace
}  // namespace limber
