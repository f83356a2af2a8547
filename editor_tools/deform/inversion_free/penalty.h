// What an eigenvalue below epsilon costs (Liu et al. 2016, eq. 5 and section 4).
#pragma once

namespace limber::deform {

enum class PenaltyKind {
  kQuadratic,  // tau (x - epsilon)^2 below epsilon
  kCubic,      // -tau (x - epsilon)^3 below epsilon
  kSpline,     // a logarithm, continued as a parabola where it grows steep
};

// tau p(x), and its first two derivatives by x. Convex.
struct PenaltyValue {
  double value = 0, slope = 0, curvature = 0;
};

// NOTE: the spline as printed is not continuous. This one is, with both derivatives: with
// y = tau (x - epsilon), -log(y + 1) / tau from y = -1/2 on, and (2 y^2 - 1/2 - log(1/2)) / tau
// below.
PenaltyValue EvaluatePenalty(PenaltyKind kind, double x, double tau, double epsilon);

}  // namespace limber::deform
