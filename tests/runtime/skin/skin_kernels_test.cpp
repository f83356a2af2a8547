// The skinning loop of every instruction set, beside the sum in double.
#include "core/vector.h"
#include "runtime/skin/skin_fixtures.h"
#include "skin/cpu_skinner.h"
#include "skin/skin_positions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

namespace limber {
namespace {

struct RandomCharacter {
  SkinMesh mesh;
  Vector<float> matrices;
  Vec3 origin = {0.5f, -2, 3};

  SkinTransforms transforms() const { return {matrices, origin}; }
};

enum class Shapes { kAny, kMoveAll };

// Any weights: local ones, dense ones, vertices that follow one handle alone. Shapes that move all,
// a part, and (each fourth) nothing; or all that move all.
RandomCharacter MakeRandom(int num_handles, int num_shapes, uint32_t num_vertices,
                           Shapes shapes = Shapes::kAny) {
  RandomCharacter made;
  std::mt19937 random(static_cast<unsigned>(num_handles * 100 + num_shapes));
  std::uniform_real_distribution<float> number(-1, 1);
  SkinMesh& mesh = made.mesh;
  mesh.num_handles = num_handles;
  mesh.num_shapes = num_shapes;
  mesh.num_solve_vertices = mesh.num_draw_vertices = num_vertices;
  for (uint32_t v = 0; v < num_vertices; ++v) {
    mesh.solve_vertex.push_back(v);
    float sum = 0;
    for (int h = 0; h < num_handles; ++h) {
      const bool is_followed = h == static_cast<int>(v) % num_handles || random() % 3 == 0;
      mesh.weights.push_back(is_followed ? 0.1f + std::abs(number(random)) : 0.0f);
      sum += mesh.weights.back();
    }
    for (int h = 0; h < num_handles; ++h)
      mesh.weights[mesh.weights.size() - 1 - static_cast<size_t>(h)] /= sum;
  }
  for (int s = 0; s < num_shapes; ++s) {
    for (uint32_t v = 0; v < num_vertices; ++v) {
      const bool is_moved =
          s == 0 || shapes == Shapes::kMoveAll || s % 4 == 2 || (s % 4 != 3 && random() % 4 == 0);
      mesh.shape_positions.push_back(is_moved ? Vec3{number(random), number(random), number(random)}
                                              : mesh.shape_positions[v]);
    }
  }
  for (int i = 0; i < num_handles * num_shapes * 12; ++i)
    made.matrices.push_back(number(random));
  return made;
}

TEST(SkinKernels, EverySetAndSize_IsTheSumInDouble) {
  for (int num_handles = 1; num_handles <= 20; ++num_handles) {
    for (int num_shapes = 1; num_shapes <= 8; ++num_shapes) {
      for (const uint32_t count : {1u, 15u, 16u, 17u, 83u}) {
        const RandomCharacter c = MakeRandom(num_handles, num_shapes, count);
        const SkinLayout layout(c.mesh);
        Vector<Vec3> expected(count), found(count);
        ASSERT_TRUE(SkinPositionsReference(c.mesh, c.transforms(), expected).ok());
        for (const SkinKernels* const* set = AvailableSkinKernels(); *set != nullptr; ++set) {
          SkinScratch scratch;
          ASSERT_TRUE(SkinPositionsWith(**set, layout, c.transforms(), &scratch, found).ok());
          for (uint32_t v = 0; v < count; ++v) {
            for (int axis = 0; axis < 3; ++axis) {
              // Each of the S (and the origin) is of order one.
              ASSERT_NEAR(found[v][axis], expected[v][axis], 4e-7 * (num_shapes + 3))
                  << (*set)->name << ' ' << num_handles << ' ' << num_shapes << ' ' << v;
            }
          }
        }
      }
    }
  }
}

TEST(SkinKernels, SetsWithFusedArithmetic_GiveTheSameBits) {
  const RandomCharacter c = MakeRandom(9, 6, 1003);
  const SkinLayout layout(c.mesh);
  Vector<Vector<Vec3>> results;
  for (const SkinKernels* const* set = AvailableSkinKernels() + 1;
       *(set - 1) != nullptr && *set != nullptr; ++set) {
    SkinScratch scratch;
    results.emplace_back(c.mesh.num_solve_vertices);
    ASSERT_TRUE(SkinPositionsWith(**set, layout, c.transforms(), &scratch, results.back()).ok());
  }
  if (results.size() < 2) GTEST_SKIP() << "this machine has fewer than two such sets";
  EXPECT_EQ(results[0], results[1]);
}

// Which vertices come into one block is nobody's affair: a vertex alone has the same bits.
TEST(SkinKernels, VerticesOfAnyCompany_HaveTheSameBits) {
  const RandomCharacter c = MakeRandom(7, 4, 64, Shapes::kMoveAll);
  SkinScratch scratch;
  Vector<Vec3> together(64), alone(1);
  ASSERT_TRUE(SkinPositions(SkinLayout(c.mesh), c.transforms(), &scratch, together).ok());
  for (uint32_t v = 0; v < 64; ++v) {
    SkinMesh one = c.mesh;
    one.num_solve_vertices = one.num_draw_vertices = 1;
    one.solve_vertex = {0};
    one.weights.assign(c.mesh.weights.begin() + v * 7, c.mesh.weights.begin() + v * 7 + 7);
    one.shape_positions.clear();
    for (size_t s = 0; s < 4; ++s)
      one.shape_positions.push_back(c.mesh.shape_positions[s * 64 + v]);
    ASSERT_TRUE(SkinPositions(SkinLayout(one), c.transforms(), &scratch, alone).ok());
    EXPECT_EQ(alone[0], together[v]) << v;
  }
}

TEST(SkinLayout, BlocksFollowFewHandles) {
  // Four patches in turn, each of two handles: sorted, no block follows more than two.
  RandomCharacter c = MakeRandom(8, 1, 256);
  std::fill(c.mesh.weights.begin(), c.mesh.weights.end(), 0.0f);
  for (size_t v = 0; v < 256; ++v)
    c.mesh.weights[v * 8 + v % 4 * 2] = c.mesh.weights[v * 8 + v % 4 * 2 + 1] = 0.5f;
  const SkinLayout layout(c.mesh);
  EXPECT_EQ(layout.num_block_handles(), 2u * layout.num_blocks());
}

// In which order vertices come is nobody's affair either, whatever shapes move them.
TEST(SkinKernels, VerticesInAnyOrder_HaveTheSameBits) {
  constexpr uint32_t kCount = 203;
  const RandomCharacter c = MakeRandom(5, 9, kCount);
  Vector<uint32_t> from(kCount);
  std::iota(from.begin(), from.end(), 0u);
  std::shuffle(from.begin(), from.end(), std::mt19937(3));
  SkinMesh shuffled = c.mesh;
  for (uint32_t v = 0; v < kCount; ++v) {
    std::copy_n(&c.mesh.weights[size_t{from[v]} * 5], 5, &shuffled.weights[size_t{v} * 5]);
    for (size_t s = 0; s < 9; ++s)
      shuffled.shape_positions[s * kCount + v] = c.mesh.shape_positions[s * kCount + from[v]];
  }
  for (const SkinKernels* const* set = AvailableSkinKernels(); *set != nullptr; ++set) {
    SkinScratch scratch;
    Vector<Vec3> plain(kCount), found(kCount);
    const SkinLayout layout(c.mesh), other(shuffled);
    ASSERT_TRUE(SkinPositionsWith(**set, layout, c.transforms(), &scratch, plain).ok());
    ASSERT_TRUE(SkinPositionsWith(**set, other, c.transforms(), &scratch, found).ok());
    for (uint32_t v = 0; v < kCount; ++v)
      EXPECT_EQ(std::memcmp(&found[v], &plain[from[v]], sizeof(Vec3)), 0) << (*set)->name << v;
  }
}

// Each of eight shapes moves an eighth of the mesh, of which every eighth vertex is one.
TEST(SkinLayout, BlocksKeepWhatMovesThem) {
  RandomCharacter c = MakeRandom(1, 9, 256);
  for (size_t s = 1; s < 9; ++s) {
    for (size_t v = 0; v < 256; ++v) {
      c.mesh.shape_positions[s * 256 + v] = c.mesh.shape_positions[v];
      if (v % 8 == s - 1) c.mesh.shape_positions[s * 256 + v].y += 0.5f;
    }
  }
  const SkinLayout layout(c.mesh);
  EXPECT_EQ(layout.num_block_shapes(), 2u * layout.num_blocks());
}

// The identity in shape `s` of the one handle.
Vector<float> AllOf(size_t s, size_t num_shapes) {
  Vector<float> matrices(num_shapes * 12);
  for (size_t axis = 0; axis < 3; ++axis)
    matrices[s * 12 + axis * 5] = 1;
  return matrices;
}

// The difference of two finite positions need not be: at rest it must not count.
TEST(SkinLayout, ShapesBeyondSinglePrecision_LeaveTheOthersAlone) {
  RandomCharacter c = MakeRandom(1, 2, 4);
  for (size_t v = 0; v < 4; ++v) {
    c.mesh.shape_positions[v].x = -3e38f;
    c.mesh.shape_positions[4 + v] = c.mesh.shape_positions[v];
  }
  c.mesh.shape_positions[5] = {3e38f, 0, 0};
  Vector<Vec3> found(4);
  SkinScratch scratch;
  const Vector<float> matrices = AllOf(0, 2);
  ASSERT_TRUE(SkinPositions(SkinLayout(c.mesh), {matrices, Vec3{}}, &scratch, found).ok());
  for (size_t v = 0; v < 4; ++v)
    EXPECT_EQ(found[v], c.mesh.shape_positions[v]);
}

TEST(SkinLayout, ShapesMuchSmallerThanTheFirst_KeepTheirDigits) {
  RandomCharacter c = MakeRandom(1, 2, 20, Shapes::kMoveAll);
  for (size_t v = 20; v < 40; ++v) {
    for (int axis = 0; axis < 3; ++axis)
      c.mesh.shape_positions[v][axis] *= 1e-12f;
  }
  Vector<Vec3> found(20);
  SkinScratch scratch;
  const Vector<float> matrices = AllOf(1, 2);
  ASSERT_TRUE(SkinPositions(SkinLayout(c.mesh), {matrices, Vec3{}}, &scratch, found).ok());
  for (size_t v = 0; v < 20; ++v)
    EXPECT_EQ(found[v], c.mesh.shape_positions[20 + v]);
}

TEST(CpuSkinner, IntoAnyLayout_HasTheSameBitsAndNothingElseIsTouched) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(19, 11);
  auto surface = SkinSurface::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(surface.ok());
  auto packed = CpuSkinner::Create(*surface);
  auto lean = CpuSkinner::CreateWithoutResults(*surface);
  ASSERT_TRUE(packed.ok() && lean.ok());
  const test::SkinPose pose = test::RestPose(fixture);
  ASSERT_TRUE(packed->Skin(pose.view()).ok());
  EXPECT_EQ(lean->Skin(pose.view()).code(), StatusCode::kInvalidArgument);
  constexpr size_t kStride = 52;  // and one byte off, as mapped memory may be
  const size_t count = fixture.mesh.num_draw_vertices;
  Vector<unsigned char> bytes(1 + count * kStride, 0xCD), expected = bytes;
  SkinOutputs outputs;
  Bounds bounds;
  outputs.positions = {bytes.data() + 1, kStride};
  outputs.tangents = {bytes.data() + 1 + 16, kStride};
  outputs.normals = {bytes.data() + 1 + 36, kStride};
  outputs.bounds = &bounds;
  ASSERT_TRUE(lean->SkinInto(pose.view(), outputs).ok());
  const DeformedMesh mesh = packed->result();
  Vec3 low = mesh.positions[0], high = low;
  for (size_t d = 0; d < count; ++d) {
    unsigned char* vertex = expected.data() + 1 + d * kStride;
    std::memcpy(vertex, &mesh.positions[d], sizeof(Vec3));
    std::memcpy(vertex + 16, &mesh.tangents[d], sizeof(Tangent));
    std::memcpy(vertex + 36, &mesh.normals[d], sizeof(Vec3));
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], mesh.positions[d][axis]);
      high[axis] = std::max(high[axis], mesh.positions[d][axis]);
    }
  }
  EXPECT_EQ(bytes, expected);
  EXPECT_EQ(bounds.min, low);
  EXPECT_EQ(bounds.max, high);
}

}  // namespace
}  // namespace limber
