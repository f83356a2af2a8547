#include "solve/motion_smoother.h"

#include "solve/rotation_planes.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr double kAtRest = 1e-9;      // of weights and of rotations' entries
constexpr double kNegligible = 1e-7;  // weights that are not worth their cost

}  // namespace

template <int K>
MotionSmoother<K>::MotionSmoother(size_t num_groups, size_t num_shapes)
    : num_groups_(num_groups),
      num_shapes_(num_shapes) {
  const size_t padded = PaddedSize(num_groups * num_shapes);
  for (AlignedVector<double>* weights :
       {&blend_.input, &blend_.inner, &blend_.outer, &shown_blend_})
    weights->resize(padded);
  for (AlignedVector<double>* planes :
       {&rotations_.input, &rotations_.inner, &rotations_.outer, &shown_rotations_, &fits_}) {
    planes->resize(padded * K * K);
    SetIdentity<K>(planes);
  }
  failed_.resize(padded);
}

template <int K>
void MotionSmoother<K>::Reset(const AlignedVector<double>& blend,
                              const AlignedVector<double>& rotations) {
  for (AlignedVector<double>* weights :
       {&blend_.input, &blend_.inner, &blend_.outer, &shown_blend_})
    std::copy(blend.begin(), blend.end(), weights->begin());
  for (AlignedVector<double>* planes :
       {&rotations_.input, &rotations_.inner, &rotations_.outer, &shown_rotations_})
    std::copy(rotations.begin(), rotations.end(), planes->begin());
}

// With h = time step / lag, a = e^-h and phi = (1 - a) / h, of an input that goes from u0 to u1,
//     y1 = a y + (phi - a) u0 + (1 - phi) u1
//     z1 = a z + h a y + (2 phi - (2 + h) a) u0 + (1 + a - 2 phi) u1
// exactly. All factors are zero or more and sum to one.
template <int K>
void MotionSmoother<K>::Follow(const AlignedVector<double>& input, double steps, Track* track) {
  const double a = std::exp(-steps);
  const double phi = steps > 0 ? -std::expm1(-steps) / steps : 1;
  const double from_inner = std::isfinite(steps) ? steps * a : 0;
  const double inner_last = std::max(phi - a, 0.0), inner_now = std::max(1 - phi, 0.0);
  const double outer_last = std::max(2 * phi - 2 * a - from_inner, 0.0);
  const double outer_now = std::max(1 + a - 2 * phi, 0.0);
  for (size_t i = 0; i < input.size(); ++i) {
    const double last = track->input[i], now = input[i], y = track->inner[i];
    track->outer[i] = a * track->outer[i] + from_inner * y + outer_last * last + outer_now * now;
    track->inner[i] = a * y + inner_last * last + inner_now * now;
    track->input[i] = now;
  }
}

// Rotations count where a weight uses them.
template <int K>
bool MotionSmoother<K>::IsAtRest(const AlignedVector<double>& blend,
                                 const AlignedVector<double>& rotations) const {
  const auto is_near = [](double a, double b) { return std::abs(a - b) <= kAtRest; };
  for (size_t i = 0; i < num_groups_ * num_shapes_; ++i) {
    if (!is_near(blend_.inner[i], blend[i]) || !is_near(blend_.outer[i], blend[i])) return false;
    if (blend[i] == 0) continue;
    for (size_t entry = 0; entry < size_t{K} * K; ++entry) {
      const size_t at = PlaneIndex<K>(i, entry / K, entry % K);
      if (!is_near(rotations_.inner[at], rotations[at]) ||
          !is_near(rotations_.outer[at], rotations[at])) {
        return false;
      }
    }
  }
  return true;
}

template <int K>
bool MotionSmoother<K>::Advance(const AlignedVector<double>& blend,
                                const AlignedVector<double>& rotations, double lag,
                                double time_step) {
  Follow(blend, time_step / lag, &blend_);
  Follow(rotations, time_step / lag, &rotations_);
  if (IsAtRest(blend, rotations)) {
    Reset(blend, rotations);
    return true;
  }
  ShowBlend();
  ShowRotations();
  return false;
}

// What is left out goes to the group's largest weight.
template <int K>
void MotionSmoother<K>::ShowBlend() {
  for (size_t first = 0; first < num_groups_ * num_shapes_; first += num_shapes_) {
    size_t largest = first;
    double sum = 0;
    for (size_t i = first; i < first + num_shapes_; ++i) {
      shown_blend_[i] = blend_.outer[i] < kNegligible ? 0 : blend_.outer[i];
      sum += shown_blend_[i];
      if (shown_blend_[i] > shown_blend_[largest]) largest = i;
    }
    shown_blend_[largest] += 1 - sum;
  }
}

// The rotation nearest to the mean.
template <int K>
void MotionSmoother<K>::ShowRotations() {
  const size_t blocks = num_groups_ * num_shapes_;
  for (size_t i = 0; i < PaddedSize(blocks); ++i) {
    for (size_t row = 0; row < K; ++row) {
      for (size_t column = 0; column < K; ++column)
        fits_[PlaneIndex<K>(i, row, column)] = rotations_.outer[PlaneIndex<K>(i, column, row)];
    }
  }
  FitRotationPlanes<K>(ChooseSolveKernels<K>(), blocks, fits_, shown_rotations_.data(), &failed_);
}

template class MotionSmoother<2>;
template class MotionSmoother<3>;

}  // namespace limber
