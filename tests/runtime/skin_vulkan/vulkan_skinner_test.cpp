// The numbers that VulkanSkinner writes, beside the CPU's.
#include "core/vector.h"
#include "runtime/skin_vulkan/vulkan_skin_fixture.h"
#include "skin/cpu_skinner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

namespace limber {
namespace {

using test::ExpectEqualToCpu;
using test::SkinnedVertex;

class VulkanSkinnerTest : public test::VulkanSkinTest {};

test::SkinPose SpherePose(const test::SkinFixture& fixture) {
  return test::MakePose(fixture, {1, 1.2f},
                        {test::RotationAffine({1, 0, 0}, 0.1, {0, 0, 0}),
                         test::RotationAffine({1, 2, 0}, 0.9, {0.4, 0.1, 0})});
}

TEST_F(VulkanSkinnerTest, CountsThatAreNoMultipleOfTheGroup_EqualTheCpu) {
  // 13 x 18 + 2 = 236 vertices of the cylinder, 20 x 12 = 240 draw and 211 solve of the sphere.
  const test::SkinFixture cylinder = test::MakeCylinderFixture(13, 17);
  ASSERT_NE(cylinder.mesh.num_draw_vertices % 64, 0u);
  for (const double amount : {0.0, 0.4, 1.0}) {
    const test::SkinPose pose = test::CylinderPose(cylinder, amount);
    ExpectEqualToCpu(cylinder, pose, Skin(cylinder, pose));
  }
  const test::SkinFixture sphere = test::MakeSeamSphereFixture(19, 11);
  const test::SkinPose pose = SpherePose(sphere);
  ExpectEqualToCpu(sphere, pose, Skin(sphere, pose));
}

// The cylinder with each of its handles and shapes several times over, in parts that add up.
test::SkinFixture Repeated(const test::SkinFixture& from, int times) {
  test::SkinFixture fixture = from;
  SkinMesh& mesh = fixture.mesh;
  const auto num_handles = static_cast<size_t>(from.mesh.num_handles);
  mesh.num_handles *= times;
  mesh.num_shapes *= times;
  mesh.weights.clear();
  mesh.shape_positions.clear();
  for (int i = 0; i < times; ++i) {
    mesh.shape_positions.insert(mesh.shape_positions.end(), from.mesh.shape_positions.begin(),
                                from.mesh.shape_positions.end());
  }
  for (size_t v = 0; v < mesh.num_solve_vertices; ++v) {
    for (int i = 0; i < times; ++i) {
      for (size_t h = 0; h < num_handles; ++h)
        mesh.weights.push_back(from.mesh.weights[v * num_handles + h] / static_cast<float>(times));
    }
  }
  return fixture;
}

// A pose of it in which no matrix is zero.
test::SkinPose RepeatedPose(const test::SkinFixture& from, const test::SkinPose& pose, int times) {
  test::SkinPose repeated;
  repeated.origin = pose.origin;
  const auto handle_floats = static_cast<size_t>(from.mesh.num_shapes) * 12;
  for (int i = 0; i < times; ++i) {
    for (size_t h = 0; h < static_cast<size_t>(from.mesh.num_handles); ++h) {
      for (int part = 0; part < times; ++part) {
        for (size_t k = 0; k < handle_floats; ++k)
          repeated.matrices.push_back(pose.matrices[h * handle_floats + k] /
                                      static_cast<float>(times));
      }
    }
  }
  return repeated;
}

// Small rigs have the shader's loops laid out; each size is another program.
TEST_F(VulkanSkinnerTest, RigsOfAnySize_EqualTheCpu) {
  const test::SkinFixture cylinder = test::MakeCylinderFixture(13, 17);
  const test::SkinPose pose = test::CylinderPose(cylinder, 0.7);
  for (const int times : {1, 2, 3, 5}) {  // 3 x 3, 6 x 6, 9 x 9 and, in loops, 15 x 15
    const test::SkinFixture fixture = Repeated(cylinder, times);
    const test::SkinPose repeated = RepeatedPose(cylinder, pose, times);
    for (const auto dispatch :
         {VulkanSkinnerOptions::Dispatch::kOne, VulkanSkinnerOptions::Dispatch::kMany}) {
      VulkanSkinnerOptions options;
      options.dispatch = dispatch;
      ExpectEqualToCpu(fixture, repeated, Skin(fixture, repeated, options));
    }
  }
}

TEST_F(VulkanSkinnerTest, Staging_GivesTheSameBits) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(11, 9);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.8);
  VulkanSkinnerOptions options;
  const auto direct = Skin(fixture, pose, options);
  options.force_staging = true;
  const auto staged = Skin(fixture, pose, options);
  ASSERT_EQ(direct.size(), staged.size());
  EXPECT_EQ(std::memcmp(direct.data(), staged.data(), direct.size() * sizeof(SkinnedVertex)), 0);
}

