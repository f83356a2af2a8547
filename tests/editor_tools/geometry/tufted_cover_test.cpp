#include "geometry/tufted_cover.h"

#include "core/vector.h"
#include "editor_tools/geometry/soup_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

namespace limber::geometry {
namespace {

IntrinsicTriangulation CoverOf(const SolveMesh& mesh) {
  return TuftedCover(mesh.shapes[0], mesh.triangles,
                     MollifiedLengths(mesh.shapes[0], mesh.triangles));
}

void ExpectClosedManifold(const IntrinsicTriangulation& cover) {
  for (int h = 0; h < cover.num_halfedges(); ++h) {
    const int g = cover.twin[h];
    ASSERT_GE(g, 0);
    ASSERT_LT(g, cover.num_halfedges());
    ASSERT_NE(g, h);
    ASSERT_EQ(cover.twin[g], h);
    ASSERT_EQ(cover.tail[g], cover.tail[Next(h)]);
    ASSERT_EQ(cover.tail[h], cover.tail[Next(g)]);
    ASSERT_EQ(cover.length[g], cover.length[h]);
  }
}

// Faces in each part of the cover that hangs together, ascending.
Vector<int> PartSizes(const IntrinsicTriangulation& cover) {
  Vector<int> part(static_cast<size_t>(cover.num_halfedges() / 3), -1), sizes;
  for (size_t start = 0; start < part.size(); ++start) {
    if (part[start] >= 0) continue;
    Vector<int> open = {static_cast<int>(start)};
    const int number = static_cast<int>(sizes.size());
    sizes.push_back(0);
    part[start] = number;
    while (!open.empty()) {
      const int face = open.back();
      open.pop_back();
      ++sizes[number];
      for (int h = 3 * face; h < 3 * face + 3; ++h) {
        const int other = cover.twin[h] / 3;
        if (part[other] >= 0) continue;
        part[other] = number;
        open.push_back(other);
      }
    }
  }
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

TEST(MollifiedLengths, GoodTriangles_KeepTheirLengths) {
  const SolveMesh mesh = test::MakeIcosphere(1);
  const SideLengths lengths = MollifiedLengths(mesh.shapes[0], mesh.triangles);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto& triangle = mesh.triangles[t];
      const double length =
          (mesh.shapes[0].row(triangle[i]) - mesh.shapes[0].row(triangle[(i + 1) % 3])).norm();
      EXPECT_NEAR(lengths.sides[t][i] * lengths.unit, length, 1e-15);
    }
  }
}

TEST(MollifiedLengths, AnyTriangle_HasTheMarginAndNoMoreThanNeeded) {
  for (const double scale : {1e-150, 1.0, 1e150}) {
    for (uint32_t seed = 0; seed < 5; ++seed) {
      SolveMesh mesh = test::MakeSoup(12, 30, seed);
      test::Spoil(seed, &mesh);
      mesh.shapes[0] *= scale;
      double least = 1;
      for (const auto& [a, b, c] : MollifiedLengths(mesh.shapes[0], mesh.triangles).sides) {
        ASSERT_GT(std::min({a, b, c}), 0);
        least = std::min({least, a + b - c, b + c - a, c + a - b});
      }
      EXPECT_NEAR(least, kMollification, 1e-12);
    }
  }
}

TEST(MollifiedLengths, AllInOnePlace_IsEquilateral) {
  SolveMesh mesh = test::MakeGrid(2, 1);
  mesh.shapes[0].setConstant(3);
  for (const auto& [a, b, c] : MollifiedLengths(mesh.shapes[0], mesh.triangles).sides) {
    EXPECT_EQ(a, b);
    EXPECT_EQ(b, c);
    EXPECT_GT(a, 0);
  }
}

TEST(TuftedCover, AnySoup_IsAClosedManifold) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    SolveMesh mesh = test::MakeSoup(10, 40, seed);
    test::Spoil(seed, &mesh);
    ExpectClosedManifold(CoverOf(mesh));
  }
  ExpectClosedManifold(CoverOf(test::MakeBook(7)));
}

