#include "bake/edge_groups.h"
#include "bake/skinning_weights.h"
#include "core/vector.h"
#include "editor_tools/weights/read_obj.h"
#include "geometry/bridges.h"
#include "geometry/extremities.h"
#include "geometry/weld.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace limber::bake {
namespace {

TEST(HorseWeights, TenHandles_ReachTheOptimum) {
  const std::filesystem::path folder = test::SharedDataFolder();
  if (folder.empty()) GTEST_SKIP() << "the shared data folder is absent (LIMBER_DATA_DIR)";
  const test::ObjMesh horse = test::ReadObj(folder / "horse" / "horse_ref.obj");
  if (horse.points.rows() == 0) GTEST_SKIP() << "horse/horse_ref.obj is absent";

  geometry::SolveMesh mesh = geometry::WeldMesh(std::span(&horse.points, 1), horse.triangles, 0);
  geometry::ConnectComponents(&mesh);
  ASSERT_EQ(mesh.num_vertices(), 8431);
  EXPECT_EQ(mesh.num_components, 1);
  const Vector<int> handles = geometry::SpreadPoints(mesh, 10);
  ASSERT_EQ(handles.size(), 10U);
  WeightsReport report;
  double last_fraction = -1;
  const auto progress = [&last_fraction](const char*, double fraction) {
    EXPECT_GE(fraction, last_fraction);
    EXPECT_LE(fraction, 1);
    last_fraction = fraction;
    return true;
  };
  const Result<Eigen::MatrixXd> weights =
      BoundedBiharmonicWeights(mesh, handles, 0, progress, &report);
  ASSERT_TRUE(weights.ok()) << weights.status().message();
  EXPECT_LE(report.bound_violation, 0);
  EXPECT_LE(report.stationarity, 1e-8);
  EXPECT_LE(report.sum_error, 0.5);
  EXPECT_GE(weights->minCoeff(), 0);
  EXPECT_LE(weights->maxCoeff(), 1);
  EXPECT_LE((weights->rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  for (size_t h = 0; h < handles.size(); ++h) {
    EXPECT_EQ(weights->row(handles[h]), Eigen::RowVectorXd::Unit(10, static_cast<Eigen::Index>(h)));
  }
  // The bounds are at work: part of the weights is exactly zero.
  EXPECT_GT((weights->array() == 0).cast<double>().mean(), 0.05);

  int num_groups = 0;
  ClusterVertices(*weights, 20, &num_groups);
  EXPECT_EQ(num_groups, 20);
}

}  // namespace
}  // namespace limber::bake