TEST_F(VulkanSkinnerTest, SeamVertices_AreBitwiseEqual) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(21, 10);
  const Vector<SkinnedVertex> gpu = Skin(fixture, SpherePose(fixture));
  Vector<int> first(fixture.mesh.num_solve_vertices, -1);
  int shared = 0;
  for (size_t d = 0; d < gpu.size(); ++d) {
    int& known = first[fixture.mesh.solve_vertex[d]];
    if (known < 0) {
      known = static_cast<int>(d);
      continue;
    }
    ++shared;
    const SkinnedVertex& other = gpu[static_cast<size_t>(known)];
    EXPECT_EQ(std::memcmp(gpu[d].position, other.position, sizeof(other.position)), 0);
    EXPECT_EQ(std::memcmp(gpu[d].normal, other.normal, sizeof(other.normal)), 0);
  }
  EXPECT_GE(shared, 9);
}

TEST_F(VulkanSkinnerTest, ZeroAreaAndCollapse_GiveNoNan) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(12, 7);
  fixture.mesh.triangles.insert(fixture.mesh.triangles.end(), {0, 0, 5, 7, 8, 7});
  const test::Affine nothing{};
  const test::SkinPose pose = test::MakePose(fixture, {1, 1}, {nothing, nothing});
  for (const SkinnedVertex& v : Skin(fixture, pose)) {
    EXPECT_NEAR(std::hypot(v.normal[0], v.normal[1], v.normal[2]), 1, 1e-5);
    EXPECT_NEAR(std::hypot(v.tangent[0], v.tangent[1], v.tangent[2]), 1, 1e-5);
  }
}

// A pose of two shapes: the first makes the frames at rest, the second is where the vertices are
// put, to the bit: rig space is mesh space, and the matrices are the identity.
test::SkinFixture WithASecondShape(test::SkinFixture fixture) {
  fixture.space = {};
  SkinMesh& mesh = fixture.mesh;
  mesh.num_shapes = 2;
  mesh.shape_positions.resize(size_t{2} * mesh.num_solve_vertices);
  std::copy_n(mesh.shape_positions.begin(), mesh.num_solve_vertices,
              mesh.shape_positions.begin() + mesh.num_solve_vertices);
  return fixture;
}

double Dot(const float* a, const float* b) {
  return double{a[0]} * b[0] + double{a[1]} * b[1] + double{a[2]} * b[2];
}

