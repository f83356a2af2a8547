// Cotangent weights and lumped areas of the first shape; safe for zero-area triangles.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <array>

namespace limber::geometry {

// [triangles] cotangents at the three corners, of the first shape; finite for any triangle
// (degenerate ones are clamped).
Vector<std::array<double, 3>> CornerCotangents(const SolveMesh& mesh);

// An undirected edge i < j with its weight, half the sum of the opposite cotangents.
struct WeightedEdge {
  int i = 0, j = 0;
  double weight = 0;
};

// The edges of the triangles (no bridges), sorted by i, then j; weights are clamped from below to
// kSmallestEdgeWeight of the mean weight.
Vector<WeightedEdge> CotangentEdges(const SolveMesh& mesh);

inline constexpr double kSmallestEdgeWeight = 1e-3;  // of the mean edge weight

// Cotangent Laplacian with bridges, V x V, symmetric positive semi-definite, row sums zero:
// L_ij = -w_ij. Edge weights are clamped from below to a small positive number.
Eigen::SparseMatrix<double> CotangentLaplacian(const SolveMesh& mesh);

// Lumped (barycentric) vertex areas, V, all positive: vertices without area get a small one.
Eigen::VectorXd VertexAreas(const SolveMesh& mesh);

}  // namespace limber::geometry
