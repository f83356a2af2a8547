#include "bake/handle_reach.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace limber::bake {
namespace {

// A strip of 8 x 1 squares in three shapes: flat, folded up by a right angle in its middle, and
// twice as long; and a triangle far away that nothing leads to.
geometry::SolveMesh MakeStrip() {
  constexpr int kSquares = 8;
  geometry::SolveMesh mesh;
  const int count = 2 * (kSquares + 1) + 3;
  geometry::PointMatrix flat(count, 3), folded(count, 3), longer(count, 3);
  for (int x = 0; x <= kSquares; ++x) {
    for (int y = 0; y < 2; ++y) {
      const int v = 2 * x + y;
      const int up = std::max(0, x - kSquares / 2);
      flat.row(v) << x, y, 0;
      folded.row(v) << x - up, y, up;
      longer.row(v) << 2 * x, y, 0;
    }
  }
  for (int x = 0; x < kSquares; ++x) {
    const int v = 2 * x;
    mesh.triangles.push_back({v, v + 2, v + 1});
    mesh.triangles.push_back({v + 1, v + 2, v + 3});
  }
  for (geometry::PointMatrix* shape : {&flat, &folded, &longer})
    shape->bottomRows(3) << 100, 0, 0, 101, 0, 0, 100, 1, 0;
  mesh.triangles.push_back({count - 3, count - 2, count - 1});
  mesh.shapes = {flat, folded, longer};
  return mesh;
}

TEST(HandleReach, IsTheLongestOfTheExamplesShortestWays) {
  geometry::SolveMesh mesh = MakeStrip();
  const std::array<int, 3> handles = {0, 16, 18};  // the strip's ends, the triangle far away
  const Vector<float> all = HandleReach(mesh, handles, 1, 1);
  EXPECT_NEAR(all[1], 16, 1e-5);  // in the longer shape
  EXPECT_EQ(all[3], all[1]);
  for (const size_t diagonal : {0, 4, 8})
    EXPECT_EQ(all[diagonal], 0);
  for (const size_t unreached : {2, 5, 6, 7})
    EXPECT_EQ(all[unreached], 0);
  EXPECT_NEAR(HandleReach(mesh, handles, 4, 1)[1], 4, 1e-5) << "in units of the scale";
  // Folded the ends are 5.7 apart, the way over the skin stays 8.
  mesh.shapes = {mesh.shapes[1]};
  EXPECT_NEAR(HandleReach(mesh, handles, 1, 1)[1], 8, 1e-5);
}

TEST(HandleReach, NumberOfThreads_ChangesNoBit) {
  const geometry::SolveMesh mesh = MakeStrip();
  const std::array<int, 7> handles = {0, 3, 6, 9, 12, 16, 18};
  const Vector<float> alone = HandleReach(mesh, handles, 1.7, 1);
  for (const int threads : {0, 2, 5, 16})
    EXPECT_EQ(HandleReach(mesh, handles, 1.7, threads), alone) << threads;
}

}  // namespace
}  // namespace limber::bake
