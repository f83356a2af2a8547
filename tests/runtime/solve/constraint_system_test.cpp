#include "solve/constraint_system.h"

#include "core/vector.h"
#include "support/counting_allocator.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace limber {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// Rows with what they ask for, and the system of them.
struct Rows {
  ConstraintSystem::RowMajor modes;  // c x r
  VectorXd translation, compliance;  // c

  Rows(Eigen::Index c, Eigen::Index r)
      : modes(MatrixXd::Random(c, r)),
        translation(VectorXd::Ones(c)),
        compliance(VectorXd::Zero(c)) {}

  Vector<ConstraintRow> List() const {
    Vector<ConstraintRow> list;
    for (Eigen::Index i = 0; i < modes.rows(); ++i)
      list.push_back({modes.row(i).data(), translation[i], compliance[i]});
    return list;
  }

  ConstraintSystem System() const {
    ConstraintSystem system(static_cast<size_t>(modes.rows()), static_cast<size_t>(modes.cols()));
    system.Compute(List());
    return system;
  }
};

struct Solution {
  MatrixXd z;
  RowVectorXd t;
  double energy = 0;
};

// The header's formulas.
Solution Answer(const ConstraintSystem& system, const MatrixXd& b, const MatrixXd& x) {
  const MatrixXd gap = x - system.modes() * b;
  return {b + system.modes().transpose() * (system.response() * gap), system.translation() * gap,
          0.5 * (gap.transpose() * system.response() * gap).trace()};
}

// Unknowns z, t and forces y: z - C^T y = b, a^T y = 0, C z + a t + diag(alpha) y = X.
Solution SolveKkt(const Rows& rows, const MatrixXd& b, const MatrixXd& x) {
  const Eigen::Index c = rows.modes.rows(), r = rows.modes.cols();
  MatrixXd kkt = MatrixXd::Zero(r + 1 + c, r + 1 + c);
  kkt.topLeftCorner(r, r).setIdentity();
  kkt.block(0, r + 1, r, c) = -rows.modes.transpose();
  kkt.block(r, r + 1, 1, c) = rows.translation.transpose();
  kkt.bottomLeftCorner(c, r) = rows.modes;
  kkt.block(r + 1, r, c, 1) = rows.translation;
  kkt.bottomRightCorner(c, c) = rows.compliance.asDiagonal();
  MatrixXd right = MatrixXd::Zero(r + 1 + c, x.cols());
  right.topRows(r) = b;
  right.bottomRows(c) = x;
  const MatrixXd all = kkt.fullPivLu().solve(right);
  Solution solution{all.topRows(r), all.row(r), 0};
  const MatrixXd forces = all.bottomRows(c);
  solution.energy = 0.5 * (solution.z - b).squaredNorm() +
                    0.5 * (forces.transpose() * rows.compliance.asDiagonal() * forces).trace();
  return solution;
}

void ExpectMatchesKkt(const Rows& rows) {
  const MatrixXd b = MatrixXd::Random(rows.modes.cols(), 3);
  const MatrixXd x = MatrixXd::Random(rows.modes.rows(), 3);
  const Solution found = Answer(rows.System(), b, x), expected = SolveKkt(rows, b, x);
  EXPECT_LT((found.z - expected.z).norm(), 1e-10);
  EXPECT_LT((found.t - expected.t).norm(), 1e-10);
  EXPECT_NEAR(found.energy, expected.energy, 1e-10 * (1 + expected.energy));
}

TEST(ConstraintSystem, RandomPins_MatchesTheKktSystem) {
  srand(1);
  for (int c = 1; c <= 6; ++c)
    ExpectMatchesKkt(Rows(c, 12));
}

TEST(ConstraintSystem, SoftPins_MatchTheKktSystem) {
  srand(4);
  for (int c = 1; c <= 8; ++c) {
    Rows rows(c, 12);
    rows.compliance = VectorXd::Random(c).cwiseAbs();
    rows.compliance[0] = 0;
    ExpectMatchesKkt(rows);
    rows.compliance *= 1e6;
    ExpectMatchesKkt(rows);
  }
}

