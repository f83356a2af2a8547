// What the artist asks of handles, and the field of rotations that follows from it.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "deform/inversion_free/simplex_mesh.h"

#include <Eigen/Core>

namespace limber::deform {

// In the plane an angle; in space a vector along the axis, as long as the angle. Radians; half a
// turn and three quarters of one are different wishes, and so are the two ways round.
template <int D>
using Turn = Eigen::Matrix<double, D == 2 ? 1 : 3, 1>;

// A handle: a set of vertices that moves as one rigid body, x -> pivot + R (x - pivot) +
// translation.
template <int D>
struct HandleMotion {
  using Point = Eigen::Matrix<double, D, 1>;

  Vector<int> vertices;
  Point pivot = Point::Zero(), translation = Point::Zero();
  Turn<D> turn = Turn<D>::Zero();

  Eigen::Matrix<double, D, D> Rotation() const;
  Point Apply(const Point& rest) const;
};

// R_i of each element: the handles' turns blended with the mean of its corners' weights, in the
// plane as angles, in space as quaternions of the half angles, as they are (Kavan and Zara 2005
// without turning signs: up to a whole turn keeps its way round). weights: [V][H], rows sum to one.
template <int D>
Vector<Eigen::Matrix<double, D, D>> BlendRotations(const SimplexMesh<D>& mesh,
                                                   const Vector<HandleMotion<D>>& handles,
                                                   const Eigen::MatrixXd& weights);

}  // namespace limber::deform
