#include "deform/inversion_free/handle_motion.h"

#include <Eigen/Geometry>

#include <cmath>

namespace limber::deform {
namespace {

// Of the half angle: a whole turn is -1.
Eigen::Quaterniond QuaternionOf(const Turn<3>& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  Eigen::Quaterniond q;
  q.w() = std::cos(angle / 2);
  q.vec() = std::sin(angle / 2) / angle * turn;
  return q;
}

Eigen::Matrix2d RotationOf(const Turn<2>& turn) {
  return Eigen::Rotation2Dd(turn[0]).toRotationMatrix();
}

Eigen::Matrix3d RotationOf(const Turn<3>& turn) {
  return QuaternionOf(turn).toRotationMatrix();
}

Eigen::Matrix2d Blend(const Vector<HandleMotion<2>>& handles, const Eigen::RowVectorXd& weights) {
  Turn<2> sum = Turn<2>::Zero();
  for (size_t h = 0; h < handles.size(); ++h)
    sum += weights[static_cast<Eigen::Index>(h)] * handles[h].turn;
  return RotationOf(sum);
}

Eigen::Matrix3d Blend(const Vector<HandleMotion<3>>& handles, const Eigen::RowVectorXd& weights) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (size_t h = 0; h < handles.size(); ++h)
    sum += weights[static_cast<Eigen::Index>(h)] * QuaternionOf(handles[h].turn).coeffs();
  // Opposite wishes of equal weight cancel; then there is no better answer than any.
  if (!(sum.norm() > 1e-12)) return Eigen::Matrix3d::Identity();
  return Eigen::Quaterniond(sum.normalized()).toRotationMatrix();
}

}  // namespace

template <int D>
Eigen::Matrix<double, D, D> HandleMotion<D>::Rotation() const {
  return RotationOf(turn);
}

template <int D>
typename HandleMotion<D>::Point HandleMotion<D>::Apply(const Point& rest) const {
  return pivot + Rotation() * (rest - pivot) + translation;
}

template <int D>
Vector<Eigen::Matrix<double, D, D>> BlendRotations(const SimplexMesh<D>& mesh,
                                                   const Vector<HandleMotion<D>>& handles,
                                                   const Eigen::MatrixXd& weights) {
  Vector<Eigen::Matrix<double, D, D>> rotations;
  rotations.reserve(mesh.elements.size());
  for (const auto& element : mesh.elements) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(weights.cols());
    for (const int corner : element)
      mean += weights.row(corner) / (D + 1);
    rotations.push_back(Blend(handles, mean));
  }
  return rotations;
}

template struct HandleMotion<2>;
template struct HandleMotion<3>;
template Vector<Eigen::Matrix2d> BlendRotations(const TriangleMesh&, const Vector<HandleMotion<2>>&,
                                                const Eigen::MatrixXd&);
template Vector<Eigen::Matrix3d> BlendRotations(const TetMesh&, const Vector<HandleMotion<3>>&,
                                                const Eigen::MatrixXd&);

}  // namespace limber::deform
