#include "runtime/convex_oracle/full_problem.h"

#include "core/vector.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace limber::oracle {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// The floor under sqrt(D), relative to the root of the energy of one example (alternation.cpp).
constexpr double kNearnessFloor = 1e-6;

MatrixXd FromTable(const Vector<float>& table, Index rows, Index columns) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(table.data(), rows, columns).cast<double>();
}

}  // namespace

template <int K>
FullProblem<K>::FullProblem(const PoseModel& model, TransformUnknowns unknowns)
    : model_(model),
      unknowns_(unknowns) {
  const RigTables& tables = model.rig->tables();
  const MatrixXd modes =
      FromTable(tables.mode_transforms, tables.num_transform_rows(), 1 + tables.num_modes);
  inverse_ = modes.completeOrthogonalDecomposition().pseudoInverse();
  modes_ = inverse_;
  if (unknowns == TransformUnknowns::kModes)
    modes_ = MatrixXd::Identity(inverse_.rows(), inverse_.rows());
  const MatrixXd at_handles =
      FromTable(tables.handle_modes, tables.num_handles(), 1 + tables.num_modes);
  handles_ = at_handles(model.pinned_handles, Eigen::all) * modes_;
  edges_ = FromTable(tables.mode_edges, Index{model.num_blocks} * K, tables.num_modes);
  residual_ = FromTable(tables.residual_factor, tables.residual_rank,
                        Index{model.num_blocks} * (model.is_folded ? 1 : K));
}

template <int K>
ConvexProblem FullProblem<K>::Make(Alternation<K>* alternation,
                                   const typename Alternation<K>::Settings& settings) const {
  const Index n = modes_.cols(), modes = modes_.rows() - 1, rank = residual_.rows();
  const Index pins = handles_.rows(), size = K * n + model_.num_blocks;
  ConvexProblem problem;
  problem.square_root = settings.square_roots;
  problem.first_bounded = K * n;
  problem.factor = MatrixXd::Zero((modes + rank) * K, size);
  problem.goal = Eigen::VectorXd::Zero(problem.factor.rows());
  problem.linear = Eigen::VectorXd::Zero(size);
  problem.equality = MatrixXd::Zero(K * pins, size);
  problem.right.resize(K * pins);
  for (Index c = 0; c < K; ++c) {
    problem.factor.block(c * modes, c * n, modes, n) = modes_.bottomRows(modes);
    problem.equality.block(c * pins, c * n, pins, n) = handles_;
    for (Index pin = 0; pin < pins; ++pin)
      problem.right[c * pins + pin] = alternation->targets[static_cast<size_t>(pin * K + c)];
  }
  const double floor = kNearnessFloor * std::sqrt(model_.energy_scale);
  for (int i = 0; i < model_.num_blocks; ++i) {
    const auto rotation = alternation->rotation(i);
    const Index column = K * n + i;
    const MatrixXd inside = edges_.middleRows(Index{i} * K, K).transpose() * rotation.transpose();
    for (Index c = 0; c < K; ++c)
      problem.factor.col(column).segment(c * modes, modes) = -inside.col(c);
    if (model_.is_folded) {
      problem.factor.col(column).segment(K * modes, rank) = residual_.col(i);
    } else {
      const MatrixXd rest = residual_.middleCols(Index{i} * K, K) * rotation.transpose();
      for (Index c = 0; c < K; ++c)
        problem.factor.col(column).segment(K * modes + c * rank, rank) = rest.col(c);
    }
    const double root = std::max(std::sqrt(alternation->Distance(model_, i)), floor);
    problem.linear[column] = settings.lambda * (settings.square_roots ? root : root * root);
  }
  AddSimplices(model_.num_shapes, &problem);
  return problem;
}

template <int K>
Eigen::VectorXd FullProblem<K>::Unknowns(Alternation<K>* alternation) const {
  const Index n = inverse_.cols(), size = modes_.cols();
  MatrixXd transforms(n, K);
  const AlignedVector<double>& planes = alternation->Transforms(model_);
  for (Index row = 0; row < n; ++row) {
    for (Index c = 0; c < K; ++c)
      transforms(row, c) = planes[static_cast<size_t>((row / 8 * K + c) * 8 + row % 8)];
  }
  if (unknowns_ == TransformUnknowns::kModes) transforms = inverse_ * transforms;
  Eigen::VectorXd x(K * size + model_.num_blocks);
  x.head(K * size) = transforms.reshaped();
  std::copy_n(alternation->blend().begin(), model_.num_blocks, x.data() + K * size);
  return x;
}

template <int K>
double ReachedObjective(const PoseModel& model, const typename Alternation<K>::Settings& settings,
                        Alternation<K>* alternation) {
  double nearness = 0;
  const double elastic = alternation->ElasticEnergy(model, &nearness);
  return (settings.square_roots ? std::sqrt(elastic) : elastic) + nearness;
}

template class FullProblem<2>;
template class FullProblem<3>;
template double ReachedObjective<2>(const PoseModel&, const Alternation<2>::Settings&,
                                    Alternation<2>*);
template double ReachedObjective<3>(const PoseModel&, const Alternation<3>::Settings&,
                                    Alternation<3>*);

}  // namespace limber::oracle
