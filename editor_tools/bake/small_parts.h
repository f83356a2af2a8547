// Loose parts that are too small to bend: eyes, teeth, buttons.
#pragma once

#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

// A part (component) without a handle follows what it is bridged to. Where it is small and compact,
// its largest extent under kSmallPart of the character's diagonal and its second one not far from
// the largest, all its vertices get one row of weights, the mean of those that it is bridged to: it
// then moves as one, however the surface around it bends. Others (a sleeve, a row of lashes) keep
// their own weights, which run on smoothly. weights: V x H. Returns how many parts were held.
int HoldSmallParts(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                   Eigen::MatrixXd* weights);

inline constexpr double kSmallPart = 0.1;
inline constexpr double kLeastRoundness = 1.0 / 3;  // second extent by largest

}  // namespace limber::bake
