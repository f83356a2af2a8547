// Distances along the edges of the surface, bridges included, on the first shape.
#pragma once

#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace limber::geometry {

class EdgeGraph {
 public:
  explicit EdgeGraph(const SolveMesh& mesh);

  int num_vertices() const { return static_cast<int>(first_.size()) - 1; }

  // Length of the shortest path from the nearest of `sources` (solve vertices), mesh units;
  // infinite where none leads. V.
  Eigen::VectorXd Distances(std::span<const int> sources) const;

  // Neighbours of a vertex, ascending.
  std::span<const int> Neighbours(int vertex) const {
    return {neighbour_.data() + first_[vertex], neighbour_.data() + first_[vertex + 1]};
  }

 private:
  std::vector<int> first_;  // V + 1 offsets into the two below
  std::vector<int> neighbour_;
  std::vector<double> length_;
};

}  // namespace limber::geometry
