#include "pick/picker.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <limits>
#include <random>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "pick_scene.h"
#include "support/counting_allocator.h"

namespace limber {
namespace {

using test::BruteForce;
using test::BruteHit;
using test::FromEigen;
using test::RandomRay;
using test::ToEigen;
using test::TorusScene;
using test::Vec3d;

Picker MakePicker(const SkinMesh& mesh, std::span<const Vec3> positions) {
  Result<Picker> picker = Picker::Create(mesh, positions);
  EXPECT_TRUE(picker.ok()) << picker.status().message();
  return std::move(picker).value();
}

void ExpectSameHit(const std::optional<SurfaceHit>& a, const std::optional<SurfaceHit>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->triangle, b->triangle);
  EXPECT_EQ(a->distance, b->distance);
  EXPECT_EQ(a->barycentrics, b->barycentrics);
  EXPECT_EQ(a->point, b->point);
}

TEST(Picker, Create_BadMesh_OneClearLine) {
  TorusScene scene(6, 5);
  SkinMesh mesh = scene.mesh;
  mesh.triangles.clear();
  EXPECT_EQ(Picker::Create(mesh, scene.rest).status().code(), StatusCode::kDegenerate);
  mesh = scene.mesh;
  mesh.triangles[7] = mesh.num_draw_vertices;
  const Status wrong_index = Picker::Create(mesh, scene.rest).status();
  EXPECT_EQ(wrong_index.code(), StatusCode::kMalformed);
  EXPECT_NE(wrong_index.message().find("triangle 2: corner 1"), std::string::npos);
  mesh = scene.mesh;
  mesh.solve_vertex[3] = mesh.num_solve_vertices;
  EXPECT_EQ(Picker::Create(mesh, scene.rest).status().code(), StatusCode::kMalformed);
  scene.rest.pop_back();
  EXPECT_EQ(Picker::Create(scene.mesh, scene.rest).status().code(), StatusCode::kInvalidArgument);
}

TEST(Picker, PickSurface_RandomRays_AgreesWithEveryTriangleTried) {
  const TorusScene scene(31, 17);
  const Vector<Vec3> points = scene.Deformed(1.1);
  Picker picker = MakePicker(scene.mesh, scene.rest);
  ASSERT_TRUE(picker.Update(points).ok());
  std::mt19937 random(1);
  int hits = 0, misses = 0;
  for (int i = 0; i < 3000; ++i) {
    const PickRay ray = RandomRay(&random);
    // Where single precision could go either way (grazing an edge), either answer will do.
    const std::optional<BruteHit> wide = BruteForce(scene.mesh, points, ray, 1e-4);
    const std::optional<BruteHit> tight = BruteForce(scene.mesh, points, ray, -1e-4);
    const std::optional<SurfaceHit> hit = picker.PickSurface(ray);
    if (!wide) {
      EXPECT_FALSE(hit) << "ray " << i;
      ++misses;
    } else if (tight && std::abs(tight->distance - wide->distance) < 1e-9) {
      ASSERT_TRUE(hit) << "ray " << i;
      EXPECT_EQ(hit->triangle, tight->triangle) << "ray " << i;
      EXPECT_NEAR(hit->distance, tight->distance, 2e-6) << "ray " << i;
      ++hits;
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 500);
}

TEST(Picker, PickSurface_Hit_BarycentricsNormalAndPointAgree) {
  const TorusScene scene(24, 14);
  const Vector<Vec3> points = scene.Deformed(0.7);
  const Picker picker = MakePicker(scene.mesh, points);
  std::mt19937 random(2);
  int front = 0, back = 0;
  for (int i = 0; i < 1000; ++i) {
    PickRay ray = RandomRay(&random);
    ray.near_distance = i % 2 == 0 ? 0.0f : 4.0f;  // half of the rays begin within the character
    const std::optional<SurfaceHit> hit = picker.PickSurface(ray);
    if (!hit) continue;
    Vec3d mixed = Vec3d::Zero();
    float sum = 0;
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_GE(hit->barycentrics[c], 0);
      EXPECT_EQ(hit->solve_vertices[c],
                scene.mesh.solve_vertex[scene.mesh.triangles[3 * hit->triangle + c]]);
      mixed += hit->barycentrics[c] * ToEigen(points[hit->solve_vertices[c]]);
      sum += hit->barycentrics[c];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    const Vec3d direction = ToEigen(ray.direction).normalized();
    const Vec3d along = ToEigen(ray.origin) + hit->distance * direction;
    EXPECT_LT((mixed - ToEigen(hit->point)).norm(), 1e-6);
    EXPECT_LT((along - ToEigen(hit->point)).norm(), 2e-6);
    EXPECT_GE(hit->distance, ray.near_distance * (1 - 1e-6));
    EXPECT_NEAR(ToEigen(hit->normal).norm(), 1, 1e-6);
    const Vec3d a = ToEigen(points[hit->solve_vertices[0]]);
    const Vec3d normal = (ToEigen(points[hit->solve_vertices[1]]) - a)
                             .cross(ToEigen(points[hit->solve_vertices[2]]) - a)
                             .normalized();
    EXPECT_GT(normal.dot(ToEigen(hit->normal)), 1 - 1e-6);
    EXPECT_EQ(hit->front_facing, normal.dot(direction) < 0);
    ++(hit->front_facing ? front : back);
  }
  EXPECT_GT(front, 200);
  EXPECT_GT(back, 50);
}

TEST(Picker, PickSurface_AnyLengthOfDirection_SameHit) {
  const TorusScene scene(20, 12);
  const Picker picker = MakePicker(scene.mesh, scene.rest);
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    PickRay ray = RandomRay(&random);
    const std::optional<SurfaceHit> hit = picker.PickSurface(ray);
    ray.direction = FromEigen(1024 * ToEigen(ray.direction));
    ExpectSameHit(hit, picker.PickSurface(ray));
  }
}

TEST(Picker, Update_Refit_EqualsRebuild) {
  const TorusScene scene(26, 15);
  Picker refitted = MakePicker(scene.mesh, scene.rest);
  std::mt19937 random(4);
  for (const double amount : {0.3, 1.5, -0.8, 0.0}) {
    const Vector<Vec3> points = scene.Deformed(amount);
    ASSERT_TRUE(refitted.Update(points).ok());
    const Picker rebuilt = MakePicker(scene.mesh, points);
    EXPECT_EQ(refitted.diagonal(), rebuilt.diagonal());
    for (int i = 0; i < 1000; ++i) {
      const PickRay ray = RandomRay(&random);
      ExpectSameHit(refitted.PickSurface(ray), rebuilt.PickSurface(ray));
    }
  }
}

TEST(Picker, PickSurface_RaysThroughSharedVerticesAndEdges_NeverSlipThrough) {
  const TorusScene scene(33, 19);
  const Picker picker = MakePicker(scene.mesh, scene.rest);
  for (uint32_t t = 0; t < scene.mesh.num_triangles(); ++t) {
    const auto corner = [&](uint32_t i) {
      return ToEigen(scene.rest[scene.mesh.solve_vertex[scene.mesh.triangles[3 * t + i]]]);
    };
    for (uint32_t i = 0; i < 3; ++i) {
      for (const double along : {0.0, 0.5, 0.37}) {
        // From the torus' own normal all triangles about the target are seen from outside, so that
        // a miss is a crack.
        const Vec3d target = (1 - along) * corner(i) + along * corner((i + 1) % 3);
        const Vec3d normal = (target - Vec3d(target.x(), target.y(), 0).normalized()).normalized();
        PickRay ray;
        ray.origin = FromEigen(target + 0.3 * normal);
        ray.direction = FromEigen(-normal);
        const std::optional<SurfaceHit> hit = picker.PickSurface(ray);
        ASSERT_TRUE(hit) << "triangle " << t << " edge " << i;
        EXPECT_LT((ToEigen(hit->point) - target).norm(), 1e-5) << "triangle " << t;
      }
    }
  }
}

TEST(Picker, PickSurface_CoincidentLayers_LowestTriangle) {
  // The same quad three times; a refit and a rebuild may meet the layers in any order.
  SkinMesh mesh;
  mesh.num_solve_vertices = 4;
  mesh.num_draw_vertices = 4;
  mesh.solve_vertex = {0, 1, 2, 3};
  for (int layer = 0; layer < 3; ++layer) {
    mesh.triangles.insert(mesh.triangles.end(), {0, 1, 2, 0, 2, 3});
  }
  const Vector<Vec3> quad = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Picker picker = MakePicker(mesh, quad);
  PickRay ray;
  ray.direction = {0, 0, -1};
  ray.origin = {0.7f, 0.2f, 5};
  EXPECT_EQ(picker.PickSurface(ray)->triangle, 0u);
  ray.origin = {0.2f, 0.7f, 5};
  EXPECT_EQ(picker.PickSurface(ray)->triangle, 1u);
  ray.origin = {0.5f, 0.5f, 5};  // on the diagonal: all six are hit
  EXPECT_EQ(picker.PickSurface(ray)->triangle, 0u);
}

TEST(Picker, PickSurface_DegenerateTriangles_AreNeverHit) {
  SkinMesh mesh;
  mesh.num_solve_vertices = 4;
  mesh.num_draw_vertices = 4;
  mesh.solve_vertex = {0, 1, 2, 3};
  mesh.triangles = {0, 0, 0, 0, 1, 1, 0, 1, 3, 0, 1, 2};  // a point, a line, a sliver, a triangle
  const Vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0, 0}};
  const Picker picker = MakePicker(mesh, points);
  PickRay ray;
  ray.origin = {0.25f, 0, 1};
  const std::optional<SurfaceHit> on_the_line = picker.PickSurface(ray);
  ASSERT_TRUE(on_the_line);
  EXPECT_EQ(on_the_line->triangle, 3u);
  ray.origin = {0.25f, -0.1f, 1};
  EXPECT_FALSE(picker.PickSurface(ray));
}

