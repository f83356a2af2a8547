// Weights cut down to a few handles a vertex.
#include "bake/influences.h"

#include "bake/bake.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace limber::bake {
namespace {

Eigen::MatrixXd RandomWeights(int rows, int handles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(0, 1);
  Eigen::MatrixXd weights(rows, handles);
  for (int v = 0; v < rows; ++v) {
    for (int h = 0; h < handles; ++h)
      weights(v, h) = number(random);
    weights.row(v) /= weights.row(v).sum();
  }
  return weights;
}

TEST(PruneInfluences, KeepsTheLargestInTheirProportions) {
  const Eigen::MatrixXd before = RandomWeights(200, 9);
  Eigen::MatrixXd weights = before;
  const InfluenceReport report = PruneInfluences(4, &weights);
  double largest = 0, squares = 0;
  for (int v = 0; v < 200; ++v) {
    EXPECT_NEAR(weights.row(v).sum(), 1, 1e-14);
    EXPECT_EQ((weights.row(v).array() > 0).count(), 4);
    double smallest_kept = 1, largest_cut = 0, kept_sum = 0;
    for (int h = 0; h < 9; ++h) {
      if (weights(v, h) > 0) {
        smallest_kept = std::min(smallest_kept, before(v, h));
        kept_sum += before(v, h);
      } else {
        largest_cut = std::max(largest_cut, before(v, h));
      }
    }
    EXPECT_GE(smallest_kept, largest_cut);
    for (int h = 0; h < 9; ++h) {
      if (weights(v, h) > 0) {
        EXPECT_NEAR(weights(v, h), before(v, h) / kept_sum, 1e-14);
      }
    }
    largest = std::max(largest, (weights.row(v) - before.row(v)).cwiseAbs().maxCoeff());
    squares += (weights.row(v) - before.row(v)).squaredNorm();
  }
  EXPECT_EQ(report.kept, 4);
  EXPECT_EQ(report.most, 9);
  EXPECT_EQ(report.cut_vertices, 200);
  EXPECT_DOUBLE_EQ(report.largest_change, largest);
  EXPECT_NEAR(report.rms_change, std::sqrt(squares / 200), 1e-14);
}

TEST(PruneInfluences, EqualWeights_TheFirstHandlesStay) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Constant(1, 4, 0.25);
  PruneInfluences(2, &weights);
  EXPECT_EQ(weights, (Eigen::MatrixXd(1, 4) << 0.5, 0.5, 0, 0).finished());
}

TEST(PruneInfluences, RowsWithFewEnough_KeepTheirBits) {
  Eigen::MatrixXd weights(2, 3);
  weights << 1, 0, 0, 0.3, 0.7, 0;
  const Eigen::MatrixXd before = weights;
  const InfluenceReport report = PruneInfluences(2, &weights);
  EXPECT_EQ(weights, before);
  EXPECT_EQ(report.cut_vertices, 0);
  EXPECT_EQ(report.largest_change, 0);
  for (const int all : {0, 3, 10}) {
    Eigen::MatrixXd random = RandomWeights(20, 3);
    const Eigen::MatrixXd same = random;
    EXPECT_EQ(PruneInfluences(all, &random).kept, 0);
    EXPECT_EQ(random, same);
  }
}

// What the skin is drawn with, and what the tensors were summed over: the handles' own vertices
// still follow them alone, and the model still finds each example at its own handles.
TEST(PruneInfluences, InABake_HandlesKeepWeightOne) {
  const RawCharacter raw = test::MakeBendCylinder(16, 20);
  BakeOptions options;
  options.influences = 2;
  const auto baked = Bake(raw, raw.marked_handles, options, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  EXPECT_GT(baked->influences.cut_vertices, 0);
  EXPECT_EQ(baked->influences.most, 3);
  const auto num_handles = static_cast<size_t>(baked->mesh.num_handles);
  for (size_t h = 0; h < num_handles; ++h) {
    EXPECT_EQ(baked->mesh.weights[baked->tables.handles[h].vertex * num_handles + h], 1.0f);
  }
  for (size_t v = 0; v < baked->mesh.num_solve_vertices; ++v) {
    int count = 0;
    for (size_t h = 0; h < num_handles; ++h)
      count += baked->mesh.weights[v * num_handles + h] != 0;
    EXPECT_LE(count, 2);
  }
}

}  // namespace
}  // namespace limber::bake
