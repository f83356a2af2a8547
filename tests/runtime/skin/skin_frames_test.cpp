#include "skin/skin_frames.h"

#include "core/vector.h"
#include "runtime/skin/skin_fixtures.h"
#include "skin/cpu_skinner.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>

namespace limber {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d Wide(Vec3 v) {
  return {v.x, v.y, v.z};
}

CpuSkinner MakeSkinner(const test::SkinFixture& fixture) {
  Result<CpuSkinner> skinner = CpuSkinner::Create(fixture.mesh, fixture.space);
  EXPECT_TRUE(skinner.ok()) << skinner.status().message();
  return std::move(*skinner);
}

// Turns authored normals away from the surface, as a modeller's smoothing may.
void TiltNormals(SkinMesh* mesh) {
  for (size_t d = 0; d < mesh->rest_normals.size(); ++d) {
    const double phase = 0.37 * mesh->solve_vertex[d];
    const Vector3d tilted = (Wide(mesh->rest_normals[d]) +
                             0.3 * Vector3d(std::sin(phase), std::cos(phase), std::sin(2 * phase)))
                                .normalized();
    mesh->rest_normals[d] = {static_cast<float>(tilted.x()), static_cast<float>(tilted.y()),
                             static_cast<float>(tilted.z())};
  }
}

test::SkinPose UniformPose(const test::SkinFixture& fixture, const test::Affine& map) {
  const auto num_handles = static_cast<size_t>(fixture.mesh.num_handles);
  const auto num_shapes = static_cast<size_t>(fixture.mesh.num_shapes);
  Vector<float> blend(num_handles * num_shapes, 0.0f);
  for (size_t h = 0; h < num_handles; ++h)
    blend[h * num_shapes] = 1;
  return test::MakePose(fixture, blend, Vector<test::Affine>(num_handles, map));
}

Matrix3d Linear(const test::Affine& map) {
  Matrix3d linear;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column)
      linear(row, column) = map[static_cast<size_t>(4 * row + column)];
  }
  return linear;
}

TEST(SkinFrames, AtRest_AuthoredNormalsAndTangentsComeBack) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(24, 12);
  CpuSkinner plain = MakeSkinner(fixture);
  ASSERT_TRUE(plain.Skin(test::RestPose(fixture).view()).ok());
  const DeformedMesh result = plain.result();
  for (size_t d = 0; d < result.normals.size(); ++d) {
    EXPECT_LT((Wide(result.normals[d]) - Wide(fixture.mesh.rest_normals[d])).norm(), 2e-5);
    const bool pole = std::abs(fixture.mesh.rest_normals[d].y) > 0.999f;
    const float* tangent = fixture.mesh.rest_tangents.data() + 4 * d;
    EXPECT_EQ(result.tangents[d].handedness, -1);
    if (pole) continue;  // every direction is a tangent there; only one vertex has each
    EXPECT_LT(
        (Wide(result.tangents[d].direction) - Vector3d(tangent[0], tangent[1], tangent[2])).norm(),
        5e-5);
  }
  TiltNormals(&fixture.mesh);
  CpuSkinner tilted = MakeSkinner(fixture);
  ASSERT_TRUE(tilted.Skin(test::RestPose(fixture).view()).ok());
  for (size_t d = 0; d < result.normals.size(); ++d) {
    EXPECT_LT((Wide(tilted.result().normals[d]) - Wide(fixture.mesh.rest_normals[d])).norm(), 2e-5);
  }
}

TEST(SkinFrames, RigidMotion_RotatesNormalsAndTangents) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(20, 11);
  TiltNormals(&fixture.mesh);
  CpuSkinner skinner = MakeSkinner(fixture);
  ASSERT_TRUE(skinner.Skin(test::RestPose(fixture).view()).ok());
  const Vector<Vec3> rest_normals(skinner.result().normals.begin(), skinner.result().normals.end());
  const Vector<Tangent> rest_tangents(skinner.result().tangents.begin(),
                                      skinner.result().tangents.end());
  for (const double angle : {0.4, 1.9, 3.1}) {
    const test::Affine map = test::RotationAffine({0.3, -1, 0.5}, angle, {2, -1, 0.5});
    ASSERT_TRUE(skinner.Skin(UniformPose(fixture, map).view()).ok());
    const Matrix3d r = Linear(map);
    for (size_t d = 0; d < rest_normals.size(); ++d) {
      EXPECT_LT((Wide(skinner.result().normals[d]) - r * Wide(rest_normals[d])).norm(), 3e-5);
      EXPECT_LT(
          (Wide(skinner.result().tangents[d].direction) - r * Wide(rest_tangents[d].direction))
              .norm(),
          8e-5);
    }
  }
}

