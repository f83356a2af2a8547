#include "deform/inversion_free/penalty.h"

#include <cmath>

namespace limber::deform {
namespace {

PenaltyValue Spline(double below, double tau) {
  const double y = tau * below;
  if (y >= -0.5) return {-std::log1p(y) / tau, -1 / (y + 1), tau / ((y + 1) * (y + 1))};
  return {(2 * y * y - 0.5 - std::log(0.5)) / tau, 4 * y, 4 * tau};
}

}  // namespace

PenaltyValue EvaluatePenalty(PenaltyKind kind, double x, double tau, double epsilon) {
  const double d = x - epsilon;
  if (kind == PenaltyKind::kSpline) return Spline(d, tau);
  if (!(d < 0)) return {};
  if (kind == PenaltyKind::kQuadratic) return {tau * d * d, 2 * tau * d, 2 * tau};
  return {-tau * d * d * d, -3 * tau * d * d, -6 * tau * d};
}

}  // namespace limber::deform
