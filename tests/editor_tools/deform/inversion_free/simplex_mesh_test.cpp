#include "deform/inversion_free/simplex_mesh.h"

#include "made_elements.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

namespace limber::deform {
namespace {

template <int D>
double TotalVolume(const Vector<ElementRest<D>>& rest) {
  double sum = 0;
  for (const ElementRest<D>& element : rest)
    sum += element.volume;
  return sum;
}

TEST(SimplexMesh, MadeOnes_FillTheirShape) {
  const auto grid = MeasureRest(test::MakeGrid(5));
  ASSERT_TRUE(grid.ok());
  EXPECT_NEAR(TotalVolume(*grid), 4, 1e-12);
  const TetMesh bar = test::MakeBar(3, 2, 4);
  const auto rest = MeasureRest(bar);
  ASSERT_TRUE(rest.ok()) << rest.status().message();
  EXPECT_NEAR(TotalVolume(*rest), 2.0 / 3 * 4.0 / 3, 1e-12);
  // No face is left open within: each belongs to two tetrahedra, or lies on the hull.
  std::map<std::set<int>, int> faces;
  for (const auto& t : bar.elements) {
    for (size_t skipped = 0; skipped < 4; ++skipped) {
      std::set<int> face(t.begin(), t.end());
      face.erase(t[skipped]);
      ++faces[face];
    }
  }
  int on_hull = 0;
  for (const auto& [face, count] : faces) {
    ASSERT_LE(count, 2);
    on_hull += count == 1 ? 1 : 0;
  }
  EXPECT_EQ(on_hull, 2 * 2 * (3 * 2 + 3 * 4 + 2 * 4));
}

TEST(SimplexMesh, Gradients_GiveTheMatrixOfAnyAffineMap) {
  const TetMesh bar = test::MakeBar(2, 2, 2);
  const auto rest = MeasureRest(bar);
  ASSERT_TRUE(rest.ok());
  const Eigen::Matrix3d a = Eigen::Matrix3d::Random();
  TetMesh::Positions moved = bar.rest * a.transpose();
  moved.rowwise() += Eigen::RowVector3d(1, 2, 3);
  for (size_t i = 0; i < rest->size(); ++i) {
    const Eigen::Matrix3d f = Corners<3>(moved, bar.elements[i]) * (*rest)[i].gradients.transpose();
    EXPECT_LT((f - a).norm(), 1e-12);
    EXPECT_NEAR(SignedSize<3>(moved, bar.elements[i]), a.determinant() * 6 * (*rest)[i].volume,
                1e-12);
  }
}

TEST(SimplexMesh, WhatIsNoMesh_IsRefusedByNumber) {
  TetMesh bar = test::MakeBar(2, 2, 2);
  std::swap(bar.elements[7][0], bar.elements[7][1]);
  EXPECT_EQ(MeasureRest(bar).status().code(), StatusCode::kDegenerate);
  EXPECT_NE(MeasureRest(bar).status().message().find("element 7: inside out"), std::string::npos);
  EXPECT_EQ(Orient(&bar), 1);
  EXPECT_TRUE(MeasureRest(bar).ok());
  bar.elements[3][2] = bar.elements[3][1];
  EXPECT_NE(MeasureRest(bar).status().message().find("element 3: flat"), std::string::npos);
  bar.elements[3][2] = 99;
  EXPECT_EQ(MeasureRest(bar).status().code(), StatusCode::kMalformed);
  bar = test::MakeBar(2, 2, 2);
  bar.rest(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MeasureRest(bar).status().code(), StatusCode::kMalformed);
  EXPECT_EQ(MeasureRest(TetMesh()).status().code(), StatusCode::kDegenerate);
}

}  // namespace
}  // namespace limber::deform
