#include "deform/inversion_free/interior_point.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace limber::deform {
namespace {

constexpr double kToTheBorder = 0.98;     // of the way to where a matrix turns singular
constexpr double kLeastSlack = 0.3;       // eigenvalues of the first Y
constexpr double kFirstComplement = 1.0;  // of the first Y Z
constexpr double kLeastSquare = 1e-30;    // of a lambda: below is rounding
constexpr double kLeastEnergy = 1e-6;     // of an element, for the relative gap

// An order of elimination of vertices, with all coordinates of one in a row.
template <int D>
linear::Elimination EliminateVertices(const SimplexMesh<D>& mesh,
                                      const Eigen::SparseMatrix<double>& hessian) {
  Vector<Eigen::Triplet<double>> pairs;
  for (const auto& element : mesh.elements) {
    for (const int a : element) {
      for (const int b : element)
        pairs.emplace_back(a, b, 1);
    }
  }
  Eigen::SparseMatrix<double> graph(mesh.num_vertices(), mesh.num_vertices());
  graph.setFromTriplets(pairs.begin(), pairs.end());
  const linear::Elimination vertices = linear::EliminateInGoodOrder(graph);
  Vector<int> order;
  for (const int place : vertices.new_of_old) {
    for (int axis = 0; axis < D; ++axis)
      order.push_back(place * D + axis);
  }
  return linear::Eliminate(hessian, order);
}

int PlaceOf(const Eigen::SparseMatrix<double>& matrix, int row, int column) {
  const int* first = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
  const int* last = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - matrix.innerIndexPtr());
}

template <class Matrix>
Matrix Symmetric(const Matrix& m) {
  return 0.5 * (m + m.transpose());
}

// How far diag(scaled) can go along `step` before it is singular; 1 at most.
template <class Matrix, class Scaled>
double LengthTo(const Scaled& scaled, const Matrix& step) {
  const Scaled root = scaled.cwiseSqrt().cwiseInverse();
  const Matrix relative = root.asDiagonal() * step * root.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(relative, Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues()[0];
  return least < 0 ? std::min(1.0, -kToTheBorder / least) : 1;
}

}  // namespace

template <int D>
InteriorPoint<D>::InteriorPoint(const FullEnergy<D>& energy, double smallest_stretch)
    : energy_(energy),
      smallest_stretch_(smallest_stretch),
      hessian_(energy.HessianAt(Positions::Zero(energy.problem().mesh.num_vertices(), D), 0)),
      gradient_at_zero_(
          energy.GradientAt(Positions::Zero(energy.problem().mesh.num_vertices(), D), 0)),
      cholesky_(hessian_, EliminateVertices(energy.problem().mesh, hessian_)),
      constraints_(energy.rest().size()) {
  for (const auto& element : energy.problem().mesh.elements) {
    auto& places = places_.emplace_back();
    size_t next = 0;
    for (int row = 0; row < kDofs; ++row) {
      for (int column = 0; column < kDofs; ++column) {
        places[next++] = PlaceOf(hessian_, element[static_cast<size_t>(row / D)] * D + row % D,
                                 element[static_cast<size_t>(column / D)] * D + column % D);
      }
    }
  }
}

template <int D>
typename InteriorPoint<D>::Matrix InteriorPoint<D>::StretchAt(const Positions& x,
                                                              size_t element) const {
  const Matrix turned_back =
      energy_.problem().rotations[element].transpose() * energy_.DeformationGradient(x, element);
  return Symmetric(turned_back) - smallest_stretch_ * Matrix::Identity();
}

template <int D>
typename InteriorPoint<D>::Matrix InteriorPoint<D>::StretchStep(const Eigen::VectorXd& step,
                                                                size_t element) const {
  const auto& corners = energy_.problem().mesh.elements[element];
  Matrix change = Matrix::Zero();
  for (int a = 0; a <= D; ++a) {
    change += step.template segment<D>(corners[static_cast<size_t>(a)] * D) *
              energy_.rest()[element].gradients.col(a).transpose();
  }
  const Matrix turned_back = energy_.problem().rotations[element].transpose() * change;
  return Symmetric(turned_back);
}

