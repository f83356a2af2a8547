#include "skin/skin_positions.h"

#include "core/vector.h"
#include "runtime/skin/skin_fixtures.h"
#include "skin/cpu_skinner.h"
#include "support/counting_allocator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace limber {
namespace {

// Eq. 6 written once more, handle by handle, in double: mesh-space point of vertex v.
std::array<double, 3> Naive(const test::SkinFixture& fixture, const test::SkinPose& pose,
                            size_t v) {
  const SkinMesh& mesh = fixture.mesh;
  std::array<double, 3> q = {pose.origin.x, pose.origin.y, pose.origin.z};
  for (int h = 0; h < mesh.num_handles; ++h) {
    for (int s = 0; s < mesh.num_shapes; ++s) {
      const size_t block = static_cast<size_t>(h * mesh.num_shapes + s) * 12;
      const Vec3 p = mesh.shape_positions[static_cast<size_t>(s) * mesh.num_solve_vertices + v];
      const double w =
          mesh.weights[v * static_cast<size_t>(mesh.num_handles) + static_cast<size_t>(h)];
      const double point[4] = {p.x, p.y, p.z, 1};
      for (size_t row = 0; row < 3; ++row) {
        for (size_t c = 0; c < 4; ++c)
          q[row] += w * pose.matrices[block + row * 4 + c] * point[c];
      }
    }
  }
  return q;
}

double LargestError(const test::SkinFixture& fixture, const test::SkinPose& pose,
                    const Vector<Vec3>& found) {
  double largest = 0;
  for (size_t v = 0; v < found.size(); ++v) {
    const std::array<double, 3> q = Naive(fixture, pose, v);
    for (int axis = 0; axis < 3; ++axis) {
      largest = std::max(largest, std::abs(q[static_cast<size_t>(axis)] - double{found[v][axis]}));
    }
  }
  return largest;
}

TEST(SkinPositions, EveryPose_EqualsTheSumInDouble) {
  // 7 around, 11 along: 86 vertices, no multiple of eight.
  const test::SkinFixture fixture = test::MakeCylinderFixture(7, 11);
  const SkinLayout layout(fixture.mesh);
  SkinScratch scratch;
  Vector<Vec3> fast(fixture.mesh.num_solve_vertices), reference(fast.size());
  for (const double amount : {0.0, 0.3, 1.0, 2.5}) {
    const test::SkinPose pose = test::CylinderPose(fixture, amount);
    ASSERT_TRUE(SkinPositions(layout, pose.view(), &scratch, fast).ok());
    ASSERT_TRUE(SkinPositionsReference(fixture.mesh, pose.view(), reference).ok());
    EXPECT_LT(LargestError(fixture, pose, fast), 1e-6 * test::FixtureSize(fixture));
    EXPECT_LT(LargestError(fixture, pose, reference), 2e-7 * test::FixtureSize(fixture));
  }
}

TEST(SkinPositions, RestPose_IsTheExampleShape) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(12, 8);
  const SkinLayout layout(fixture.mesh);
  SkinScratch scratch;
  Vector<Vec3> out(fixture.mesh.num_solve_vertices);
  ASSERT_TRUE(SkinPositions(layout, test::RestPose(fixture, 0).view(), &scratch, out).ok());
  // The cylinder of mesh space: radius 0.25 around the y axis, height 0 to 2.
  for (size_t v = 0; v + 2 < out.size(); ++v) {
    EXPECT_NEAR(std::hypot(out[v].x, out[v].z), 0.25, 1e-6);
  }
  EXPECT_NEAR(out.back().y, 2, 1e-6);
}

TEST(SkinPositions, WrongSizes_AreRefused) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(7, 5);
  const SkinLayout layout(fixture.mesh);
  SkinScratch scratch;
  test::SkinPose pose = test::RestPose(fixture);
  Vector<Vec3> out(fixture.mesh.num_solve_vertices - 1);
  EXPECT_EQ(SkinPositions(layout, pose.view(), &scratch, out).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(SkinPositionsReference(fixture.mesh, pose.view(), out).code(),
            StatusCode::kInvalidArgument);
  out.emplace_back();
  pose.matrices.pop_back();
  EXPECT_EQ(SkinPositions(layout, pose.view(), &scratch, out).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(SkinPositionsReference(fixture.mesh, pose.view(), out).code(),
            StatusCode::kInvalidArgument);
}

TEST(CpuSkinner, SkinningAFrame_AllocatesNothing) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(16, 9);
  Result<CpuSkinner> skinner = CpuSkinner::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(skinner.ok());
  auto surface = SkinSurface::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(surface.ok());
  Result<CpuSkinner> lean = CpuSkinner::CreateWithoutResults(*surface);
  ASSERT_TRUE(lean.ok());
  Vector<Vec3> normals(fixture.mesh.num_draw_vertices);
  SkinOutputs outputs;
  outputs.normals = {normals.data(), sizeof(Vec3)};
  const test::SkinPose pose = test::RestPose(fixture);
  const int64_t before = test::AllocationCount();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(lean->SkinInto(pose.view(), outputs).ok());
    ASSERT_TRUE(skinner->Skin(pose.view()).ok());
    ASSERT_TRUE(skinner->SkinPositionsOnly(pose.view()).ok());
  }
  const int64_t during = test::AllocationCount() - before;
  EXPECT_EQ(during, 0);
  // The counter does count.
  const Vector<int> counted(100);
  EXPECT_GT(test::AllocationCount(), before) << counted.size();
}

TEST(CpuSkinner, SeamVertices_AreBitwiseEqual) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(21, 10);
  Result<CpuSkinner> skinner = CpuSkinner::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(skinner.ok());
  const test::Affine turn = test::RotationAffine({1, 2, 0}, 0.8, {0.3, 0, 0});
  const test::Affine stay = test::RotationAffine({1, 0, 0}, 0, {0, 0, 0});
  ASSERT_TRUE(skinner->Skin(test::MakePose(fixture, {1, 1.3f}, {stay, turn}).view()).ok());
  const DeformedMesh result = skinner->result();
  int shared = 0;
  for (size_t a = 0; a < result.positions.size(); ++a) {
    for (size_t b = a + 1; b < result.positions.size(); ++b) {
      if (fixture.mesh.solve_vertex[a] != fixture.mesh.solve_vertex[b]) continue;
      ++shared;
      EXPECT_EQ(std::memcmp(&result.positions[a], &result.positions[b], sizeof(Vec3)), 0);
      EXPECT_EQ(std::memcmp(&result.normals[a], &result.normals[b], sizeof(Vec3)), 0);
    }
  }
  EXPECT_GE(shared, 9);  // the seam's inner rows at least
}

}  // namespace
}  // namespace limber
