#include "solve/constraint_system.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace limber {
namespace {

// z and t of the header's formulas.
void Answer(const ConstraintSystem& system, const Eigen::MatrixXd& b, const Eigen::MatrixXd& x,
            Eigen::MatrixXd* z, Eigen::RowVectorXd* t) {
  const Eigen::MatrixXd gap = x - system.modes * b;
  *z = b + system.modes.transpose() * (system.response * gap);
  *t = system.translation * gap;
}

TEST(ConstraintSystem, RandomPins_MatchesTheKktSystem) {
  srand(1);
  for (int c = 1; c <= 6; ++c) {
    const int r = 12;
    const Eigen::MatrixXd modes = Eigen::MatrixXd::Random(c, r);
    const Eigen::MatrixXd b = Eigen::MatrixXd::Random(r, 3), x = Eigen::MatrixXd::Random(c, 3);
    Eigen::MatrixXd z;
    Eigen::RowVectorXd t;
    Answer(ConstraintSystem::Create(modes), b, x, &z, &t);
    // Unknowns z, t, multipliers.
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(r + 1 + c, r + 1 + c);
    kkt.topLeftCorner(r, r).setIdentity();
    kkt.bottomLeftCorner(c, r) = modes;
    kkt.block(r + 1, r, c, 1).setOnes();
    kkt.topRightCorner(r, c) = modes.transpose();
    kkt.block(r, r + 1, 1, c).setOnes();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(r + 1 + c, 3);
    right.topRows(r) = b;
    right.bottomRows(c) = x;
    const Eigen::MatrixXd expected = kkt.fullPivLu().solve(right);
    EXPECT_LT((z - expected.topRows(r)).norm(), 1e-10);
    EXPECT_LT((t - expected.row(r)).norm(), 1e-10);
  }
}

TEST(ConstraintSystem, OnePin_OnlyTranslates) {
  srand(2);
  const ConstraintSystem system = ConstraintSystem::Create(Eigen::MatrixXd::Random(1, 5));
  EXPECT_EQ(system.response.norm(), 0);
  EXPECT_NEAR(system.translation.sum(), 1, 1e-15);
}

TEST(ConstraintSystem, TwoPinsOnOnePoint_AreMetInTheMean) {
  srand(3);
  Eigen::MatrixXd modes = Eigen::MatrixXd::Random(3, 8);
  modes.row(2) = modes.row(1);
  const ConstraintSystem system = ConstraintSystem::Create(modes);
  Eigen::MatrixXd x = Eigen::MatrixXd::Random(3, 3), z;
  Eigen::RowVectorXd t;
  Answer(system, Eigen::MatrixXd::Zero(8, 3), x, &z, &t);
  ASSERT_TRUE(z.allFinite());
  const Eigen::MatrixXd q = (modes * z).rowwise() + t;
  EXPECT_LT((q.row(1) - 0.5 * (x.row(1) + x.row(2))).norm(), 1e-9);
  EXPECT_LT((q.row(0) - x.row(0)).norm(), 1e-9);
}

}  // namespace
}  // namespace limber
