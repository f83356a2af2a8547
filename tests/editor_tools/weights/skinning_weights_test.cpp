#include "bake/skinning_weights.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/cotangent.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using geometry::SolveMesh;

MatrixXd Weights(const SolveMesh& mesh, const Vector<int>& handles, int num_threads = 1) {
  WeightsReport report;
  Result<MatrixXd> weights = BoundedBiharmonicWeights(mesh, handles, num_threads, {}, &report);
  EXPECT_TRUE(weights.ok()) << weights.status().message();
  EXPECT_LE(report.bound_violation, 0);
  EXPECT_LE(report.stationarity, 1e-8);
  return weights.ok() ? *weights
                      : MatrixXd::Zero(mesh.num_vertices(), Eigen::Index(handles.size()));
}

void ExpectProper(const MatrixXd& weights, const Vector<int>& handles) {
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LE(weights.maxCoeff(), 1);
  EXPECT_LE((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  for (size_t h = 0; h < handles.size(); ++h) {
    EXPECT_EQ(weights.row(handles[h]),
              Eigen::RowVectorXd::Unit(weights.cols(), static_cast<Eigen::Index>(h)));
  }
}

SolveMesh Blob() {
  SolveMesh mesh = test::MakeBlob(16, 12);
  geometry::ConnectComponents(&mesh);
  return mesh;
}

const Vector<int> kBlobHandles = {192, 193, 85, 92};

// The bilaplacian energy by its definition, dense: sum over vertices of (L w)_v^2 / area_v, with
// the areas of Voronoi cells. For triangles without obtuse angles.
MatrixXd DenseForm(const SolveMesh& mesh) {
  const int count = mesh.num_vertices();
  MatrixXd laplacian = MatrixXd::Zero(count, count);
  VectorXd areas = VectorXd::Zero(count);
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const int o = triangle[corner], i = triangle[(corner + 1) % 3],
                j = triangle[(corner + 2) % 3];
      const Eigen::Vector3d a = mesh.shapes[0].row(i) - mesh.shapes[0].row(o);
      const Eigen::Vector3d b = mesh.shapes[0].row(j) - mesh.shapes[0].row(o);
      const double half_cotangent = 0.5 / std::tan(std::acos(a.dot(b) / (a.norm() * b.norm())));
      laplacian(i, i) += half_cotangent;
      laplacian(j, j) += half_cotangent;
      laplacian(i, j) -= half_cotangent;
      laplacian(j, i) -= half_cotangent;
      areas(i) += half_cotangent * (a - b).squaredNorm() / 4;
      areas(j) += half_cotangent * (a - b).squaredNorm() / 4;
    }
  }
  return laplacian * areas.cwiseInverse().asDiagonal() * laplacian;
}

// Weights of all handles by projected coordinate descent to the last digit.
MatrixXd SolveSlowly(const SolveMesh& mesh, const Vector<int>& handles) {
  const MatrixXd Q = DenseForm(mesh);
  MatrixXd weights = MatrixXd::Zero(mesh.num_vertices(), static_cast<Eigen::Index>(handles.size()));
  for (size_t h = 0; h < handles.size(); ++h) {
    VectorXd w = VectorXd::Zero(mesh.num_vertices());
    w(handles[h]) = 1;
    for (double change = 1; change > 1e-14;) {
      change = 0;
      for (int v = 0; v < mesh.num_vertices(); ++v) {
        if (std::find(handles.begin(), handles.end(), v) != handles.end()) continue;
        const double moved = std::clamp(w(v) - Q.row(v).dot(w) / Q(v, v), 0.0, 1.0);
        change = std::max(change, std::abs(moved - w(v)));
        w(v) = moved;
      }
    }
    weights.col(static_cast<Eigen::Index>(h)) = w;
  }
  for (Eigen::Index v = 0; v < weights.rows(); ++v)
    weights.row(v) /= weights.row(v).sum();
  return weights;
}

