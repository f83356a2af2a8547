// Preview weights: what heat does by itself.
#include "bake/heat_weights.h"

#include "bake/skinning_weights.h"
#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/geodesic.h"
#include "geometry/robust_laplacian.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using geometry::SolveMesh;

const Vector<int> kHandles = {192, 193, 85, 92};

SolveMesh Blob() {
  SolveMesh mesh = test::MakeBlob(16, 12);
  geometry::ConnectComponents(&mesh);
  return mesh;
}

MatrixXd Weights(const SolveMesh& mesh, const Vector<int>& handles, int num_threads = 1) {
  Result<MatrixXd> weights = HeatWeights(mesh, handles, num_threads, {});
  EXPECT_TRUE(weights.ok()) << weights.status().message();
  return weights.ok() ? *weights
                      : MatrixXd::Zero(mesh.num_vertices(), Eigen::Index(handles.size()));
}

// The equation by its definition, dense, and neither clamped nor normalised.
MatrixXd SolveSlowly(const SolveMesh& mesh, const Vector<int>& handles) {
  const geometry::RobustLaplacian surface = geometry::MakeRobustLaplacian(mesh);
  const geometry::EdgeGraph graph(mesh);
  const int count = mesh.num_vertices();
  MatrixXd system = surface.laplacian, right = MatrixXd::Zero(count, Eigen::Index(handles.size()));
  MatrixXd distances(count, right.cols());
  for (size_t h = 0; h < handles.size(); ++h)
    distances.col(Eigen::Index(h)) = graph.Distances(std::array{handles[h]});
  for (int v = 0; v < count; ++v) {
    Eigen::Index nearest = 0;
    const double distance = distances.row(v).minCoeff(&nearest);
    if (distance == 0) {
      system.row(v) = Eigen::RowVectorXd::Unit(count, v);
      right(v, nearest) = 1;
    } else {
      system(v, v) += surface.areas(v) / (distance * distance);
      right(v, nearest) = surface.areas(v) / (distance * distance);
    }
  }
  return system.partialPivLu().solve(right);
}

// That the slow solution sums to one by itself is the maximum principle at work.
TEST(HeatWeights, AreTheEquationsSolution_WithinBoundsAndSummingToOne) {
  const SolveMesh mesh = Blob();
  const MatrixXd weights = Weights(mesh, kHandles), expected = SolveSlowly(mesh, kHandles);
  EXPECT_LT((expected.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-10);
  EXPECT_GE(expected.minCoeff(), -1e-12);
  EXPECT_LT((weights - expected).lpNorm<Eigen::Infinity>(), 1e-10);
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  for (size_t h = 0; h < kHandles.size(); ++h)
    EXPECT_EQ(weights.row(kHandles[h]), Eigen::RowVectorXd::Unit(4, Eigen::Index(h)));
}

TEST(HeatWeights, ScaleAndNumberOfThreads_ChangeNothing) {
  const SolveMesh mesh = Blob();
  SolveMesh large = mesh;
  for (auto& shape : large.shapes)
    shape *= 1000;
  const MatrixXd weights = Weights(mesh, kHandles);
  EXPECT_LT((Weights(large, kHandles) - weights).lpNorm<Eigen::Infinity>(), 1e-10);
  EXPECT_EQ(Weights(mesh, kHandles, 3), weights);
}

// They decrease away from their handle, and hardly pass another.
TEST(HeatWeights, Strip_DecreaseAlongItsLength) {
  const int length = 160;
  const SolveMesh mesh = test::MakeGrid(length, 1);
  const MatrixXd weights = Weights(mesh, {0, length / 2, length});
  for (int x = 1; x <= length / 2; ++x)
    EXPECT_LE(weights(x, 0), weights(x - 1, 0)) << x;
  // In one dimension, half way up to the middle: w'' = (w - 1) / x^2, whose solution is
  // 1 - c x^a with a (a - 1) = 1.
  const double a = 0.5 + std::sqrt(1.25);
  for (int x = 2; x <= length / 4; ++x)
    EXPECT_NEAR(weights(x, 0), 1 - 0.5 * std::pow(4.0 * x / length, a), 0.006) << x;
  EXPECT_LT(weights(length, 0), 0.02);
}

TEST(HeatWeights, BrokenMeshes_HaveThemToo) {
  SolveMesh mesh = Blob();
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 100});            // a fin
  mesh.shapes[0].row(30) = mesh.shapes[0].row(31);  // triangles without area
  mesh.shapes[0].row(86) = mesh.shapes[0].row(85);  // one on a handle
  const MatrixXd weights = Weights(mesh, kHandles);
  EXPECT_TRUE(weights.allFinite());
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  EXPECT_GT(weights(86, 2), 0.99);
}

TEST(HeatWeights, OneHandle_OwnsEverything) {
  EXPECT_EQ(Weights(Blob(), {7}).minCoeff(), 1);
}

TEST(HeatWeights, BadInput_IsRefused) {
  EXPECT_EQ(HeatWeights(Blob(), {}, 1, {}).status().code(), StatusCode::kNoHandles);
  EXPECT_EQ(HeatWeights(Blob(), std::array{3, 3}, 1, {}).status().code(),
            StatusCode::kInvalidArgument);
  const auto stop = [](const char*, double) { return false; };
  EXPECT_EQ(HeatWeights(Blob(), kHandles, 1, stop).status().message(), "cancelled");
}

}  // namespace
}  // namespace limber::bake
