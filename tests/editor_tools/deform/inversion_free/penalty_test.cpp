#include "deform/inversion_free/penalty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::deform {
namespace {

constexpr PenaltyKind kKinds[] = {PenaltyKind::kQuadratic, PenaltyKind::kCubic,
                                  PenaltyKind::kSpline};
constexpr double kEpsilon = 1e-3;

TEST(Penalty, Derivatives_AreThoseOfTheValue) {
  for (const PenaltyKind kind : kKinds) {
    for (const double tau : {1.0, 30.0}) {
      for (const double x : {-2.0, -0.6, -0.02, 0.0, 0.4, 2.0}) {
        const double h = 1e-5;
        const PenaltyValue at = EvaluatePenalty(kind, x, tau, kEpsilon);
        const PenaltyValue below = EvaluatePenalty(kind, x - h, tau, kEpsilon);
        const PenaltyValue above = EvaluatePenalty(kind, x + h, tau, kEpsilon);
        EXPECT_NEAR((above.value - below.value) / (2 * h), at.slope, 1e-6 * (1 + tau * tau));
        EXPECT_NEAR((above.slope - below.slope) / (2 * h), at.curvature, 1e-5 * (1 + tau * tau));
      }
    }
  }
}

TEST(Penalty, Spline_IsSmoothWhereItsPiecesMeet) {
  const double tau = 40, seam = kEpsilon - 0.5 / tau, h = 1e-9;
  const PenaltyValue left = EvaluatePenalty(PenaltyKind::kSpline, seam - h, tau, kEpsilon);
  const PenaltyValue right = EvaluatePenalty(PenaltyKind::kSpline, seam + h, tau, kEpsilon);
  EXPECT_NEAR(left.value, right.value, 1e-7);
  EXPECT_NEAR(left.slope, right.slope, 1e-6);
  EXPECT_NEAR(left.curvature, right.curvature, 1e-4);
}

TEST(Penalty, Convex_AndNothingAboveEpsilon) {
  for (const PenaltyKind kind : kKinds) {
    for (double x = -3; x < 3; x += 0.01)
      EXPECT_GE(EvaluatePenalty(kind, x, 100, kEpsilon).curvature, 0) << x;
  }
  for (const PenaltyKind kind : {PenaltyKind::kQuadratic, PenaltyKind::kCubic}) {
    EXPECT_EQ(EvaluatePenalty(kind, kEpsilon, 1e9, kEpsilon).value, 0);
    EXPECT_EQ(EvaluatePenalty(kind, 1, 1e9, kEpsilon).slope, 0);
    EXPECT_GT(EvaluatePenalty(kind, 0, 1e9, kEpsilon).value, 0);
  }
}

}  // namespace
}  // namespace limber::deform
