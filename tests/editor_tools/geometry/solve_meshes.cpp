#include "editor_tools/geometry/solve_meshes.h"

#include "core/vector.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

namespace limber::test {

SolveMesh MakeGrid(int columns, int rows) {
  SolveMesh mesh;
  const int row = columns + 1;
  PointMatrix points(row * (rows + 1), 3);
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= columns; ++x)
      points.row(y * row + x) << x, y, 0;
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int a = y * row + x, b = a + 1, c = a + row, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  mesh.shapes = {points};
  return mesh;
}

SolveMesh MakeBlob(int around, int rings) {
  SolveMesh mesh;
  PointMatrix points(around * rings + 2, 3);
  for (int ring = 0; ring < rings; ++ring) {
    const double theta = std::numbers::pi * (ring + 1) / (rings + 1);
    for (int i = 0; i < around; ++i) {
      const double phi = 2 * std::numbers::pi * i / around;
      const double radius =
          1 + 0.3 * std::sin(2 * phi + 0.4) * std::sin(theta) + 0.2 * std::cos(3 * theta + phi);
      points.row(ring * around + i) << radius * std::sin(theta) * std::cos(phi),
          radius * std::cos(theta), radius * std::sin(theta) * std::sin(phi);
    }
  }
  const int north = around * rings, south = north + 1;
  points.row(north) << 0, 1.2, 0;
  points.row(south) << 0, -1.2, 0;
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around, last = (rings - 1) * around;
    mesh.triangles.push_back({north, next, i});
    mesh.triangles.push_back({south, last + i, last + next});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int a = ring * around + i, b = ring * around + next;
      mesh.triangles.push_back({a, b, a + around});
      mesh.triangles.push_back({b, b + around, a + around});
    }
  }
  mesh.shapes = {points};
  return mesh;
}

void Append(const SolveMesh& part, const Eigen::RowVector3d& offset, SolveMesh* mesh) {
  const int first = mesh->num_vertices();
  for (size_t s = 0; s < mesh->shapes.size(); ++s) {
    PointMatrix joined(first + part.num_vertices(), 3);
    joined << mesh->shapes[s], part.shapes[s].rowwise() + offset;
    mesh->shapes[s] = joined;
  }
  for (const auto& [a, b, c] : part.triangles) {
    mesh->triangles.push_back({a + first, b + first, c + first});
  }
}

Vector<int> Shuffle(int count, uint32_t seed) {
  Vector<int> order(static_cast<size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  for (size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random() % i]);
  return order;
}

SolveMesh Renumbered(const SolveMesh& mesh, const Vector<int>& order) {
  SolveMesh result = mesh;
  for (size_t s = 0; s < mesh.shapes.size(); ++s) {
    for (int v = 0; v < mesh.num_vertices(); ++v) {
      result.shapes[s].row(order[v]) = mesh.shapes[s].row(v);
    }
  }
  for (auto& triangle : result.triangles) {
    for (int& v : triangle)
      v = order[v];
  }
  for (geometry::Bridge& bridge : result.bridges) {
    bridge.a = order[bridge.a];
    bridge.b = order[bridge.b];
  }
  for (size_t v = 0; v < mesh.component.size(); ++v)
    result.component[order[v]] = mesh.component[v];
  return result;
}

}  // namespace limber::test
