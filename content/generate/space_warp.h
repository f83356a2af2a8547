// Smooth deformations of space, composed into the example shapes.
#pragma once

#include "generate/character.h"

#include <functional>

namespace limber::content {

using SpaceWarp = std::function<Vector3d(const Vector3d&)>;

// `second` after `first`.
SpaceWarp Then(SpaceWarp first, SpaceWarp second);
// Heights scaled by `height`, and the distance from the y axis by `girth(y)`, which fades to a
// mere shift beyond `reach` from the axis. The ground stays.
SpaceWarp Swell(double height, std::function<double(double)> girth, double reach);
// The y axis bent by `angle` radians between heights `from` and `to`, smoothly, about +z (towards
// -x for positive angles) or about +x (towards +z); its length is kept.
SpaceWarp BendAboutZ(double angle, double from, double to);
SpaceWarp BendAboutX(double angle, double from, double to);
SpaceWarp Shift(const Vector3d& offset);

// The derivative of `warp` at `p`, and the rotation nearest to a matrix.
Eigen::Matrix3d WarpJacobian(const SpaceWarp& warp, const Vector3d& p);
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace limber::content
