// Motion that is smooth in time. The static solution is only continuous in its targets (blend
// weights are piecewise linear in them), so a target that moves evenly makes the skin jerk where
// one example gives way to another; and it jumps where the solution does. The smoother lets blend
// weights and rotations follow the static ones through two equal lags, one behind the other (a
// critically damped follower, kernel t e^(-t/T) / T^2). The transforms are made of what it gives,
// so points that are held still meet their targets exactly.
//
// - The kernel is nowhere negative and sums to one: weights stay on their simplices.
// - Where the input is continuous the output has two continuous derivatives; where it jumps, one
//   less than one would fear: it is continuous with its first derivative.
// - A frame is integrated in closed form with the input taken as linear between frames, so nothing
//   depends on the frame rate but how finely the input itself was sampled.
// - At rest the output is the static solution, bit for bit.
#pragma once

#include "core/aligned_vector.h"
#include "core/memory_source.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"

#include <cstddef>
#include <cstdint>

namespace limber {

template <int K>
class MotionSmoother : public NewFromSource {
 public:
  // Blocks are (group, shape), as everywhere in this folder.
  MotionSmoother(size_t num_groups, size_t num_shapes);

  // At rest there. blend: B [G*S padded]; rotations: R, planes.
  void Reset(const AlignedVector<double>& blend, const AlignedVector<double>& rotations);

  // One frame of time_step seconds, at whose end the static solution is this. lag: T > 0, seconds;
  // a step is followed to 74 % after 2.7 T and to 99 % after 6.6 T. True: at rest.
  bool Advance(const AlignedVector<double>& blend, const AlignedVector<double>& rotations,
               double lag, double time_step);

  // What to show, as the input is laid out: weights not negative, each group's sum one, those
  // below a ten millionth gone; rotations orthonormal.
  const AlignedVector<double>& blend() const { return shown_blend_; }

  const AlignedVector<double>& rotations() const { return shown_rotations_; }

 private:
  // One quantity's input of the last frame, first and second lag.
  struct Track {
    AlignedVector<double> input, inner, outer;
  };

  static void Follow(const AlignedVector<double>& input, double steps, Track* track);
  bool IsAtRest(const AlignedVector<double>& blend, const AlignedVector<double>& rotations) const;
  void ShowBlend();
  void ShowRotations();

  size_t num_groups_, num_shapes_;
  Track blend_, rotations_;
  AlignedVector<double> shown_blend_, shown_rotations_;
  AlignedVector<double> fits_;  // scratch
  Vector<uint8_t> failed_;      // scratch
};

extern template class MotionSmoother<2>;
extern template class MotionSmoother<3>;

}  // namespace limber
