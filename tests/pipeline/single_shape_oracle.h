// One example shape alone (eq. 4), solved slowly and plainly on the full mesh: what the choice of
// energy interpolation (eq. 2) is checked against.
#pragma once

#include "core/vector.h"
#include "deform/example_arap/paper_tensors.h"
#include "geometry/solve_mesh.h"
#include "import/raw_character.h"
#include "rig/rig.h"

#include <Eigen/Core>

namespace limber::test {

// Of a planar character (mesh space, k = 2) whose handle "left" stays and whose handle "right" is
// dragged.
class SingleShapeOracle {
 public:
  struct Answer {
    double energy = 0;  // min over q and R of E_d(q, p_s) (eq. 7), mesh units
    Eigen::MatrixXd q;  // V x 2, of all that the transforms of all shapes can make (eq. 6)
  };

  // The rig's own skinning weights, the edges and groups built once more.
  SingleShapeOracle(const bake::RawCharacter& raw, const Rig& rig, bool rotations);

  // The alternation of transforms and rotations from R = I, to its end.
  Answer Solve(int shape, Vec3 right) const;

 private:
  Vector<Eigen::MatrixXd> FitRotations(const Eigen::MatrixXd& q) const;  // of all blocks

  bool rotations_;
  int num_groups_ = 0;
  Vector<Eigen::MatrixXd> shapes_;  // S of V x 2
  Eigen::MatrixXd weights_;         // V x H
  Vector<geometry::GroupEdge> edges_;
  deform::PaperTensors tensors_;
  Vector<int> pinned_;
};

}  // namespace limber::test
