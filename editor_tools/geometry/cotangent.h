// Cotangent weights and lumped areas of the first shape; safe for zero-area triangles.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "geometry/solve_mesh.h"

namespace limber::geometry {

// [triangles] cotangents at the three corners, of the first shape; finite for any triangle
// (degenerate ones are clamped).
std::vector<std::array<double, 3>> CornerCotangents(const SolveMesh& mesh);

// Cotangent Laplacian with bridges, V x V, symmetric positive semi-definite, row sums zero:
// L_ij = -w_ij. Edge weights are clamped from below to a small positive number.
Eigen::SparseMatrix<double> CotangentLaplacian(const SolveMesh& mesh);

// Lumped (barycentric) vertex areas, V, all positive: vertices without area get a small one.
Eigen::VectorXd VertexAreas(const SolveMesh& mesh);

}  // namespace limber::geometry