TEST(BoundedBiharmonicWeights, AreBoundedPartitionUnityAndPeakAtTheirHandles) {
  ExpectProper(Weights(Blob(), kBlobHandles), kBlobHandles);
  const SolveMesh grid = test::MakeGrid(15, 11);
  const Vector<int> corners = {0, 15, 16 * 11, 16 * 12 - 1, 88};
  ExpectProper(Weights(grid, corners), corners);
}

TEST(BoundedBiharmonicWeights, AgreeWithCoordinateDescentOnTheDefinition) {
  // Sheared so that all triangles are equilateral and no cotangent is clamped.
  SolveMesh mesh = test::MakeGrid(7, 5);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const double x = mesh.shapes[0](v, 0), y = mesh.shapes[0](v, 1);
    mesh.shapes[0].row(v) << x - 0.5 * y, std::sqrt(0.75) * y, 0.1 * std::sin(x);
  }
  const Vector<int> handles = {1, 14, 26, 45};
  const MatrixXd expected = SolveSlowly(mesh, handles);
  EXPECT_GT((expected.array() == 0).count(), 12);  // the bounds are at work
  EXPECT_LT((Weights(mesh, handles) - expected).lpNorm<Eigen::Infinity>(), 1e-6);
}

TEST(BoundedBiharmonicWeights, Strip_BlendsAlongItsLength) {
  // In one dimension: a curve of least integrated squared second derivative from 0 to 1. Nothing
  // flows over the ends (the Laplacian's natural boundary), so it starts and arrives level, and is
  // the cubic 3 t^2 - 2 t^3.
  const int length = 40;
  const SolveMesh mesh = test::MakeGrid(length, 1);
  const MatrixXd weights = Weights(mesh, {0, length});
  for (int x = 0; x <= length; ++x) {
    const double t = double(x) / length, cubic = t * t * (3 - 2 * t);
    EXPECT_NEAR(weights(x, 1), cubic, 2e-3);
    EXPECT_NEAR(weights(x + length + 1, 1), cubic, 2e-3);
  }
}

TEST(BoundedBiharmonicWeights, RigidMotionAndScale_ChangeNothing) {
  const SolveMesh mesh = Blob();
  const MatrixXd reference = Weights(mesh, kBlobHandles);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SolveMesh moved = mesh;
    moved.shapes[0] =
        (scale * mesh.shapes[0] * rotation).rowwise() + scale * Eigen::RowVector3d(3, -2, 5);
    EXPECT_LT((Weights(moved, kBlobHandles) - reference).lpNorm<Eigen::Infinity>(), 1e-6);
  }
}