TEST(Picker, PickSurface_FarOrNonsenseRays_Miss) {
  const TorusScene scene(20, 12);
  const Picker picker = MakePicker(scene.mesh, scene.rest);
  PickRay ray;
  ray.origin = {1, 0, 5};
  ASSERT_TRUE(picker.PickSurface(ray));
  ray.far_distance = 3;
  EXPECT_FALSE(picker.PickSurface(ray));
  ray.far_distance = std::numeric_limits<float>::infinity();
  ray.direction = {0, 0, 1};
  EXPECT_FALSE(picker.PickSurface(ray));
  ray.direction = {0, 0, 0};
  EXPECT_FALSE(picker.PickSurface(ray));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ray.direction = {0, nan, -1};
  EXPECT_FALSE(picker.PickSurface(ray));
  ray.direction = {0, 0, -1};
  ray.origin = {nan, 0, 5};
  EXPECT_FALSE(picker.PickSurface(ray));
  ray.origin = {1, 0, 5};
  ray.near_distance = nan;
  EXPECT_FALSE(picker.PickSurface(ray));
}

TEST(Picker, Update_BadPositions_RefusedAndLastGoodSurfaceStays) {
  const TorusScene scene(20, 12);
  const Vector<Vec3> good = scene.Deformed(0.5);
  Picker picker = MakePicker(scene.mesh, scene.rest);
  ASSERT_TRUE(picker.Update(good).ok());
  Vector<std::optional<SurfaceHit>> before;
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i)
    before.push_back(picker.PickSurface(RandomRay(&random)));

  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity, 2e18f}) {
    Vector<Vec3> points = scene.Deformed(-1.0);
    points[17].y = bad;
    const Status status = picker.Update(points);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_NE(status.message().find("position 17"), std::string::npos) << status.message();
  }
  EXPECT_EQ(picker.Update(std::span(good).first(5)).code(), StatusCode::kInvalidArgument);

  std::mt19937 again(5);
  for (const std::optional<SurfaceHit>& hit : before) {
    ExpectSameHit(hit, picker.PickSurface(RandomRay(&again)));
  }
}

