#include "deform/inversion_free/full_energy.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <utility>

namespace limber::deform {
namespace {

// (p'(a) - p'(b)) / (a - b), which is p'' where they coincide.
double SlopeQuotient(const PenaltyValue& a, const PenaltyValue& b, double difference, double size) {
  if (std::abs(difference) <= 1e-8 * size) return 0.5 * (a.curvature + b.curvature);
  return (a.slope - b.slope) / difference;
}

}  // namespace

template <int D>
Result<FullEnergy<D>> FullEnergy<D>::Create(InversionFreeProblem<D> problem,
                                            const InversionFreeOptions& options) {
  auto rest = MeasureRest(problem.mesh);
  if (!rest.ok()) return rest.status();
  const Status checked = CheckProblem(problem, options);
  if (!checked.ok()) return checked;
  FullEnergy energy;
  energy.weights_ = WeightsOf(*rest, options.weights);
  energy.rest_ = std::move(rest).value();
  energy.problem_ = std::move(problem);
  energy.options_ = options;
  return energy;
}

template <int D>
typename FullEnergy<D>::Gradient FullEnergy<D>::DeformationGradient(const Positions& x,
                                                                    size_t element) const {
  return Corners<D>(x, problem_.mesh.elements[element]) * rest_[element].gradients.transpose();
}

template <int D>
StretchEigen<D> FullEnergy<D>::StretchOf(const Positions& x, size_t element) const {
  const Gradient turned_back =
      problem_.rotations[element].transpose() * DeformationGradient(x, element);
  const Gradient stretch = 0.5 * (turned_back + turned_back.transpose());
  const Eigen::SelfAdjointEigenSolver<Gradient> eigen(stretch);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

template <int D>
typename FullEnergy<D>::Gradient FullEnergy<D>::Multiplier(const StretchEigen<D>& stretch,
                                                           double tau) const {
  Gradient sum = Gradient::Zero();
  for (int j = 0; j < D; ++j) {
    const double slope =
        EvaluatePenalty(options_.penalty, stretch.values[j], tau, options_.smallest_stretch).slope;
    sum -= slope * stretch.vectors.col(j) * stretch.vectors.col(j).transpose();
  }
  return sum;
}

template <int D>
double FullEnergy<D>::Value(const Positions& x, double tau) const {
  double energy = 0;
  for (size_t i = 0; i < rest_.size(); ++i) {
    const Gradient f = DeformationGradient(x, i), &r = problem_.rotations[i];
    const double trace = (r.transpose() * f).trace() - D;
    energy +=
        weights_[i] * ((f - r).squaredNorm() + 0.5 * options_.incompressibility * trace * trace);
    if (tau == 0) continue;
    const StretchEigen<D> stretch = StretchOf(x, i);
    for (int j = 0; j < D; ++j) {
      energy += EvaluatePenalty(options_.penalty, stretch.values[j], tau, options_.smallest_stretch)
                    .value;
    }
  }
  for (size_t c = 0; c < problem_.target_vertices.size(); ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    energy += options_.target_weight *
              (x.row(problem_.target_vertices[c]) - problem_.targets.row(row)).squaredNorm();
  }
  return energy;
}

template <int D>
Eigen::VectorXd FullEnergy<D>::GradientAt(const Positions& x, double tau) const {
  Positions gradient = Positions::Zero(x.rows(), D);
  for (size_t i = 0; i < rest_.size(); ++i) {
    const Gradient f = DeformationGradient(x, i), &r = problem_.rotations[i];
    const double trace = (r.transpose() * f).trace() - D;
    Gradient stress = weights_[i] * (2 * (f - r) + options_.incompressibility * trace * r);
    if (tau > 0) stress -= r * Multiplier(StretchOf(x, i), tau);
    for (int a = 0; a <= D; ++a) {
      gradient.row(problem_.mesh.elements[i][static_cast<size_t>(a)]) +=
          (stress * rest_[i].gradients.col(a)).transpose();
    }
  }
  for (size_t c = 0; c < problem_.target_vertices.size(); ++c) {
    const int v = problem_.target_vertices[c];
    gradient.row(v) += 2 * options_.target_weight *
                       (x.row(v) - problem_.targets.row(static_cast<Eigen::Index>(c)));
  }
  return Eigen::Map<const Eigen::VectorXd>(gradient.data(), gradient.size());
}

template <int D>
typename FullEnergy<D>::Block FullEnergy<D>::ElementHessian(const Positions& x, size_t element,
                                                            double tau) const {
  const auto& g = rest_[element].gradients;
  const Gradient& r = problem_.rotations[element];
  const double w = weights_[element];
  Block block = Block::Zero();
  for (int a = 0; a <= D; ++a) {
    for (int b = 0; b <= D; ++b) {
      block.template block<D, D>(a * D, b * D)
          .diagonal()
          .setConstant(2 * w * g.col(a).dot(g.col(b)));
    }
  }
  // A change of M by each corner's position, for M in the space of F.
  const auto dofs = [&g](const Gradient& m) {
    Dofs of;
    for (int a = 0; a <= D; ++a)
      of.template segment<D>(a * D) = m * g.col(a);
    return of;
  };
  const Dofs traces = dofs(r);
  block += w * options_.incompressibility * traces * traces.transpose();
  if (tau == 0) return block;
  const StretchEigen<D> stretch = StretchOf(x, element);
  std::array<PenaltyValue, D> p;
  for (int j = 0; j < D; ++j) {
    p[static_cast<size_t>(j)] =
        EvaluatePenalty(options_.penalty, stretch.values[j], tau, options_.smallest_stretch);
  }
  const double size = stretch.values.cwiseAbs().maxCoeff();
  for (int j = 0; j < D; ++j) {
    for (int k = j; k < D; ++k) {
      const double quotient =
          j == k ? p[static_cast<size_t>(j)].curvature
                 : 2 * SlopeQuotient(p[static_cast<size_t>(j)], p[static_cast<size_t>(k)],
                                     stretch.values[j] - stretch.values[k], size);
      const Gradient product = stretch.vectors.col(j) * stretch.vectors.col(k).transpose();
      const Dofs change = dofs(r * (0.5 * (product + product.transpose())));
      block += quotient * change * change.transpose();
    }
  }
  return block;
}

template <int D>
Eigen::SparseMatrix<double> FullEnergy<D>::HessianAt(const Positions& x, double tau) const {
  Vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(rest_.size() * size_t{Block::SizeAtCompileTime});
  for (size_t i = 0; i < rest_.size(); ++i) {
    const Block block = ElementHessian(x, i, tau);
    const auto& corners = problem_.mesh.elements[i];
    for (int row = 0; row < block.rows(); ++row) {
      for (int column = 0; column < block.cols(); ++column) {
        triplets.emplace_back(corners[static_cast<size_t>(row / D)] * D + row % D,
                              corners[static_cast<size_t>(column / D)] * D + column % D,
                              block(row, column));
      }
    }
  }
  for (const int v : problem_.target_vertices) {
    for (int axis = 0; axis < D; ++axis)
      triplets.emplace_back(v * D + axis, v * D + axis, 2 * options_.target_weight);
  }
  Eigen::SparseMatrix<double> hessian(x.size(), x.size());
  hessian.setFromTriplets(triplets.begin(), triplets.end());
  return hessian;
}

template class FullEnergy<2>;
template class FullEnergy<3>;

}  // namespace limber::deform