TEST(SkinFrames, WithoutAuthoredNormals_ASphereHasItsRadiiAsNormals) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(64, 48);
  fixture.mesh.rest_normals.clear();
  CpuSkinner skinner = MakeSkinner(fixture);
  ASSERT_TRUE(skinner.Skin(test::RestPose(fixture).view()).ok());
  const DeformedMesh result = skinner.result();
  for (size_t d = 0; d < result.normals.size(); ++d) {
    EXPECT_GT(Wide(result.normals[d]).dot(Wide(result.positions[d]).normalized()), 0.9995);
  }
}

TEST(SkinFrames, Stretched_NormalsFollowTheDeformedSurface) {
  // A sphere stretched to an ellipsoid: the exact normal is that of the inverse transpose, and the
  // exact tangent is the pushed one.
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(96, 72);
  CpuSkinner skinner = MakeSkinner(fixture);
  const test::Affine map = {1.8, 0.2, 0, 0, 0, 0.7, 0.1, 0, 0, 0, 1.1, 0};
  // The map acts about the rig's origin, the sphere's centre is mesh zero: compare directions only.
  ASSERT_TRUE(skinner.Skin(UniformPose(fixture, map).view()).ok());
  const Matrix3d normal_map = Linear(map).inverse().transpose();
  double worst_normal = 1, worst_tangent = 1;
  for (size_t d = 0; d < skinner.result().normals.size(); ++d) {
    const Vector3d exact = (normal_map * Wide(fixture.mesh.rest_normals[d])).normalized();
    worst_normal = std::min(worst_normal, exact.dot(Wide(skinner.result().normals[d])));
    if (std::abs(fixture.mesh.rest_normals[d].y) > 0.99f) continue;
    const float* t = fixture.mesh.rest_tangents.data() + 4 * d;
    const Vector3d pushed = (Linear(map) * Vector3d(t[0], t[1], t[2])).normalized();
    worst_tangent =
        std::min(worst_tangent, pushed.dot(Wide(skinner.result().tangents[d].direction)));
  }
  EXPECT_GT(worst_normal, 0.999);
  EXPECT_GT(worst_tangent, 0.999);
}

TEST(SkinFrames, HardEdges_StayHard) {
  const test::SkinFixture fixture = test::MakeCubeFixture();
  CpuSkinner skinner = MakeSkinner(fixture);
  EXPECT_EQ(skinner.topology().num_groups(), 24u);
  const test::Affine map = test::RotationAffine({1, 1, 0}, 0.6, {0, 0, 0});
  ASSERT_TRUE(skinner.Skin(UniformPose(fixture, map).view()).ok());
  for (size_t d = 0; d < 24; ++d) {
    const Vector3d exact = Linear(map) * Wide(fixture.mesh.rest_normals[d]);
    EXPECT_LT((Wide(skinner.result().normals[d]) - exact).norm(), 1e-5);
  }
}

TEST(SkinFrames, Seam_SharesOneNormalGroup) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(16, 8);
  const CpuSkinner skinner = MakeSkinner(fixture);
  EXPECT_EQ(skinner.topology().num_groups(), fixture.mesh.num_solve_vertices);
}

void ExpectUnit(const DeformedMesh& result) {
  for (size_t d = 0; d < result.normals.size(); ++d) {
    const Vector3d n = Wide(result.normals[d]), t = Wide(result.tangents[d].direction);
    ASSERT_NEAR(n.norm(), 1, 1e-5) << d;
    ASSERT_NEAR(t.norm(), 1, 1e-5) << d;
    ASSERT_NEAR(n.dot(t), 0, 1e-5) << d;
  }
}

