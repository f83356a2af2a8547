// limber.h: rays, and the parts of a skin.
#include "capi_fixture.h"
#include "core/vector.h"
#include "support/counting_allocator.h"

#include <cmath>

namespace limber::test {
namespace {

class CapiPick : public CapiTest {
 protected:
  Vector<float> Positions() {
    Vector<float> positions(size_t{info_.num_vertices} * 3);
    LimberSkinDef def = limberDefaultSkinDef();
    def.num_vertices = info_.num_vertices;
    def.positions.data = positions.data();
    EXPECT_EQ(limberSkin(context_, instance_, &def), LIMBER_SUCCESS) << Message();
    return positions;
  }

  void Bend() {
    int32_t right = 0;
    ASSERT_EQ(limberFindHandle(context_, rig_, "right", &right), LIMBER_SUCCESS);
    LimberHandleState state;
    ASSERT_EQ(limberGetHandle(context_, instance_, right, &state), LIMBER_SUCCESS);
    state.target[1] += 0.3f * info_.diagonal;
    ASSERT_EQ(limberSetTarget(context_, instance_, right, state.target), LIMBER_SUCCESS);
    LimberSolveDef solve = limberDefaultSolveDef();
    solve.iterations = 20;
    ASSERT_EQ(limberSolve(context_, instance_, &solve, nullptr), LIMBER_SUCCESS);
  }
};

TEST_F(CapiPick, FromFarAway_EveryVisibleTriangleIsFoundWhereTheSkinIs) {
  Bend();
  const Vector<float> positions = Positions();
  int num_own = 0;
  for (uint32_t t = 0; t < info_.num_triangles; ++t) {
    float centre[3] = {0, 0, 0}, origin[3], direction[3] = {0.3f, -0.5f, -1};
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis)
        centre[axis] += positions[3 * size_t{info_.triangles[3 * t + corner]} + axis] / 3;
    }
    for (int axis = 0; axis < 3; ++axis)
      origin[axis] = centre[axis] - 3 * info_.diagonal * direction[axis];
    LimberPickHit hit;
    ASSERT_EQ(limberPick(context_, instance_, origin, direction, &hit), LIMBER_SUCCESS);
    ASSERT_EQ(hit.found, 1) << t;
    const float to_centre = 3 * info_.diagonal * std::sqrt(0.09f + 0.25f + 1);
    // Itself, or something nearer; seen nearly edge-on, it magnifies the rounding of the aim.
    EXPECT_LT(hit.distance, to_centre * (1 + 1e-4f));
    if (hit.triangle == t) ++num_own;
    // The place on the skin, asked of the pose, is where the ray met the triangle.
    float place[3];
    ASSERT_EQ(limberGetPlace(context_, instance_, &hit.point, place), LIMBER_SUCCESS) << Message();
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(place[axis], hit.position[axis], 1e-5 * info_.diagonal);
    const float facing =
        hit.normal[0] * direction[0] + hit.normal[1] * direction[1] + hit.normal[2] * direction[2];
    EXPECT_EQ(hit.front_facing, facing < 0 ? 1 : 0);
  }
  EXPECT_GT(num_own, static_cast<int>(info_.num_triangles) / 4);
}

TEST_F(CapiPick, WhatIsPicked_CanBeDragged) {
  const Vector<float> positions = Positions();
  const uint32_t v = info_.triangles[0];
  const float* p = &positions[size_t{v} * 3];
  const float origin[3] = {p[0], p[1], p[2] + 10 * info_.diagonal}, down[3] = {0, 0, -2};
  LimberPickHit hit;
  ASSERT_EQ(limberPick(context_, instance_, origin, down, &hit), LIMBER_SUCCESS);
  ASSERT_EQ(hit.found, 1);
  int32_t grab = 0;
  ASSERT_EQ(limberGrab(context_, instance_, &hit.point, LIMBER_HELD_EXACTLY, &grab), LIMBER_SUCCESS)
      << Message();
  const float target[3] = {hit.position[0], hit.position[1] + 0.05f * info_.diagonal,
                           hit.position[2]};
  ASSERT_EQ(limberSetGrabTarget(context_, instance_, grab, target), LIMBER_SUCCESS);
  ASSERT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS);
  float place[3];
  ASSERT_EQ(limberGetPlace(context_, instance_, &hit.point, place), LIMBER_SUCCESS);
  EXPECT_NEAR(place[1], target[1], 1e-4 * info_.diagonal);
}

TEST_F(CapiPick, ARayBeside_FindsNothing) {
  const float origin[3] = {1000, 1000, 1000}, direction[3] = {0, 0, 1};
  LimberPickHit hit;
  std::memset(&hit, 0xff, sizeof hit);
  ASSERT_EQ(limberPick(context_, instance_, origin, direction, &hit), LIMBER_SUCCESS);
  EXPECT_EQ(hit.found, 0);
  EXPECT_EQ(hit.distance, 0);
  const int64_t before = AllocationCount();
  ASSERT_EQ(limberPick(context_, instance_, origin, direction, &hit), LIMBER_SUCCESS);
  EXPECT_EQ(AllocationCount(), before) << "the second pick needs no memory";
}

TEST_F(CapiPick, Misuse_IsRefused) {
  const float origin[3] = {0, 0, 5}, direction[3] = {0, 0, -1}, zero[3] = {0, 0, 0};
  const float wrong[3] = {0, NAN, 0};
  LimberPickHit hit;
  const auto pick = [&](const float* from, const float* along, LimberPickHit* to) {
    return limberPick(context_, instance_, from, along, to);
  };
  EXPECT_EQ(pick(nullptr, direction, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(pick(origin, nullptr, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(pick(origin, direction, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(pick(wrong, direction, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(pick(origin, wrong, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(pick(origin, zero, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(Message(), "limberPick: direction: of length zero");
  EXPECT_EQ(limberPick(context_, {99, 1}, origin, direction, &hit), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(limberPick(nullptr, instance_, origin, direction, &hit), LIMBER_ERROR_INVALID_ARGUMENT);
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.skin = 0;
  LimberInstanceId blind;
  ASSERT_EQ(limberCreateInstance(context_, rig_, &def, &blind), LIMBER_SUCCESS);
  EXPECT_EQ(limberPick(context_, blind, origin, direction, &hit), LIMBER_ERROR_UNSUPPORTED);
}

TEST_F(CapiPick, Primitives_CoverTheSkin) {
  int32_t count = 0;
  ASSERT_EQ(limberGetNumPrimitives(context_, rig_, &count), LIMBER_SUCCESS);
  ASSERT_GT(count, 0);
  uint32_t next_vertex = 0, next_triangle = 0;
  for (int32_t i = 0; i < count; ++i) {
    LimberPrimitiveInfo part;
    ASSERT_EQ(limberGetPrimitiveInfo(context_, rig_, i, &part), LIMBER_SUCCESS);
    EXPECT_EQ(part.first_vertex, next_vertex);
    EXPECT_EQ(part.first_triangle, next_triangle);
    EXPECT_GE(part.gltf_material, -1);
    next_vertex += part.num_vertices;
    next_triangle += part.num_triangles;
  }
  EXPECT_EQ(next_vertex, info_.num_vertices);
  EXPECT_EQ(next_triangle, info_.num_triangles);
  LimberPrimitiveInfo part;
  EXPECT_EQ(limberGetPrimitiveInfo(context_, rig_, count, &part), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(limberGetPrimitiveInfo(context_, rig_, -1, &part), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(limberGetPrimitiveInfo(context_, rig_, 0, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(limberGetNumPrimitives(context_, rig_, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace limber::test