TEST(TuftedCover, ClosedSurface_HasTwoSheetsHoweverItIsWound) {
  const SolveMesh sphere = test::MakeIcosphere(1);
  EXPECT_EQ(PartSizes(CoverOf(sphere)), (Vector<int>{80, 80}));
  EXPECT_EQ(PartSizes(CoverOf(test::Rewound(sphere, 3))), (Vector<int>{80, 80}));
}

TEST(TuftedCover, SurfaceWithABorder_FoldsBackThere) {
  const SolveMesh grid = test::MakeGrid(3, 2);
  EXPECT_EQ(PartSizes(CoverOf(test::Rewound(grid, 1))), Vector<int>{24});
}

TEST(TuftedCover, Book_PairsPagesThatFaceEachOther) {
  SolveMesh book = test::MakeBook(5);
  const std::array<int, 5> page_at = {3, 0, 4, 2, 1};  // in the order of the triangles
  const auto triangles = book.triangles;
  for (size_t t = 0; t < triangles.size(); ++t)
    book.triangles[t] = triangles[t % 12 + 12 * size_t(page_at[t / 12])];
  const IntrinsicTriangulation cover = CoverOf(book);
  EXPECT_EQ(PartSizes(cover), Vector<int>{2 * 5 * 12});  // in one piece, around the open edges
  // Across the spine each front or back meets the page before or after its own.
  int crossings = 0;
  for (int h = 0; h < cover.num_halfedges(); ++h) {
    if (cover.tail[h] > 3 || cover.tail[Next(h)] > 3) continue;
    const int page = page_at[h / 6 / 12], other = page_at[cover.twin[h] / 6 / 12];
    EXPECT_TRUE((page + 1) % 5 == other || (other + 1) % 5 == page);
    ++crossings;
  }
  EXPECT_EQ(crossings, 2 * 5 * 3);
}

TEST(TuftedCover, CopiesOfTriangles_LieUponEachOther) {
  // Two skins: outside, inside, and between them a pillow of two faces at each triangle.
  SolveMesh mesh = test::MakeIcosphere(0);
  const auto triangles = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  Vector<int> expected(20, 2);
  expected.insert(expected.end(), {20, 20});
  EXPECT_EQ(PartSizes(CoverOf(mesh)), expected);
  for (uint32_t seed = 0; seed < 4; ++seed) {
    const SolveMesh renamed = test::Renumbered(mesh, test::Shuffle(12, seed));
    EXPECT_EQ(PartSizes(CoverOf(test::Rewound(renamed, seed))), expected);
  }
}

TEST(TuftedCover, Order_DoesNotChangeWhichTrianglesMeet) {
  // As pairs of triangles (by their corners in the old numbering) across each edge of a book.
  const SolveMesh book = test::MakeBook(6);
  const auto meetings = [](const SolveMesh& mesh, const Vector<int>& name_of) {
    const IntrinsicTriangulation cover = CoverOf(mesh);
    std::multiset<Vector<int>> result;
    for (int h = 0; h < cover.num_halfedges(); ++h) {
      Vector<int> meeting;
      for (const int halfedge : {Previous(h), h, Next(h), Previous(cover.twin[h])})
        meeting.push_back(name_of[cover.tail[halfedge]]);
      result.insert(meeting);
    }
    return result;
  };
  Vector<int> names = test::Shuffle(book.num_vertices(), 0);
  std::sort(names.begin(), names.end());
  const auto expected = meetings(book, names);
  for (uint32_t seed = 1; seed < 5; ++seed) {
    const Vector<int> order = test::Shuffle(book.num_vertices(), seed);
    for (size_t v = 0; v < order.size(); ++v)
      names[order[v]] = static_cast<int>(v);
    EXPECT_EQ(meetings(test::Rewound(test::Renumbered(book, order), seed), names), expected);
  }
}

}  // namespace
}  // namespace limber::geometry