TEST_F(VulkanSkinnerTest, CharactersOfAnySize_HaveTheFramesOfTheCpu) {
  const test::SkinFixture sphere = WithASecondShape(test::MakeSeamSphereFixture(12, 7));
  const uint32_t count = sphere.mesh.num_solve_vertices;
  // Round, flat and long, each from nearly nothing to beyond what can be squared. Frames are no
  // longer made of the largest ones: both must draw that line at the same size.
  constexpr std::array<float, 3> kForms[] = {{1, 1, 1}, {1, 1e-3f, 1}, {1, 1, 300}};
  constexpr float kSizes[] = {1e-12f, 1e-6f, 1, 1e4f, 1e6f, 1e7f, 3e7f, 1e8f, 1e12f, 1e19f, 1e30f};
  for (const std::array<float, 3>& form : kForms) {
    for (const float size : kSizes) {
      test::SkinFixture fixture = sphere;
      for (uint32_t v = 0; v < count; ++v) {
        Vec3& p = fixture.mesh.shape_positions[count + v];
        for (int axis = 0; axis < 3; ++axis)
          p[axis] *= size * form[static_cast<size_t>(axis)];
      }
      const test::SkinPose pose = test::RestPose(fixture, 1);
      const auto gpu = Skin(fixture, pose);
      Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
      ASSERT_TRUE(cpu.ok());
      ASSERT_TRUE(cpu->Skin(pose.view()).ok());
      for (size_t d = 0; d < gpu.size(); ++d) {
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_NEAR(gpu[d].normal[axis], cpu->result().normals[d][axis], 1e-4)
              << size << ' ' << d;
          ASSERT_NEAR(gpu[d].tangent[axis], cpu->result().tangents[d].direction[axis], 2e-4)
              << size << ' ' << d;
        }
      }
    }
  }
}

// A mixture of coordinates, from the same sequence on every machine: all that a float can hold, or
// only such as can be squared, which crumple the surface until tangents lie along normals.
float Extreme(bool all, uint32_t* state) {
  static constexpr float kLargest = std::numeric_limits<float>::max();
  static constexpr float kSmallest = std::numeric_limits<float>::min();
  static constexpr float kValues[] = {0,     1,    0.5f,   30,    1e-3f, 1e4f,     1e-5f,
                                      1e-8f, 3e9f, 1e-20f, 1e20f, 1e15f, kLargest, kSmallest};
  *state = *state * 1664525u + 1013904223u;
  const float value = kValues[(*state >> 8) % (all ? std::size(kValues) : 7)];
  return (*state >> 24) % 2 == 0 ? value : -value;
}

TEST_F(VulkanSkinnerTest, CoordinatesOfAnySize_GiveFiniteUnitFrames) {
  const test::SkinFixture sphere = WithASecondShape(test::MakeSeamSphereFixture(40, 30));
  uint32_t state = 1;
  for (int round = 0; round < 60; ++round) {
    const bool all = round % 3 == 0;
    test::SkinFixture fixture = sphere;
    for (uint32_t v = 0; v < fixture.mesh.num_solve_vertices; ++v) {
      fixture.mesh.shape_positions[fixture.mesh.num_solve_vertices + v] = {
          Extreme(all, &state), Extreme(all, &state), Extreme(all, &state)};
    }
    for (const SkinnedVertex& v : Skin(fixture, test::RestPose(fixture, 1))) {
      ASSERT_NEAR(Dot(v.normal, v.normal), 1, 1e-5) << round;
      ASSERT_NEAR(Dot(v.tangent, v.tangent), 1, 1e-5) << round;
      ASSERT_NEAR(Dot(v.normal, v.tangent), 0, 2e-6) << round;
    }
  }
}

TEST_F(VulkanSkinnerTest, TableBeyondTheStorageRange_IsRefusedByName) {
  test::SkinFixture fixture = test::MakeCubeFixture();
  const uint64_t limit = device_->properties().limits.maxStorageBufferRange;
  if (limit > (uint64_t{1} << 28)) GTEST_SKIP() << "the device's storage range is too large";
  // One solve vertex and so many shapes that the shape table just exceeds the range.
  SkinMesh& mesh = fixture.mesh;
  mesh.num_solve_vertices = 1;
  mesh.weights.resize(1);
  mesh.solve_vertex.assign(24, 0);
  mesh.num_shapes = static_cast<int32_t>(limit / 48 + 1);
  mesh.shape_positions.assign(static_cast<size_t>(mesh.num_shapes), Vec3{});
  const auto skinner = MakeSkinner();
  ASSERT_NE(skinner, nullptr);
  EXPECT_EQ(skinner->AddRig(mesh, fixture.space).status().code(), StatusCode::kLimitExceeded);
}

}  // namespace
}  // namespace limber
