// Two independent ways to the first triangle of a ray: every one looked at, and Embree.
#include "core/vector.h"
#include "pick/picker.h"
#include "pick_scene.h"
#include "ray/nearest_hit.h"

#include <gtest/gtest.h>

#include <random>

namespace limber {
namespace {

TEST(NearestHitAndPicker, Agree) {
  const test::TorusScene scene(60, 40);
  const Vector<Vec3> solve_positions = scene.Deformed(0.7);
  const Result<Picker> picker = Picker::Create(scene.mesh, solve_positions);
  ASSERT_TRUE(picker.ok());
  Vector<Vec3> positions;
  for (const uint32_t v : scene.mesh.solve_vertex)
    positions.push_back(solve_positions[v]);
  NearestHitFinder finder;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> in_box(-2, 2);
  int num_hits = 0;
  for (int i = 0; i < 2000; ++i) {
    PickRay ray;
    ray.origin = {in_box(random), in_box(random), in_box(random)};
    ray.direction = {in_box(random), in_box(random), in_box(random)};
    const auto expected = picker->PickSurface(ray);
    const auto found =
        finder.Find(positions, scene.mesh.triangles, ray.origin, ray.direction, EqualHits::kFirst);
    ASSERT_EQ(found.has_value(), expected.has_value()) << "ray " << i;
    if (!found) continue;
    ++num_hits;
    EXPECT_NEAR(found->at.distance, expected->distance, 1e-5);
    EXPECT_EQ(found->triangle, expected->triangle);
    EXPECT_EQ(found->at.front_facing, expected->front_facing);
  }
  EXPECT_GT(num_hits, 300);
}

}  // namespace
}  // namespace limber