TEST(BoundedBiharmonicWeights, VertexOrder_ChangesNothing) {
  const SolveMesh mesh = Blob();
  const MatrixXd reference = Weights(mesh, kBlobHandles);
  const Vector<int> order = test::Shuffle(mesh.num_vertices(), 5);
  Vector<int> handles;
  for (const int v : kBlobHandles)
    handles.push_back(order[v]);
  const MatrixXd shuffled = Weights(test::Renumbered(mesh, order), handles);
  double largest = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    largest = std::max(largest, (shuffled.row(order[v]) - reference.row(v)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(largest, 1e-6);
}

TEST(BoundedBiharmonicWeights, NumberOfThreads_ChangesNoBit) {
  const SolveMesh mesh = Blob();
  const MatrixXd reference = Weights(mesh, kBlobHandles, 1);
  EXPECT_EQ(Weights(mesh, kBlobHandles, 2), reference);
  EXPECT_EQ(Weights(mesh, kBlobHandles, 4), reference);
  EXPECT_EQ(Weights(mesh, kBlobHandles, 0), reference);
}

TEST(BoundedBiharmonicWeights, HandleBehindAnother_HasNoInfluenceThere) {
  // Three handles in a row: nothing of the first arrives beyond the third.
  const int length = 60;
  const SolveMesh mesh = test::MakeGrid(length, 3);
  const int middle = length + 1;
  const MatrixXd weights = Weights(mesh, {middle, middle + 20, middle + 40});
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const int x = v % (length + 1);
    if (x > 45) {
      EXPECT_LT(weights(v, 0), 1e-2);
    }
    if (x > 55) {
      EXPECT_GT(weights(v, 2), 0.99);
    }
  }
}

TEST(BoundedBiharmonicWeights, PartWithoutAHandle_FollowsWhatItSitsIn) {
  // An eye near one end of a bar takes that end's weights, nearly rigidly.
  SolveMesh mesh = test::MakeGrid(20, 4);
  SolveMesh eye = test::MakeBlob(8, 6);
  eye.shapes[0] *= 0.5;
  test::Append(eye, {17, 2, 0.3}, &mesh);
  geometry::ConnectComponents(&mesh);
  ASSERT_EQ(mesh.num_components, 2);
  const Vector<int> handles = {42, 62};  // the ends of the middle line
  const MatrixXd weights = Weights(mesh, handles);
  ExpectProper(weights, handles);
  const double below = weights(2 * 21 + 17, 1);
  EXPECT_GT(below, 0.7);
  for (int v = 105; v < mesh.num_vertices(); ++v)
    EXPECT_NEAR(weights(v, 1), below, 0.1);
}

TEST(BoundedBiharmonicWeights, OneHandle_OwnsEverything) {
  EXPECT_EQ(Weights(Blob(), {7}), MatrixXd::Ones(194, 1));
}

TEST(BoundedBiharmonicWeights, EveryVertexAHandle_IsTheIdentity) {
  EXPECT_EQ(Weights(test::MakeGrid(1, 1), {0, 1, 2, 3}), MatrixXd::Identity(4, 4));
}

TEST(BoundedBiharmonicWeights, DegenerateTriangles_StillReachTheOptimum) {
  SolveMesh mesh = Blob();
  mesh.shapes[0].row(40) = mesh.shapes[0].row(41);
  mesh.shapes[0].row(60) = 0.5 * (mesh.shapes[0].row(59) + mesh.shapes[0].row(61));
  mesh.triangles.push_back({59, 60, 61});
  ExpectProper(Weights(mesh, kBlobHandles), kBlobHandles);
}

TEST(BoundedBiharmonicWeights, BadInput_IsRefusedWithAReason) {
  const SolveMesh mesh = Blob();
  WeightsReport report;
  const auto solve = [&](const SolveMesh& on, const Vector<int>& handles) {
    return BoundedBiharmonicWeights(on, handles, 1, {}, &report).status();
  };
  EXPECT_EQ(solve(mesh, {}).code(), StatusCode::kNoHandles);
  EXPECT_EQ(solve(mesh, {3, 3}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(solve(mesh, {3, 194}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(solve(mesh, {-1}).code(), StatusCode::kInvalidArgument);
  SolveMesh apart = mesh;
  test::Append(mesh, {5, 0, 0}, &apart);
  EXPECT_EQ(solve(apart, {3, 9}).code(), StatusCode::kDegenerate);
  SolveMesh broken = mesh;
  broken.shapes[0](4, 1) = std::nan("");
  EXPECT_EQ(solve(broken, {3, 9}).code(), StatusCode::kDegenerate);
}

TEST(BoundedBiharmonicWeights, Cancelled_EndsWithThatAndOnTheCallersThread) {
  const std::thread::id caller = std::this_thread::get_id();
  WeightsReport report;
  for (int allowed : {0, 1}) {
    const auto progress = [&](const char* stage, double) {
      EXPECT_STREQ(stage, "weights");
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return allowed-- > 0;
    };
    const SolveMesh mesh = test::MakeGrid(60, 40);
    const Status status =
        BoundedBiharmonicWeights(mesh, Vector<int>{0, 60, 1000, 2000}, 2, progress, &report)
            .status();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(status.message(), "cancelled");
  }
}

}  // namespace
}  // namespace limber::bake
