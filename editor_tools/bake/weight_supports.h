// Where a handle's bounded biharmonic weight is other than zero, found on a coarse surface.
//
// The bound makes these weights exactly zero beyond some distance: what lies there may be left out
// of the handle's problem, whose multipliers then tell whether that was right.
#pragma once

#include "bake/coarse_surface.h"
#include "core/vector.h"
#include "geometry/robust_laplacian.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

class WeightSupports {
 public:
  WeightSupports(const geometry::RobustLaplacian& surface, std::span<const int> handle_vertices,
                 int num_threads);

  // [V]: all of the surface within so many aggregates of where the coarse weight is above zero; on
  // a surface that is small already, all.
  Vector<bool> Around(int handle, int rings) const;

  int num_aggregates() const { return static_cast<int>(coarse_.areas.size()); }

 private:
  CoarseSurface coarse_;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> is_reached_;  // aggregates x H
};

}  // namespace limber::bake
