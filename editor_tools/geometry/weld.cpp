#include "geometry/weld.h"

#include "core/vector.h"
#include "geometry/union_find.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

namespace limber::geometry {
namespace {

uint64_t Mix(uint64_t hash, uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
  hash *= 0xff51afd7ed558ccdULL;
  return hash ^ (hash >> 33);
}

// The bits of a number, the two zeros being one.
uint64_t Bits(double x) {
  x += 0.0;
  uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof(bits));
  return bits;
}

bool Identical(std::span<const PointMatrix> shapes, int a, int b) {
  return std::all_of(shapes.begin(), shapes.end(),
                     [&](const PointMatrix& shape) { return shape.row(a) == shape.row(b); });
}

bool Coincide(std::span<const PointMatrix> shapes, int a, int b, double tolerance) {
  return std::all_of(shapes.begin(), shapes.end(), [&](const PointMatrix& shape) {
    return (shape.row(a) - shape.row(b)).norm() <= tolerance;
  });
}

// Unites vertices that are bitwise equal in every shape; returns one of each set.
Vector<int> UniteIdentical(std::span<const PointMatrix> shapes, int num_vertices, UnionFind* sets) {
  std::unordered_multimap<uint64_t, int> seen;
  seen.reserve(static_cast<size_t>(num_vertices));
  Vector<int> distinct;
  for (int v = 0; v < num_vertices; ++v) {
    uint64_t hash = 0;
    for (const PointMatrix& shape : shapes) {
      for (int axis = 0; axis < 3; ++axis)
        hash = Mix(hash, Bits(shape(v, axis)));
    }
    const auto [begin, end] = seen.equal_range(hash);
    const auto twin = std::find_if(
        begin, end, [&](const auto& entry) { return Identical(shapes, entry.second, v); });
    if (twin != end) {
      sets->Unite(twin->second, v);
    } else {
      seen.emplace(hash, v);
      distinct.push_back(v);
    }
  }
  return distinct;
}

// A mix of all shapes whose coefficients sum to one: points within the tolerance in every shape are
// within it here too, and a base mesh that is collapsed to a point does not fill one cell.
PointMatrix MixShapes(std::span<const PointMatrix> shapes) {
  PointMatrix mix = PointMatrix::Zero(shapes[0].rows(), 3);
  double total = 0;
  for (size_t s = 0; s < shapes.size(); ++s) {
    const double golden = 0.6180339887498949 * static_cast<double>(s);
    const double coefficient = 1 + 0.5 * (golden - std::floor(golden));
    mix += coefficient * shapes[s];
    total += coefficient;
  }
  return mix / total;
}

struct Cell {
  int64_t x = 0, y = 0, z = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

struct CellHash {
  size_t operator()(const Cell& c) const {
    return Mix(Mix(Mix(0, static_cast<uint64_t>(c.x)), static_cast<uint64_t>(c.y)),
               static_cast<uint64_t>(c.z));
  }
};

int64_t CellIndex(double x, double cell_size) {
  const double index = std::floor(x / cell_size);
  constexpr double kLimit = 4e18;  // fits 64 bits with room for the neighbour's +-1
  return std::isnan(index) ? 0 : static_cast<int64_t>(std::clamp(index, -kLimit, kLimit));
}

using Grid = std::unordered_map<Cell, Vector<int>, CellHash>;

// Calls visit(vertex) for every vertex in the cell and in the 26 around it.
template <class Visitor>
void VisitNear(const Grid& grid, const Cell& cell, Visitor&& visit) {
  for (int64_t neighbour = 0; neighbour < 27; ++neighbour) {
    const auto found = grid.find(
        {cell.x + neighbour % 3 - 1, cell.y + neighbour / 3 % 3 - 1, cell.z + neighbour / 9 - 1});
    if (found == grid.end()) continue;
    for (const int vertex : found->second)
      visit(vertex);
  }
}

// Unites all pairs within the tolerance; a grid over the mix of shapes offers the candidates.
void UniteCoincident(std::span<const PointMatrix> shapes, const Vector<int>& candidates,
                     double tolerance, UnionFind* sets) {
  const PointMatrix mix = MixShapes(shapes);
  // A hair larger than the tolerance: the mix is rounded.
  const double cell_size = tolerance * (1 + 1e-9);
  Grid grid;
  grid.reserve(candidates.size());
  for (const int v : candidates) {
    const Cell cell{CellIndex(mix(v, 0), cell_size), CellIndex(mix(v, 1), cell_size),
                    CellIndex(mix(v, 2), cell_size)};
    VisitNear(grid, cell, [&](int other) {
      if (sets->Find(other) != sets->Find(v) && Coincide(shapes, other, v, tolerance)) {
        sets->Unite(other, v);
      }
    });
    grid[cell].push_back(v);
  }
}

}  // namespace

SolveMesh WeldMesh(std::span<const PointMatrix> shapes, std::span<const uint32_t> triangles,
                   double tolerance) {
  SolveMesh mesh;
  if (shapes.empty()) return mesh;
  const int num_draw = static_cast<int>(shapes[0].rows());
  UnionFind sets(num_draw);
  const Vector<int> distinct = UniteIdentical(shapes, num_draw, &sets);
  if (tolerance > 0) UniteCoincident(shapes, distinct, tolerance, &sets);

  // A set's root is its first draw vertex, so that roots appear in the order of the numbering.
  mesh.solve_vertex.resize(static_cast<size_t>(num_draw));
  Vector<int> first_draw;
  for (int v = 0; v < num_draw; ++v) {
    const int root = sets.Find(v);
    if (root == v) {
      mesh.solve_vertex[v] = static_cast<uint32_t>(first_draw.size());
      first_draw.push_back(v);
    } else {
      mesh.solve_vertex[v] = mesh.solve_vertex[root];
    }
  }
  for (const PointMatrix& shape : shapes) {
    PointMatrix welded(static_cast<Eigen::Index>(first_draw.size()), 3);
    for (size_t i = 0; i < first_draw.size(); ++i) {
      welded.row(static_cast<Eigen::Index>(i)) = shape.row(first_draw[i]);
    }
    mesh.shapes.push_back(std::move(welded));
  }
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const int a = static_cast<int>(mesh.solve_vertex[triangles[t]]);
    const int b = static_cast<int>(mesh.solve_vertex[triangles[t + 1]]);
    const int c = static_cast<int>(mesh.solve_vertex[triangles[t + 2]]);
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

}  // namespace limber::geometry
