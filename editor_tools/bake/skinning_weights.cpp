#include "bake/skinning_weights.h"

#include "bake/handle_solver.h"
#include "bake/quadratic_problem.h"
#include "bake/weight_rows.h"
#include "bake/weight_supports.h"
#include "core/vector.h"
#include "geometry/robust_laplacian.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;

constexpr double kNegligibleWeight = 1e-7;  // becomes zero before rows are normalised

Status CheckOptimality(const Vector<BoundedQuadraticReport>& reports) {
  for (size_t h = 0; h < reports.size(); ++h) {
    const BoundedQuadraticReport& report = reports[h];
    if (report.converged || report.stationarity <= kUsableStationarity) continue;
    return Error(StatusCode::kDegenerate,
                 "skinning weights: handle %zu: no optimum within %d iterations (residual %.3g, "
                 "gap %.3g); check the mesh around it for degenerate triangles",
                 h, report.iterations, report.stationarity, report.gap);
  }
  return {};
}

// (Bounded weights need not sum to one by themselves; a row far from all handles may be zero.)
void NormaliseRows(const geometry::SolveMesh& mesh, WeightsReport* report, MatrixXd* weights) {
  for (double& weight : weights->reshaped()) {
    report->bound_violation = std::max({report->bound_violation, -weight, weight - 1});
    weight = weight < kNegligibleWeight ? 0 : std::min(weight, 1.0);
  }
  report->sum_error = (weights->rowwise().sum().array() - 1).abs().maxCoeff();
  CompleteRows(mesh, weights);
}

}  // namespace

Result<MatrixXd> BoundedBiharmonicWeights(const geometry::SolveMesh& mesh,
                                          std::span<const int> handle_vertices, int num_threads,
                                          const ProgressCallback& progress, WeightsReport* report) {
  *report = {};
  LIMBER_RETURN_IF_ERROR(CheckWeightInput(mesh, handle_vertices));
  const auto num_handles = static_cast<Eigen::Index>(handle_vertices.size());
  if (num_handles == 1) return MatrixXd(MatrixXd::Ones(mesh.num_vertices(), 1));
  if (num_threads <= 0) {
    num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  }
  if (progress && !progress("weights", 0)) return Error(StatusCode::kInvalidArgument, "cancelled");
  const geometry::RobustLaplacian surface = geometry::MakeRobustLaplacian(mesh);
  const WeightSupports supports(surface, handle_vertices, num_threads);
  const QuadraticProblem problem =
      SplitOffHandles(BiharmonicForm(surface.laplacian, surface.areas), handle_vertices);
  HandleSolver solver(problem, supports);
  LIMBER_RETURN_IF_ERROR(solver.Run(num_threads, progress));
  LIMBER_RETURN_IF_ERROR(CheckOptimality(solver.reports()));

  MatrixXd weights = MatrixXd::Zero(mesh.num_vertices(), num_handles);
  for (size_t i = 0; i < problem.free_vertices.size(); ++i) {
    weights.row(problem.free_vertices[i]) = solver.solutions().row(static_cast<Eigen::Index>(i));
  }
  for (Eigen::Index h = 0; h < num_handles; ++h)
    weights(handle_vertices[h], h) = 1;
  for (const BoundedQuadraticReport& solved : solver.reports()) {
    report->handles.push_back(
        {solved.iterations, solved.converged, solved.stationarity, solved.gap});
    report->stationarity = std::max(report->stationarity, solved.stationarity);
    report->complementarity = std::max(report->complementarity, solved.gap);
  }
  NormaliseRows(mesh, report, &weights);
  return weights;
}

}  // namespace limber::bake