TEST(ConstraintSystem, DirectionsBesidePoints_MatchTheKktSystem) {
  srand(5);
  for (int points = 1; points <= 4; ++points) {
    Rows rows(points + 3, 14);
    rows.translation.tail(3).setZero();
    rows.compliance[points] = 0.3;
    ExpectMatchesKkt(rows);
    rows.translation.reverseInPlace();  // a direction first
    ExpectMatchesKkt(rows);
  }
}

// Soft pins stand still where they are pulled so little that they need not be met at all.
TEST(ConstraintSystem, GrowingStiffness_ApproachesExactly) {
  srand(6);
  Rows rows(4, 12);
  const MatrixXd b = MatrixXd::Random(12, 3), x = MatrixXd::Random(4, 3);
  const Solution exact = Answer(rows.System(), b, x);
  double last = 1e300;
  for (double compliance = 1; compliance > 1e-8; compliance /= 10) {
    rows.compliance.setConstant(compliance);
    const double error = (Answer(rows.System(), b, x).z - exact.z).norm();
    EXPECT_LT(error, last);
    last = error;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(ConstraintSystem, OnePin_OnlyTranslates) {
  srand(2);
  const ConstraintSystem system = Rows(1, 5).System();
  EXPECT_EQ(system.response().norm(), 0);
  EXPECT_EQ(system.rank(), 0u);
  EXPECT_NEAR(system.translation().sum(), 1, 1e-15);
}

TEST(ConstraintSystem, TwoPinsOnOnePoint_AreMetInTheMean) {
  srand(3);
  Rows rows(3, 8);
  rows.modes.row(2) = rows.modes.row(1);
  const MatrixXd x = MatrixXd::Random(3, 3);
  const ConstraintSystem system = rows.System();
  EXPECT_EQ(system.rank(), 1u);
  const Solution found = Answer(system, MatrixXd::Zero(8, 3), x);
  ASSERT_TRUE(found.z.allFinite());
  const MatrixXd q = (rows.modes * found.z).rowwise() + found.t;
  EXPECT_LT((q.row(1) - 0.5 * (x.row(1) + x.row(2))).norm(), 1e-9);
  EXPECT_LT((q.row(0) - x.row(0)).norm(), 1e-9);
}

// W is the pseudo-inverse of the projected gram matrix, whatever its rank.
TEST(ConstraintSystem, DependentRows_GiveThePseudoInverse) {
  srand(7);
  for (int rank = 1; rank <= 5; ++rank) {
    Rows rows(7, 9);
    rows.modes = MatrixXd::Random(7, rank) * MatrixXd::Random(rank, 9);
    const ConstraintSystem system = rows.System();
    const MatrixXd across = MatrixXd::Identity(7, 7) - MatrixXd::Constant(7, 7, 1.0 / 7);
    const MatrixXd gram = across * rows.modes * rows.modes.transpose() * across;
    const MatrixXd w = system.response();
    EXPECT_EQ(system.rank(), static_cast<size_t>(rank));
    EXPECT_LT((gram * w * gram - gram).norm(), 1e-9 * gram.norm());
    EXPECT_LT((w * gram * w - w).norm(), 1e-9 * w.norm());
    EXPECT_LT((gram * w - w * gram).norm(), 1e-9);
    EXPECT_LT((system.root() * system.root().transpose() - w).norm(), 1e-12 * w.norm());
  }
}

TEST(ConstraintSystem, ComputedAgain_AllocatesNothingAndForgetsTheLast) {
  srand(8);
  const Rows large(40, 60), small(3, 60);
  Rows dependent(12, 60);
  dependent.modes.bottomRows(6) = dependent.modes.topRows(6);
  ConstraintSystem system(40, 60);
  const auto large_list = large.List(), small_list = small.List(),
             dependent_list = dependent.List();
  const int64_t before = test::AllocationCount();
  system.Compute(large_list);
  system.Compute(dependent_list);
  system.Compute(small_list);
  EXPECT_EQ(test::AllocationCount(), before);
  const ConstraintSystem fresh = small.System();
  EXPECT_EQ(MatrixXd(system.response()), MatrixXd(fresh.response()));
  EXPECT_EQ(RowVectorXd(system.translation()), RowVectorXd(fresh.translation()));
}

}  // namespace
}  // namespace limber
