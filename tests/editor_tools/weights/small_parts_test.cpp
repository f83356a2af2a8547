// Eyes and buttons move as one; sleeves do not.
#include "bake/small_parts.h"

#include "bake/skinning_weights.h"
#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"

#include <gtest/gtest.h>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using geometry::SolveMesh;

// A cloth of 20 x 12 with parts above it; handles at two of its corners.
struct Dressed {
  SolveMesh mesh = test::MakeGrid(20, 12);
  Vector<int> handles = {0, 20};
  int cloth = mesh.num_vertices();

  void Add(SolveMesh part, double size, const Eigen::RowVector3d& place) {
    part.shapes[0] *= size;
    test::Append(part, place, &mesh);
  }

  MatrixXd Weights() {
    geometry::ConnectComponents(&mesh);
    WeightsReport report;
    auto weights = BoundedBiharmonicWeights(mesh, handles, 1, {}, &report);
    EXPECT_TRUE(weights.ok()) << weights.status().message();
    return std::move(weights).value();
  }

  double Spread(const MatrixXd& weights, int first, int end) const {
    const auto rows = weights.middleRows(first, end - first);
    return (rows.colwise().maxCoeff() - rows.colwise().minCoeff()).maxCoeff();
  }
};

TEST(HoldSmallParts, AButtonGetsOneRow_TheClothKeepsItsBits) {
  Dressed dressed;
  dressed.Add(test::MakeGrid(3, 3), 0.5, {9, 5, 0.1});
  MatrixXd weights = dressed.Weights();
  const MatrixXd before = weights;
  const int end = dressed.mesh.num_vertices();
  ASSERT_GT(dressed.Spread(before, dressed.cloth, end), 1e-4);
  EXPECT_EQ(HoldSmallParts(dressed.mesh, dressed.handles, &weights), 1);
  EXPECT_EQ(dressed.Spread(weights, dressed.cloth, end), 0);
  EXPECT_NEAR(weights.row(dressed.cloth).sum(), 1, 1e-14);
  EXPECT_EQ(weights.topRows(dressed.cloth), before.topRows(dressed.cloth));
  // It follows as what is below it does.
  EXPECT_LT((weights.row(dressed.cloth) - before.row(dressed.cloth)).cwiseAbs().maxCoeff(), 0.1);
}

TEST(HoldSmallParts, LargeOrLongParts_RunOnSmoothly) {
  for (const Eigen::Vector2d& size : {Eigen::Vector2d(1, 1), Eigen::Vector2d(0.4, 0.05)}) {
    Dressed dressed;
    SolveMesh part = test::MakeGrid(5, 5);
    part.shapes[0].col(0) *= size[0];
    part.shapes[0].col(1) *= size[1];
    dressed.Add(part, 1, {9, 5, 0.1});
    MatrixXd weights = dressed.Weights();
    const MatrixXd before = weights;
    EXPECT_EQ(HoldSmallParts(dressed.mesh, dressed.handles, &weights), 0);
    EXPECT_EQ(weights, before);
  }
}

TEST(HoldSmallParts, APartWithAHandle_KeepsItsWeights) {
  Dressed dressed;
  dressed.Add(test::MakeGrid(3, 3), 0.5, {9, 5, 0.1});
  dressed.handles.push_back(dressed.cloth + 5);
  MatrixXd weights = dressed.Weights();
  const MatrixXd before = weights;
  EXPECT_EQ(HoldSmallParts(dressed.mesh, dressed.handles, &weights), 0);
  EXPECT_EQ(weights, before);
}

// A pupil on an eye: both move as the eye does.
TEST(HoldSmallParts, APartOnAPart_FollowsIt) {
  Dressed dressed;
  dressed.Add(test::MakeGrid(3, 3), 0.5, {9, 5, 0.4});
  const int eye = dressed.cloth, pupil = dressed.mesh.num_vertices();
  dressed.Add(test::MakeGrid(2, 2), 0.2, {9.5, 5.5, 0.5});
  MatrixXd weights = dressed.Weights();
  EXPECT_EQ(HoldSmallParts(dressed.mesh, dressed.handles, &weights), 2);
  EXPECT_LT((weights.row(eye) - weights.row(pupil)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(dressed.Spread(weights, pupil, dressed.mesh.num_vertices()), 0);
}

}  // namespace
}  // namespace limber::bake