TEST(SkinFrames, AreaThatVanishes_GivesNoNan) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(12, 7);
  // Doubled corners, a triangle folded onto itself, an isolated vertex.
  fixture.mesh.triangles.insert(fixture.mesh.triangles.end(), {0, 0, 5, 7, 8, 7, 30, 31, 30});
  fixture.mesh.rest_normals[20] = {0, 0, 0};
  CpuSkinner skinner = MakeSkinner(fixture);
  ASSERT_TRUE(skinner.Skin(test::RestPose(fixture).view()).ok());
  ExpectUnit(skinner.result());
  // Everything squashed to a plane, to a line, to a point.
  const test::Affine squashed[] = {{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0},
                                   {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                   {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  for (const test::Affine& map : squashed) {
    ASSERT_TRUE(skinner.Skin(UniformPose(fixture, map).view()).ok());
    ExpectUnit(skinner.result());
  }
}

TEST(SkinFrames, TinyAndHugeCharacters_KeepTheirNormals) {
  for (const float factor : {1e-6f, 1e6f}) {
    test::SkinFixture fixture = test::MakeSeamSphereFixture(16, 9);
    fixture.space.scale *= factor;
    for (float& x : fixture.space.origin)
      x *= factor;
    CpuSkinner skinner = MakeSkinner(fixture);
    ASSERT_TRUE(skinner.Skin(test::RestPose(fixture).view()).ok());
    for (size_t d = 0; d < fixture.mesh.rest_normals.size(); ++d) {
      EXPECT_LT((Wide(skinner.result().normals[d]) - Wide(fixture.mesh.rest_normals[d])).norm(),
                2e-5);
    }
  }
}

// Every mixture of coordinates that a float can hold, from the same sequence on every machine.
float Extreme(uint32_t* state) {
  static constexpr float kLargest = std::numeric_limits<float>::max();
  static constexpr float kSmallest = std::numeric_limits<float>::min();
  static constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
  static constexpr float kValues[] = {0,     1,     0.5f,     1e-20f,    1e20f,    3e9f,
                                      1e-8f, 1e15f, kLargest, kSmallest, kDenormal};
  *state = *state * 1664525u + 1013904223u;
  const float value = kValues[(*state >> 8) % std::size(kValues)];
  return (*state >> 24) % 2 == 0 ? value : -value;
}

TEST(SkinFrames, CoordinatesOfAnySize_GiveFiniteUnitFrames) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(9, 6);
  Result<SkinTopology> topology = BuildSkinTopology(fixture.mesh, fixture.space);
  ASSERT_TRUE(topology.ok()) << topology.status().message();
  Vector<Vec3> positions(fixture.mesh.num_solve_vertices);
  uint32_t state = 1;
  for (int round = 0; round < 300; ++round) {
    for (Vec3& p : positions)
      p = {Extreme(&state), Extreme(&state), Extreme(&state)};
    for (const SkinDrawVertex& vertex : topology->draw_vertices) {
      const SurfaceFrame frame = ComputeSurfaceFrame(*topology, vertex.normal_group, positions);
      for (const Vec3& v : {frame.first, frame.second, frame.n, frame.t, frame.b})
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << round;
      Vec3 normal;
      Tangent tangent;
      ApplyFrame(frame, vertex, &normal, &tangent);
      ASSERT_NEAR(Wide(normal).norm(), 1, 1e-5) << round;
      ASSERT_NEAR(Wide(tangent.direction).norm(), 1, 1e-5) << round;
      ASSERT_NEAR(Wide(normal).dot(Wide(tangent.direction)), 0, 1e-5) << round;
    }
  }
}

// The same for what the topology stores of the rest shape: no number of it is infinite or NaN.
TEST(SkinFrames, RestShapesOfAnySize_GiveFiniteTopologies) {
  uint32_t state = 7;
  for (int round = 0; round < 300; ++round) {
    test::SkinFixture fixture = test::MakeSeamSphereFixture(9, 6);
    const Vec3 size = {Extreme(&state), Extreme(&state), Extreme(&state)};
    for (Vec3& p : fixture.mesh.shape_positions) {
      // Some rounds stretch the sphere, the others leave nothing of it.
      p = round % 2 == 0 ? Vec3{Extreme(&state), Extreme(&state), Extreme(&state)}
                         : Vec3{p.x * size.x, p.y * size.y, p.z * size.z};
    }
    Result<SkinTopology> topology = BuildSkinTopology(fixture.mesh, fixture.space);
    ASSERT_TRUE(topology.ok()) << topology.status().message();
    for (const SkinCorner& c : topology->corners) {
      for (const float x : {c.first[0], c.first[1], c.second[0], c.second[1]})
        ASSERT_TRUE(std::isfinite(x)) << round;
    }
    for (const SkinDrawVertex& vertex : topology->draw_vertices) {
      ASSERT_NEAR(Wide(vertex.normal).norm(), 1, 1e-4) << round;
      ASSERT_TRUE(std::isfinite(vertex.tangent[0]) && std::isfinite(vertex.tangent[1])) << round;
    }
    // At rest with all of that: unit frames, or the stored ones.
    CpuSkinner skinner = MakeSkinner(fixture);
    ASSERT_TRUE(skinner.Skin(test::RestPose(fixture).view()).ok());
    ExpectUnit(skinner.result());
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace limber
