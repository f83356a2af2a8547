#include "ray/nearest_hit.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace limber {
namespace {

// Three triangles one behind the other, seen along -z: at z = 1, 0 and -1, each larger.
class NearestHitLayers : public testing::Test {
 protected:
  NearestHitLayers() {
    for (const float z : {0.0f, 1.0f, -1.0f}) {
      const float size = 3 - z;
      for (const Vec3 p : {Vec3{0, 0, z}, Vec3{size, 0, z}, Vec3{0, size, z}}) {
        triangles_.push_back(static_cast<uint32_t>(positions_.size()));
        positions_.push_back(p);
      }
    }
  }

  std::optional<NearestHit> Find(Vec3 origin, Vec3 direction, EqualHits equal = EqualHits::kFirst) {
    return finder_.Find(positions_, triangles_, origin, direction, equal);
  }

  Vector<Vec3> positions_;
  Vector<uint32_t> triangles_;
  NearestHitFinder finder_;
};

TEST_F(NearestHitLayers, Nearest_WinsFromEitherSide) {
  const auto from_above = Find({0.5f, 0.5f, 5}, {0, 0, -10});
  ASSERT_TRUE(from_above);
  EXPECT_EQ(from_above->triangle, 1u);
  EXPECT_DOUBLE_EQ(from_above->at.distance, 4);
  EXPECT_TRUE(from_above->at.front_facing);
  EXPECT_NEAR(from_above->at.barycentrics[1], 0.25, 1e-7);
  const auto from_below = Find({0.5f, 0.5f, -5}, {0, 0, 0.1f});
  ASSERT_TRUE(from_below);
  EXPECT_EQ(from_below->triangle, 2u);
  EXPECT_FALSE(from_below->at.front_facing);
}

TEST_F(NearestHitLayers, BehindAndBeside_AreNotMet) {
  EXPECT_EQ(Find({0.5f, 0.5f, 0.5f}, {0, 0, -1})->triangle, 0u) << "z = 1 lies behind";
  EXPECT_EQ(Find({2.2f, 0.1f, 5}, {0, 0, -1})->triangle, 0u) << "beside the smallest";
  EXPECT_FALSE(Find({0.5f, 0.5f, 5}, {0, 0, 1}));
  EXPECT_FALSE(Find({-0.01f, 0.5f, 5}, {0, 0, -1}));
  EXPECT_FALSE(Find({0.5f, 0.5f, 5}, {1, 0, 0})) << "along the layers";
}

TEST_F(NearestHitLayers, EqualDistances_FirstOrLast) {
  for (Vec3& p : positions_)
    p.z = 0;
  EXPECT_EQ(Find({0.5f, 0.5f, 5}, {0, 0, -1}, EqualHits::kFirst)->triangle, 0u);
  EXPECT_EQ(Find({0.5f, 0.5f, 5}, {0, 0, -1}, EqualHits::kLast)->triangle, 2u);
  // A clearly nearer one counts wherever it stands.
  for (size_t i = 3; i < 6; ++i)
    positions_[i].z = 0.01f;
  EXPECT_EQ(Find({0.5f, 0.5f, 5}, {0, 0, -1}, EqualHits::kFirst)->triangle, 1u);
  EXPECT_EQ(Find({0.5f, 0.5f, 5}, {0, 0, -1}, EqualHits::kLast)->triangle, 1u);
}

TEST_F(NearestHitLayers, WithoutArea_NothingIsMet) {
  positions_.assign(9, {1, 1, 0});
  EXPECT_FALSE(Find({1, 1, 5}, {0, 0, -1}));
  positions_[0] = {0, 0, 0};  // a line
  EXPECT_FALSE(Find({0.5f, 0.5f, 5}, {0, 0, -1}));
  triangles_.clear();
  EXPECT_FALSE(Find({0.5f, 0.5f, 5}, {0, 0, -1}));
}

// A bumpy disc of triangles: every ray through its inside meets one, through vertices and edges
// too.
TEST(NearestHit, SharedEdges_LeaveNoGap) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(-0.1f, 0.1f);
  constexpr int kSide = 20;
  Vector<Vec3> positions;
  Vector<uint32_t> triangles;
  for (int i = 0; i <= kSide; ++i) {
    for (int j = 0; j <= kSide; ++j)
      positions.push_back({float(i) / kSide, float(j) / kSide, noise(random)});
  }
  for (uint32_t i = 0; i < kSide; ++i) {
    for (uint32_t j = 0; j < kSide; ++j) {
      const uint32_t a = i * (kSide + 1) + j, b = a + kSide + 1;
      triangles.insert(triangles.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  const auto inside = [](Vec3 p) { return p.x > 0.2f && p.x < 0.8f && p.y > 0.2f && p.y < 0.8f; };
  NearestHitFinder finder;
  int num_rays = 0;
  for (const Vec3 eye : {Vec3{0.5f, 0.5f, 3}, Vec3{0.4f, 0.9f, 2}}) {
    for (size_t t = 0; t < triangles.size(); t += 3) {
      const Vec3 a = positions[triangles[t]], b = positions[triangles[t + 1]];
      for (const float share : {0.0f, 0.5f, 0.3f}) {
        const Vec3 aim = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
                          a.z + share * (b.z - a.z)};
        if (!inside(aim)) continue;
        ++num_rays;
        const Vec3 along = {aim.x - eye.x, aim.y - eye.y, aim.z - eye.z};
        const auto hit = finder.Find(positions, triangles, eye, along, EqualHits::kFirst);
        ASSERT_TRUE(hit) << aim.x << " " << aim.y;
        // No further than what it was aimed at, and on the ray. A triangle that is seen nearly
        // edge-on magnifies the rounding of the aim.
        const double length = Length(ToDouble(along));
        EXPECT_LT(hit->at.distance, length * (1 + 1e-4));
        const Double3 on_ray = ToDouble(eye) + (hit->at.distance / length) * ToDouble(along);
        EXPECT_LT(Length(hit->at.point - on_ray), 1e-6);
        EXPECT_NEAR(std::accumulate(hit->at.barycentrics.begin(), hit->at.barycentrics.end(), 0.0),
                    1, 1e-12);
      }
    }
  }
  EXPECT_GT(num_rays, 1000);
}

}  // namespace
}  // namespace limber
