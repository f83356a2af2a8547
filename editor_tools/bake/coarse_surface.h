// A surface of far fewer vertices, for first answers to questions about the whole.
#pragma once

#include "core/vector.h"
#include "geometry/robust_laplacian.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace limber::bake {

// Vertices are gathered into aggregates of a vertex with all its neighbours, these again so, and
// on.
struct CoarseSurface {
  Vector<int> aggregate_of;              // [V], in [0, areas.size())
  Eigen::SparseMatrix<double> touching;  // aggregates squared: entries where two touch
  // P^T L P and P^T areas, for functions P u on the surface that are one step of smoothing away
  // from being constant on each aggregate (Vanek, Mandel and Brezina 1996).
  Eigen::SparseMatrix<double> laplacian;
  Eigen::VectorXd areas;
};

// Gathers as often as at least `smallest` aggregates are left; where not even once, every vertex is
// its own.
CoarseSurface Coarsen(const geometry::RobustLaplacian& surface, int smallest);

}  // namespace limber::bake