template <int D>
void InteriorPoint<D>::AddAdjoint(const Matrix& z, size_t element,
                                  Eigen::VectorXd* gradient) const {
  const Matrix stress = energy_.problem().rotations[element] * z;
  const auto& corners = energy_.problem().mesh.elements[element];
  for (int a = 0; a <= D; ++a) {
    gradient->template segment<D>(corners[static_cast<size_t>(a)] * D) +=
        stress * energy_.rest()[element].gradients.col(a);
  }
}

template <int D>
void InteriorPoint<D>::Begin(const Positions& x) {
  for (size_t i = 0; i < constraints_.size(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(StretchAt(x, i));
    const auto values = eigen.eigenvalues().cwiseMax(kLeastSlack).eval();
    const Matrix& v = eigen.eigenvectors();
    constraints_[i].slack = v * values.asDiagonal() * v.transpose();
    constraints_[i].multiplier =
        kFirstComplement * v * values.cwiseInverse().asDiagonal() * v.transpose();
  }
}

// Y = L L^T, L^T Z L = V diag(lambda)^2 V^T: then G^-1 = diag(lambda)^1/2 V^T L^-1. Near the path
// all lambda are about sqrt(mu), so that the square costs them no digits that matter.
template <int D>
void InteriorPoint<D>::Scale(Constraint* constraint) const {
  const Matrix root = constraint->slack.llt().matrixL();
  const Matrix product = root.transpose() * constraint->multiplier * root;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(product);
  constraint->scaled = eigen.eigenvalues().cwiseMax(kLeastSquare).cwiseSqrt();
  constraint->unscale = constraint->scaled.cwiseSqrt().asDiagonal() *
                        eigen.eigenvectors().transpose() * root.inverse();
}

// |G^-1 dS G^-T|^2 as a form in the corners' steps.
template <int D>
void InteriorPoint<D>::AddHessian(size_t element) {
  Eigen::Matrix<double, kDofs, kDofs> block = Eigen::Matrix<double, kDofs, kDofs>::Zero();
  const Matrix& unscale = constraints_[element].unscale;
  for (int p = 0; p < D; ++p) {
    for (int q = p; q < D; ++q) {
      const Matrix product = unscale.row(p).transpose() * unscale.row(q);
      const Matrix in_f = energy_.problem().rotations[element] * Symmetric(product);
      Eigen::Matrix<double, kDofs, 1> dofs;
      for (int a = 0; a <= D; ++a)
        dofs.template segment<D>(a * D) = in_f * energy_.rest()[element].gradients.col(a);
      block += (p == q ? 1.0 : 2.0) * dofs * dofs.transpose();
    }
  }
  size_t next = 0;
  for (int row = 0; row < kDofs; ++row) {
    for (int column = 0; column < kDofs; ++column)
      values_[places_[element][next++]] += block(row, column);
  }
}

template <int D>
typename InteriorPoint<D>::Residuals InteriorPoint<D>::Linearise(const Positions& x) {
  Residuals residuals;
  residuals.stationarity =
      hessian_ * Eigen::Map<const Eigen::VectorXd>(x.data(), x.size()) + gradient_at_zero_;
  values_ = Eigen::Map<const Eigen::VectorXd>(hessian_.valuePtr(), hessian_.nonZeros());
  for (size_t i = 0; i < constraints_.size(); ++i) {
    Constraint& constraint = constraints_[i];
    constraint.violation = StretchAt(x, i) - constraint.slack;
    residuals.gap += (constraint.slack * constraint.multiplier).trace();
    residuals.violation = std::max(residuals.violation, constraint.violation.norm());
    AddAdjoint(-constraint.multiplier, i, &residuals.stationarity);
    Scale(&constraint);
    AddHessian(i);
  }
  return residuals;
}

// What dZ would be if dS were nothing: G^-T X G^-1 with diag(lambda) X + X diag(lambda) = 2 R.
template <int D>
typename InteriorPoint<D>::Matrix InteriorPoint<D>::Pull(const Constraint& constraint, double goal,
                                                         bool is_corrector) const {
  Matrix r = Matrix::Zero();
  r.diagonal() = (goal - constraint.scaled.array().square()).matrix();
  if (is_corrector) {
    const Matrix product = constraint.scaled_slack * constraint.scaled_multiplier;
    r -= Symmetric(product);
  }
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < D; ++b)
      r(a, b) *= 2 / (constraint.scaled[a] + constraint.scaled[b]);
  }
  return constraint.unscale.transpose() * r * constraint.unscale;
}

