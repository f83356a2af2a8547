// Small smooth functions that the generators are written in.
#pragma once

#include <algorithm>
#include <cmath>

namespace limber::content {

// 0 below a, 1 above b, smooth between (second derivatives vanish at both ends). a < b.
inline double SmoothStep(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * t * (t * (6 * t - 15) + 10);
}

// A bump of height 1 at `centre` that falls off like a Gaussian of the given width.
inline double Bump(double x, double centre, double width) {
  const double t = (x - centre) / width;
  return std::exp(-t * t);
}

// The smaller of two distances, rounded where they differ by less than k (twice differentiable).
inline double SmoothMin(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * h * k / 6;
}

inline double Mix(double a, double b, double t) {
  return a + (b - a) * t;
}

}  // namespace limber::content
