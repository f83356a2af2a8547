#include "deform/inversion_free/solve_report.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::deform {

template <int D>
void Measure(const FullEnergy<D>& energy, const InversionFreeOptions& options,
             const typename SimplexMesh<D>::Positions& x, double tau, InversionFreeReport* report) {
  using Matrix = Eigen::Matrix<double, D, D>;
  report->energy = energy.Value(x, 0);
  report->smallest_stretch = report->smallest_volume = std::numeric_limits<double>::infinity();
  report->num_inverted = 0;
  report->dual_violation = 0;
  double slack = 0;
  for (size_t i = 0; i < energy.rest().size(); ++i) {
    const double volume = energy.DeformationGradient(x, i).determinant();
    const StretchEigen<D> stretch = energy.StretchOf(x, i);
    const Matrix multiplier = energy.Multiplier(stretch, tau);
    report->smallest_volume = std::min(report->smallest_volume, volume);
    report->smallest_stretch = std::min(report->smallest_stretch, stretch.values[0]);
    if (!(volume > 0)) ++report->num_inverted;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(multiplier, Eigen::EigenvaluesOnly);
    report->dual_violation = std::max(report->dual_violation, -eigen.eigenvalues()[0]);
    const Matrix beyond =
        stretch.vectors * stretch.values.asDiagonal() * stretch.vectors.transpose() -
        options.smallest_stretch * Matrix::Identity();
    slack += (multiplier * beyond).trace();
  }
  report->primal_violation = std::max(0.0, options.smallest_stretch - report->smallest_stretch);
  report->feasible = report->smallest_stretch >= 0.5 * options.smallest_stretch;
  // The gradient of E(x, tau) is that of the Lagrangian at those multipliers.
  report->stationarity = energy.GradientAt(x, tau).cwiseAbs().maxCoeff();
  report->duality_gap = std::abs(slack) / std::max(report->energy, 1e-300);
  report->target_miss = 0;
  const auto& problem = energy.problem();
  for (size_t c = 0; c < problem.target_vertices.size(); ++c) {
    const double miss =
        (x.row(problem.target_vertices[c]) - problem.targets.row(static_cast<Eigen::Index>(c)))
            .norm();
    report->target_miss = std::max(report->target_miss, miss);
  }
}

template void Measure(const FullEnergy<2>&, const InversionFreeOptions&,
                      const TriangleMesh::Positions&, double, InversionFreeReport*);
template void Measure(const FullEnergy<3>&, const InversionFreeOptions&, const TetMesh::Positions&,
                      double, InversionFreeReport*);

}  // namespace limber::deform
