#include "deform/example_arap/full_energy.h"

#include "core/vector.h"

namespace limber::deform {

double ElasticEnergy(const Vector<Eigen::MatrixXd>& shapes,
                     const Vector<geometry::GroupEdge>& edges, const ExampleState& state) {
  double energy = 0;
  for (const geometry::GroupEdge& edge : edges) {
    Eigen::RowVectorXd difference = state.q.row(edge.j) - state.q.row(edge.i);
    for (size_t s = 0; s < shapes.size(); ++s) {
      const size_t block = static_cast<size_t>(edge.group) * shapes.size() + s;
      const Eigen::RowVectorXd e_s = shapes[s].row(edge.j) - shapes[s].row(edge.i);
      difference -= state.blend[block] * e_s * state.rotations[block].transpose();
    }
    energy += 0.5 * edge.weight * difference.squaredNorm();
  }
  return energy;
}

double GroupEnergy(const Eigen::MatrixXd& shape, const Vector<geometry::GroupEdge>& edges,
                   int group, const Eigen::MatrixXd& q, const Eigen::MatrixXd& rotation) {
  double energy = 0;
  for (const geometry::GroupEdge& edge : edges) {
    if (edge.group != group) continue;
    const Eigen::RowVectorXd e_s = shape.row(edge.j) - shape.row(edge.i);
    const Eigen::RowVectorXd difference =
        q.row(edge.j) - q.row(edge.i) - e_s * rotation.transpose();
    energy += edge.weight * difference.squaredNorm();
  }
  return energy;
}

}  // namespace limber::deform
