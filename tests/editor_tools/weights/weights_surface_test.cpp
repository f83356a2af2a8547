// Weights belong to the surface: not to how finely it is cut, nor to how its triangles are stored.
#include "bake/skinning_weights.h"
#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using geometry::SolveMesh;

MatrixXd Weights(SolveMesh mesh, const Vector<int>& handles) {
  geometry::ConnectComponents(&mesh);
  WeightsReport report;
  Result<MatrixXd> weights = BoundedBiharmonicWeights(mesh, handles, 0, {}, &report);
  EXPECT_TRUE(weights.ok()) << weights.status().message();
  EXPECT_LE(report.stationarity, 1e-8);
  return weights.ok() ? *weights
                      : MatrixXd::Zero(mesh.num_vertices(), Eigen::Index(handles.size()));
}

constexpr int kAround = 12, kRings = 7;

// The same smooth surface, each edge cut `cuts` times; coarse vertex v is vertex FineVertex(v).
SolveMesh Cut(int cuts) {
  return test::MakeBlob(kAround * cuts, (kRings + 1) * cuts - 1);
}

int FineVertex(int v, int cuts) {
  const int around = kAround * cuts, rings = (kRings + 1) * cuts - 1;
  if (v >= kAround * kRings) return around * rings + v - kAround * kRings;
  return ((v / kAround + 1) * cuts - 1) * around + v % kAround * cuts;
}

MatrixXd AtCoarseVertices(int cuts, const Vector<int>& handles) {
  Vector<int> fine_handles;
  for (const int v : handles)
    fine_handles.push_back(FineVertex(v, cuts));
  const MatrixXd weights = Weights(Cut(cuts), fine_handles);
  MatrixXd rows(kAround * kRings + 2, weights.cols());
  for (int v = 0; v < rows.rows(); ++v)
    rows.row(v) = weights.row(FineVertex(v, cuts));
  return rows;
}

TEST(WeightsOfASurface, ConvergeAsItIsCutFiner) {
  const Vector<int> handles = {kAround * kRings, kAround * kRings + 1, 38, 44, 5};
  const MatrixXd finest = AtCoarseVertices(8, handles);
  Vector<double> errors;
  for (const int cuts : {1, 2, 4})
    errors.push_back((AtCoarseVertices(cuts, handles) - finest).lpNorm<Eigen::Infinity>());
  EXPECT_GT(errors[0], 0.01) << "the coarse one is coarse";
  EXPECT_LT(errors[1], 0.5 * errors[0]);
  EXPECT_LT(errors[2], 0.5 * errors[1]);
  EXPECT_LT(errors[2], 0.02);
}

// Every triangle with corners of its own, as some exporters write them, is the same surface.
TEST(WeightsOfASurface, StoredInLoosePieces_AreTheSame) {
  const SolveMesh mesh = test::MakeBlob(16, 12);
  const Vector<int> handles = {192, 193, 85, 92};
  Vector<uint32_t> triangles;
  geometry::PointMatrix points(3 * Eigen::Index(mesh.triangles.size()), 3);
  Vector<int> source;
  for (const auto& triangle : mesh.triangles) {
    for (const int v : triangle) {
      points.row(Eigen::Index(triangles.size())) = mesh.shapes[0].row(v);
      triangles.push_back(uint32_t(triangles.size()));
      source.push_back(v);
    }
  }
  const SolveMesh welded = geometry::WeldMesh(Vector<decltype(points)>{points}, triangles, 1e-6);
  ASSERT_EQ(welded.num_vertices(), mesh.num_vertices());
  Vector<int> welded_of(static_cast<size_t>(mesh.num_vertices()));
  for (size_t d = 0; d < source.size(); ++d)
    welded_of[size_t(source[d])] = int(welded.solve_vertex[d]);
  Vector<int> welded_handles;
  for (const int v : handles)
    welded_handles.push_back(welded_of[size_t(v)]);
  const MatrixXd expected = Weights(mesh, handles), weights = Weights(welded, welded_handles);
  for (int v = 0; v < mesh.num_vertices(); ++v)
    EXPECT_LT((weights.row(welded_of[size_t(v)]) - expected.row(v)).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace limber::bake