TEST(Picker, Moved_StillPicks) {
  const TorusScene scene(20, 12);
  Picker first = MakePicker(scene.mesh, scene.rest);
  Picker picker = std::move(first);
  ASSERT_TRUE(picker.Update(scene.Deformed(0.2)).ok());
  PickRay ray;
  ray.origin = {1, 0, 5};
  EXPECT_TRUE(picker.PickSurface(ray));
}

TEST(Picker, Picks_AllocateNothing) {
  const TorusScene scene(60, 40);
  const Picker picker = MakePicker(scene.mesh, scene.rest);
  std::mt19937 random(6);
  HandlePickOptions options;
  options.cone_tangent = 0.5f;
  const int64_t before = test::AllocationCount();
  int hits = 0;
  for (int i = 0; i < 50; ++i) {
    const PickRay ray = RandomRay(&random);
    hits += picker.PickSurface(ray).has_value();
    hits += picker.PickHandle(ray, scene.rest, options).has_value();
  }
  const int64_t after = test::AllocationCount();
  EXPECT_EQ(after, before);
  EXPECT_GT(hits, 60);
}

int64_t AllocationsOfTenUpdates(const TorusScene& scene) {
  const Vector<Vec3> bent = scene.Deformed(0.9);
  Picker picker = MakePicker(scene.mesh, scene.rest);
  EXPECT_TRUE(picker.Update(bent).ok());
  const int64_t before = test::AllocationCount();
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(picker.Update(i % 2 == 0 ? scene.rest : bent).ok());
  }
  return test::AllocationCount() - before;
}

