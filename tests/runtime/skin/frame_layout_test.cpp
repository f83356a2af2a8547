// Normals and tangents by the wide kernels of every instruction set, beside the plain functions:
// bit for bit.
#include "skin/frame_layout.h"

#include "core/vector.h"
#include "runtime/skin/skin_fixtures.h"
#include "skin/skin_positions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

namespace limber {
namespace {

template <class T>
bool SameBits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

// `positions`: [V + 1].
void ExpectPlainResults(const SkinTopology& topology, std::span<const Vec3> positions) {
  const FrameLayout layout(topology);
  FrameScratch scratch;
  scratch.Resize(topology.num_groups());
  const std::span<const SkinDrawVertex> vertices = topology.draw_vertices;
  for (const SkinKernels* const* set = AvailableSkinKernels(); *set != nullptr; ++set) {
    SCOPED_TRACE((*set)->name);
    std::memset(static_cast<void*>(scratch.frames.data()), 0xCD,
                scratch.frames.size() * sizeof(SurfaceFrame));
    ComputeSurfaceFrames(**set, layout, topology, positions, &scratch);
    for (uint32_t g = 0; g < topology.num_groups(); ++g) {
      ASSERT_TRUE(SameBits(scratch.frames[g], ComputeSurfaceFrame(topology, g, positions))) << g;
    }
    for (size_t begin = 0; begin < vertices.size(); begin += kSkinLanes) {
      const size_t count = std::min<size_t>(kSkinLanes, vertices.size() - begin);
      Vec3 normals[kSkinLanes];
      Tangent tangents[kSkinLanes];
      ApplyFrames(**set, scratch.frames, vertices.subspan(begin, count), normals, tangents);
      for (size_t i = 0; i < count; ++i) {
        const SkinDrawVertex& vertex = vertices[begin + i];
        Vec3 normal;
        Tangent tangent;
        ApplyFrame(scratch.frames[vertex.normal_group], vertex, &normal, &tangent);
        ASSERT_TRUE(SameBits(normals[i], normal)) << begin + i;
        ASSERT_TRUE(SameBits(tangents[i], tangent)) << begin + i;
      }
    }
  }
}

SkinTopology TopologyOf(const test::SkinFixture& fixture) {
  auto topology = BuildSkinTopology(fixture.mesh, fixture.space);
  EXPECT_TRUE(topology.ok()) << topology.status().message();
  return std::move(topology).value();
}

TEST(FrameLayout, BentShapes_GiveThePlainBits) {
  // Poles and ends have other numbers of corners than the rest; no count is a multiple of sixteen.
  test::SkinFixture cylinder = test::MakeCylinderFixture(13, 9);
  cylinder.mesh.triangles.resize(cylinder.mesh.triangles.size() / 2);  // vertices without any
  for (const double amount : {0.0, 0.4, 1.0}) {
    Vector<Vec3> positions(cylinder.mesh.num_solve_vertices);
    ASSERT_TRUE(SkinPositionsReference(cylinder.mesh, test::CylinderPose(cylinder, amount).view(),
                                       positions)
                    .ok());
    positions.emplace_back();
    ExpectPlainResults(TopologyOf(cylinder), positions);
  }
}

TEST(FrameLayout, SeamsAndHardEdges_GiveThePlainBits) {
  for (const test::SkinFixture& fixture :
       {test::MakeSeamSphereFixture(19, 11), test::MakeCubeFixture()}) {
    Vector<Vec3> positions(fixture.mesh.num_solve_vertices);
    ASSERT_TRUE(
        SkinPositionsReference(fixture.mesh, test::RestPose(fixture).view(), positions).ok());
    positions.emplace_back();
    ExpectPlainResults(TopologyOf(fixture), positions);
  }
}

// Collapsed, folded, infinite: what leaves the usual way among what does not.
TEST(FrameLayout, PositionsOfAnySize_GiveThePlainBits) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(9, 6);
  const SkinTopology topology = TopologyOf(fixture);
  const size_t count = fixture.mesh.num_solve_vertices;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-1, 1);
  constexpr float kValues[] = {0,     -0.0f, 1,    1e-20f, 1e20f,
                               1e15f, 1e-8f, 3e9f, 1e38f,  std::numeric_limits<float>::infinity()};
  for (unsigned round = 0; round < 200; ++round) {
    Vector<Vec3> positions(count + 1);
    for (Vec3& p : positions) {
      p = {number(random), number(random), number(random)};
      if (random() % 40 < round % 20) p[static_cast<int>(random() % 3)] = kValues[random() % 10];
      if (random() % 40 < round % 11) p = positions[0];
    }
    ExpectPlainResults(topology, positions);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace limber