template <int D>
Eigen::VectorXd InteriorPoint<D>::RightSide(const Residuals& residuals, double goal,
                                            bool is_corrector) const {
  Eigen::VectorXd right = -residuals.stationarity;
  for (size_t i = 0; i < constraints_.size(); ++i) {
    const Constraint& constraint = constraints_[i];
    const Matrix metric = constraint.unscale.transpose() * constraint.unscale;  // W^-1
    AddAdjoint(Pull(constraint, goal, is_corrector) - metric * constraint.violation * metric, i,
               &right);
  }
  return right;
}

// Fills in dY and dZ, and how far both may be gone. One length for x, Y and Z: the energy is
// quadratic, and with two the gradient would not go with the multipliers.
template <int D>
double InteriorPoint<D>::StepLength(const Eigen::VectorXd& step, double goal, bool is_corrector) {
  double length = 1;
  for (size_t i = 0; i < constraints_.size(); ++i) {
    Constraint& constraint = constraints_[i];
    const Matrix metric = constraint.unscale.transpose() * constraint.unscale;
    const Matrix pull = Pull(constraint, goal, is_corrector);
    constraint.slack_step = StretchStep(step, i) + constraint.violation;
    constraint.multiplier_step = pull - metric * constraint.slack_step * metric;
    const Matrix scale = constraint.unscale.inverse();
    constraint.scaled_slack =
        constraint.unscale * constraint.slack_step * constraint.unscale.transpose();
    constraint.scaled_multiplier = scale.transpose() * constraint.multiplier_step * scale;
    length = std::min({length, LengthTo(constraint.scaled, constraint.scaled_slack),
                       LengthTo(constraint.scaled, constraint.scaled_multiplier)});
  }
  return length;
}

template <int D>
double InteriorPoint<D>::GapAfter(double length) const {
  double gap = 0;
  for (const Constraint& constraint : constraints_) {
    gap += ((constraint.slack + length * constraint.slack_step) *
            (constraint.multiplier + length * constraint.multiplier_step))
               .trace();
  }
  return gap;
}

template <int D>
Status InteriorPoint<D>::Solve(const InteriorPointOptions& options, const Progress& progress,
                               Positions* x, InversionFreeReport* report) {
  Begin(*x);
  report->converged = false;
  const double rank = static_cast<double>(constraints_.size()) * D;
  const double least_energy = static_cast<double>(constraints_.size()) * kLeastEnergy;
  for (report->iterations = 0; report->iterations <= options.most_iterations;
       ++report->iterations) {
    const Residuals residuals = Linearise(*x);
    report->stationarity = residuals.stationarity.cwiseAbs().maxCoeff();
    report->duality_gap = residuals.gap / std::max(energy_.Value(*x, 0), least_energy);
    report->converged =
        report->duality_gap <= options.gap && residuals.violation <= options.violation;
    const bool goes_on = !progress || progress(*x, report->iterations);
    if (report->converged || !goes_on) break;

    Eigen::VectorXd step = RightSide(residuals, 0, false);
    cholesky_.FactoriseAndSolve(values_.data(), &factor_, step.data());
    if (!factor_.definite) {
      return Error(StatusCode::kDegenerate,
                   "step %d has no Cholesky factor: is a part of the mesh without a target?",
                   report->iterations);
    }
    const double predicted = GapAfter(StepLength(step, 0, false));
    const double goal = std::pow(predicted / residuals.gap, 3) * residuals.gap / rank;
    step = RightSide(residuals, goal, true);
    cholesky_.Solve(&factor_, step.data());
    const double length = StepLength(step, goal, true);
    Eigen::Map<Eigen::VectorXd>(x->data(), x->size()) += length * step;
    for (Constraint& constraint : constraints_) {
      const Matrix slack = constraint.slack + length * constraint.slack_step;
      const Matrix multiplier = constraint.multiplier + length * constraint.multiplier_step;
      constraint.slack = Symmetric(slack);
      constraint.multiplier = Symmetric(multiplier);
    }
  }
  return {};
}

template class InteriorPoint<2>;
template class InteriorPoint<3>;

}  // namespace limber::deform