TEST(Picker, Update_RefitsInPlace_OneAllocationOfEmbreesWhateverTheSize) {
  // A rebuild would allocate nodes by the number of triangles; a refit may not.
  EXPECT_LE(AllocationsOfTenUpdates(TorusScene(12, 8)), 10);
  EXPECT_LE(AllocationsOfTenUpdates(TorusScene(120, 80)), 10);
}

#if defined(__SSE__)
// Rounding, masks, flush to zero; without the sticky flags, which any division sets.
unsigned int ControlBits() {
  return _mm_getcsr() & ~static_cast<unsigned int>(_MM_EXCEPT_MASK);
}

// Runs everything that calls Embree under an unusual control word and looks at it afterwards.
void ExpectControlWordKept(unsigned int control_word) {
  const TorusScene scene(20, 12);
  const unsigned int saved = _mm_getcsr();
  _mm_setcsr(control_word);
  {
    Result<Picker> picker = Picker::Create(scene.mesh, scene.rest);
    EXPECT_EQ(ControlBits(), control_word) << "after Create";
    (void)picker->Update(scene.rest);
    EXPECT_EQ(ControlBits(), control_word) << "after Update";
    PickRay ray;
    ray.origin = {1, 0, 5};
    (void)picker->PickSurface(ray);
    EXPECT_EQ(ControlBits(), control_word) << "after PickSurface";
    (void)picker->PickHandle(ray, scene.rest, {.radius = 1});
    EXPECT_EQ(ControlBits(), control_word) << "after PickHandle";
  }
  EXPECT_EQ(ControlBits(), control_word) << "after the end";
  _mm_setcsr(saved);
}

TEST(Picker, FloatingPointControlWord_Kept) {
  constexpr unsigned int kAllMasked = 0x1f80, kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  ExpectControlWordKept(kAllMasked);
  ExpectControlWordKept(kAllMasked | kFlushToZero | kDenormalsAreZero);
  ExpectControlWordKept(kAllMasked | _MM_ROUND_UP);
  ExpectControlWordKept(kAllMasked & ~static_cast<unsigned int>(_MM_MASK_DIV_ZERO));
}
#endif

TEST(Picker, UnmaskedExceptions_DoNotTrapInside) {
  const TorusScene scene(20, 12);
  std::fenv_t saved;
  ASSERT_EQ(std::fegetenv(&saved), 0);
  Picker picker = MakePicker(scene.mesh, scene.rest);
  PickRay ray;
  ray.origin = {1, 0, 5};  // two components of the direction are zero: Embree divides by them
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  const bool hit = picker.PickSurface(ray).has_value();
  const bool updated = picker.Update(scene.rest).ok();
  std::fesetenv(&saved);
  EXPECT_TRUE(hit);
  EXPECT_TRUE(updated);
}

}  // namespace
}  // namespace limber
