// Meshes of triangles and tetrahedra, and wishes that are hard to grant.
#pragma once

#include "core/vector.h"
#include "deform/inversion_free/handle_motion.h"
#include "deform/inversion_free/handle_weights.h"
#include "deform/inversion_free/problem.h"

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace limber::test {

using deform::HandleMotion;
using deform::InversionFreeProblem;
using deform::SimplexMesh;
using deform::TetMesh;
using deform::TriangleMesh;

inline constexpr double kDegree = std::numbers::pi / 180;

// A square from -1 to 1 of side x side cells, each of two triangles, diagonals in turn.
inline TriangleMesh MakeGrid(int side) {
  TriangleMesh mesh;
  mesh.rest.resize((side + 1) * (side + 1), 2);
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j)
      mesh.rest.row(i * (side + 1) + j) << 2.0 * i / side - 1, 2.0 * j / side - 1;
  }
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int a = i * (side + 1) + j, b = a + side + 1, c = b + 1, d = a + 1;
      if ((i + j) % 2 == 0) {
        mesh.elements.push_back({a, b, c});
        mesh.elements.push_back({a, c, d});
      } else {
        mesh.elements.push_back({a, b, d});
        mesh.elements.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

// A bar along z of cubes with edges of 1 / x, each of five tetrahedra; from 0 to z / x.
inline TetMesh MakeBar(int x, int y, int z) {
  TetMesh mesh;
  mesh.rest.resize((x + 1) * (y + 1) * (z + 1), 3);
  const auto vertex = [&](int i, int j, int k) { return (i * (y + 1) + j) * (z + 1) + k; };
  for (int i = 0; i <= x; ++i) {
    for (int j = 0; j <= y; ++j) {
      for (int k = 0; k <= z; ++k) {
        mesh.rest.row(vertex(i, j, k)) << double(i) / x - 0.5, (double(j) - 0.5 * y) / x,
            double(k) / x;
      }
    }
  }
  for (int i = 0; i < x; ++i) {
    for (int j = 0; j < y; ++j) {
      for (int k = 0; k < z; ++k) {
        int c[8];
        for (int n = 0; n < 8; ++n)
          c[n] = vertex(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
        // The corners of every second cell are mirrored, so that neighbours share diagonals.
        const int m = (i + j + k) % 2 == 0 ? 0 : 1;
        for (const auto& t :
             {std::array{0, 3, 5, 6}, std::array{1, 0, 3, 5}, std::array{2, 0, 3, 6},
              std::array{4, 0, 5, 6}, std::array{7, 3, 5, 6}}) {
          mesh.elements.push_back({c[t[0] ^ m], c[t[1] ^ m], c[t[2] ^ m], c[t[3] ^ m]});
        }
      }
    }
  }
  Orient(&mesh);
  return mesh;
}

template <int D, class Test>
Vector<int> VerticesWhere(const SimplexMesh<D>& mesh, const Test& test) {
  Vector<int> found;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (test(Eigen::Matrix<double, D, 1>(mesh.rest.row(v).transpose()))) found.push_back(v);
  }
  return found;
}

// What is asked of the handles, of the mesh.
template <int D>
InversionFreeProblem<D> MakeProblem(SimplexMesh<D> mesh, const Vector<HandleMotion<D>>& handles,
                                    deform::HandleWeightKind kind) {
  Vector<Vector<int>> sets;
  for (const HandleMotion<D>& handle : handles)
    sets.push_back(handle.vertices);
  const Result<Eigen::MatrixXd> weights = HandleWeights(mesh, sets, kind);
  InversionFreeProblem<D> problem;
  if (!weights.ok()) return problem;
  problem.rotations = BlendRotations(mesh, handles, *weights);
  for (const HandleMotion<D>& handle : handles) {
    problem.target_vertices.insert(problem.target_vertices.end(), handle.vertices.begin(),
                                   handle.vertices.end());
  }
  problem.targets.resize(static_cast<Eigen::Index>(problem.target_vertices.size()), D);
  Eigen::Index row = 0;
  for (const HandleMotion<D>& handle : handles) {
    for (const int v : handle.vertices)
      problem.targets.row(row++) = handle.Apply(mesh.rest.row(v).transpose()).transpose();
  }
  problem.mesh = std::move(mesh);
  return problem;
}

// One end of a bar along z is held, the other turned about z and pulled.
inline Vector<HandleMotion<3>> TwistBar(const TetMesh& mesh, double angle, double stretch = 0) {
  const double end = mesh.rest.col(2).maxCoeff();
  HandleMotion<3> held, turned;
  held.vertices = VerticesWhere(mesh, [](const auto& p) { return p.z() < 1e-9; });
  turned.vertices = VerticesWhere(mesh, [&](const auto& p) { return p.z() > end - 1e-9; });
  turned.turn = {0, 0, angle};
  turned.translation = {0, 0, stretch * end};
  return {held, turned};
}

// The border of a square is held, a disc in its middle turned.
inline Vector<HandleMotion<2>> Swirl(const TriangleMesh& mesh, double angle) {
  HandleMotion<2> border, middle;
  border.vertices =
      VerticesWhere(mesh, [](const auto& p) { return p.cwiseAbs().maxCoeff() > 1 - 1e-9; });
  middle.vertices = VerticesWhere(mesh, [](const auto& p) { return p.norm() < 0.15; });
  middle.turn[0] = angle;
  return {border, middle};
}

}  // namespace limber::test
