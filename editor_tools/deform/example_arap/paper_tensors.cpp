#include "deform/example_arap/paper_tensors.h"

#include "core/vector.h"

#include <Eigen/QR>

namespace limber::deform {

double PaperTensors::Energy(const Eigen::MatrixXd& transforms, const Vector<double>& blend,
                            const Vector<Eigen::MatrixXd>& rotations) const {
  double energy = 0.5 * (transforms.transpose() * l * transforms).trace();
  const auto shapes = static_cast<size_t>(num_shapes);
  for (size_t block = 0; block < load.size(); ++block) {
    energy -= blend[block] * (rotations[block] * load[block] * transforms).trace();
    for (size_t other = 0; other < shapes; ++other) {
      const size_t partner = block / shapes * shapes + other;
      energy += 0.5 * blend[block] * blend[partner] *
                (rotations[block] * gram[block * shapes + other] * rotations[partner].transpose())
                    .trace();
    }
  }
  return energy;
}

Eigen::MatrixXd PaperTensors::Minimise(const Vector<int>& vertices, const Eigen::MatrixXd& targets,
                                       const Vector<double>& blend,
                                       const Vector<Eigen::MatrixXd>& rotations) const {
  const Eigen::Index n = l.rows(), c = targets.rows();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + c, n + c);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + c, k);
  system.topLeftCorner(n, n) = l;
  for (Eigen::Index row = 0; row < c; ++row) {
    system.block(n + row, 0, 1, n) = skinning.row(vertices[static_cast<size_t>(row)]);
    system.block(0, n + row, n, 1) = system.block(n + row, 0, 1, n).transpose();
  }
  for (size_t block = 0; block < load.size(); ++block) {
    right.topRows(n) += blend[block] * load[block].transpose() * rotations[block].transpose();
  }
  right.bottomRows(c) = targets;
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(system);
  return solver.solve(right).topRows(n);
}

PaperTensors BuildPaperTensors(const Vector<Eigen::MatrixXd>& shapes,
                               const Eigen::MatrixXd& weights,
                               const Vector<geometry::GroupEdge>& edges, int num_groups) {
  PaperTensors tensors;
  const auto num_shapes = static_cast<Eigen::Index>(shapes.size());
  const Eigen::Index k = shapes.front().cols(), num_vertices = weights.rows();
  const Eigen::Index n = weights.cols() * num_shapes * (k + 1);
  tensors.k = static_cast<int>(k);
  tensors.num_groups = num_groups;
  tensors.num_shapes = static_cast<int>(num_shapes);
  tensors.skinning.resize(num_vertices, n);
  for (Eigen::Index p = 0; p < num_vertices; ++p) {
    for (Eigen::Index h = 0; h < weights.cols(); ++h) {
      for (Eigen::Index s = 0; s < num_shapes; ++s) {
        const Eigen::Index at = (h * num_shapes + s) * (k + 1);
        tensors.skinning.block(p, at, 1, k) = weights(p, h) * shapes[static_cast<size_t>(s)].row(p);
        tensors.skinning(p, at + k) = weights(p, h);
      }
    }
  }
  const size_t blocks = static_cast<size_t>(num_groups) * shapes.size();
  tensors.l = Eigen::MatrixXd::Zero(n, n);
  tensors.load.assign(blocks, Eigen::MatrixXd::Zero(k, n));
  tensors.gram.assign(blocks * shapes.size(), Eigen::MatrixXd::Zero(k, k));
  for (const geometry::GroupEdge& edge : edges) {
    const Eigen::RowVectorXd row = tensors.skinning.row(edge.j) - tensors.skinning.row(edge.i);
    tensors.l += edge.weight * row.transpose() * row;
    for (size_t s = 0; s < shapes.size(); ++s) {
      const size_t block = static_cast<size_t>(edge.group) * shapes.size() + s;
      const Eigen::VectorXd e_s = (shapes[s].row(edge.j) - shapes[s].row(edge.i)).transpose();
      tensors.load[block] += edge.weight * e_s * row;
      for (size_t t = 0; t < shapes.size(); ++t) {
        const Eigen::RowVectorXd e_t = shapes[t].row(edge.j) - shapes[t].row(edge.i);
        tensors.gram[block * shapes.size() + t] += edge.weight * e_s * e_t;
      }
    }
  }
  return tensors;
}

}  // namespace limber::deform
