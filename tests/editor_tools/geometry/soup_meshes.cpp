#include "editor_tools/geometry/soup_meshes.h"

#include "core/vector.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace limber::test {
namespace {

double Uniform(std::mt19937* random) {
  return static_cast<double>((*random)()) / 4294967296.0;
}

SolveMesh MakeIcosahedron() {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  SolveMesh mesh;
  PointMatrix points(12, 3);
  for (int i = 0; i < 12; ++i) {
    const int axis = i / 4;
    points(i, axis) = 0;
    points(i, (axis + 1) % 3) = i % 2 == 0 ? 1 : -1;
    points(i, (axis + 2) % 3) = i % 4 < 2 ? g : -g;
  }
  mesh.shapes = {points.rowwise().normalized()};
  const double side = 2 / std::sqrt(1 + g * g);
  const auto near = [&](int a, int b) {
    return (mesh.shapes[0].row(a) - mesh.shapes[0].row(b)).norm() < 1.1 * side;
  };
  for (int a = 0; a < 12; ++a) {
    for (int b = a + 1; b < 12; ++b) {
      for (int c = b + 1; c < 12; ++c) {
        if (near(a, b) && near(b, c) && near(c, a)) mesh.triangles.push_back({a, b, c});
      }
    }
  }
  return mesh;
}

// Counter-clockwise, and at least a hundredth as high as long.
bool IsFitToUse(const PointMatrix& flat, int a, int b, int c) {
  const Eigen::RowVector3d u = flat.row(b) - flat.row(a), v = flat.row(c) - flat.row(a);
  const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
  return u.x() * v.y() - u.y() * v.x() > 0.01 * longest * longest;
}

}  // namespace

SolveMesh MakeIcosphere(int num_subdivisions) {
  SolveMesh mesh = MakeIcosahedron();
  for (int n = 0; n < num_subdivisions; ++n) {
    Vector<Eigen::RowVector3d> added;
    std::map<std::pair<int, int>, int> middles;
    const int first = mesh.num_vertices();
    const auto middle = [&](int a, int b) {
      const auto [it, is_new] =
          middles.try_emplace(std::minmax(a, b), first + static_cast<int>(added.size()));
      if (is_new) added.push_back((mesh.shapes[0].row(a) + mesh.shapes[0].row(b)).normalized());
      return it->second;
    };
    Vector<std::array<int, 3>> triangles;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.shapes[0].conservativeResize(first + static_cast<int>(added.size()), 3);
    for (size_t i = 0; i < added.size(); ++i)
      mesh.shapes[0].row(first + static_cast<int>(i)) = added[i];
    mesh.triangles = triangles;
  }
  return mesh;
}

SolveMesh MakeJitteredSquare(int n, uint32_t seed) {
  SolveMesh mesh = MakeGrid(n, n);
  std::mt19937 random(seed);
  for (int y = 1; y < n; ++y) {
    for (int x = 1; x < n; ++x) {
      mesh.shapes[0](y * (n + 1) + x, 0) += 0.6 * Uniform(&random) - 0.3;
      mesh.shapes[0](y * (n + 1) + x, 1) += 0.6 * Uniform(&random) - 0.3;
    }
  }
  mesh.shapes[0] /= n;
  return mesh;
}

SolveMesh RandomlyFlipped(const SolveMesh& flat, int num_tries, uint32_t seed) {
  SolveMesh mesh = flat;
  std::map<std::pair<int, int>, std::pair<size_t, int>> side_of;  // directed edge -> its triangle
  const auto put = [&](size_t t, const std::array<int, 3>& triangle) {
    mesh.triangles[t] = triangle;
    for (int i = 0; i < 3; ++i)
      side_of[{triangle[i], triangle[(i + 1) % 3]}] = {t, i};
  };
  for (size_t t = 0; t < flat.triangles.size(); ++t)
    put(t, flat.triangles[t]);
  std::mt19937 random(seed);
  for (int i = 0; i < num_tries; ++i) {
    const size_t t = random() % mesh.triangles.size();
    const auto side = static_cast<int>(random() % 3);
    const int a = mesh.triangles[t][side], b = mesh.triangles[t][(side + 1) % 3];
    const int c = mesh.triangles[t][(side + 2) % 3];
    const auto other = side_of.find({b, a});
    if (other == side_of.end()) continue;
    const auto [s, other_side] = other->second;
    const int d = mesh.triangles[s][(other_side + 2) % 3];
    if (!IsFitToUse(mesh.shapes[0], a, d, c) || !IsFitToUse(mesh.shapes[0], d, b, c)) continue;
    side_of.erase({a, b});
    side_of.erase({b, a});
    put(t, {a, d, c});
    put(s, {d, b, c});
  }
  return mesh;
}

SolveMesh MakeBook(int num_pages) {
  SolveMesh mesh;
  constexpr int kRows = 3, kColumns = 2;
  const int page_size = (kRows + 1) * kColumns;
  PointMatrix points(kRows + 1 + num_pages * page_size, 3);
  for (int y = 0; y <= kRows; ++y)
    points.row(y) << 0, y, 0;
  for (int page = 0; page < num_pages; ++page) {
    const double angle = 0.3 + 2 * std::acos(-1.0) * std::pow((page + 0.5) / num_pages, 1.4);
    const int first = kRows + 1 + page * page_size;
    const auto vertex = [&](int x, int y) { return x == 0 ? y : first + (x - 1) + y * kColumns; };
    for (int y = 0; y <= kRows; ++y) {
      for (int x = 1; x <= kColumns; ++x)
        points.row(vertex(x, y)) << 0.8 * x * std::cos(angle), y, 0.8 * x * std::sin(angle);
    }
    for (int y = 0; y < kRows; ++y) {
      for (int x = 0; x < kColumns; ++x) {
        const int a = vertex(x, y), b = vertex(x + 1, y);
        const int c = vertex(x, y + 1), d = vertex(x + 1, y + 1);
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      }
    }
  }
  mesh.shapes = {points};
  return mesh;
}

SolveMesh MakeSoup(int num_vertices, int num_triangles, uint32_t seed) {
  SolveMesh mesh;
  std::mt19937 random(seed);
  PointMatrix points(num_vertices, 3);
  for (double& x : points.reshaped())
    x = Uniform(&random);
  const auto vertex = [&] { return static_cast<int>(random() % uint32_t(num_vertices)); };
  while (static_cast<int>(mesh.triangles.size()) < num_triangles) {
    const int a = vertex(), b = vertex(), c = vertex();
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  mesh.shapes = {points};
  return mesh;
}

void Spoil(uint32_t seed, SolveMesh* mesh) {
  std::mt19937 random(seed);
  PointMatrix& points = mesh->shapes[0];
  const size_t count = mesh->triangles.size();
  for (size_t i = 0; i < count / 5 + 1; ++i) {
    std::array<int, 3> copy = mesh->triangles[random() % count];
    if (i % 2 == 0) std::swap(copy[0], copy[1]);
    mesh->triangles.push_back(copy);
  }
  const auto some = [&] { return mesh->triangles[random() % count]; };
  const auto moved = some();
  points.row(moved[0]) = points.row(moved[1]);
  const auto cap = some();
  points.row(cap[2]) = 0.4 * points.row(cap[0]) + 0.6 * points.row(cap[1]);
  const auto needle = some();
  points.row(needle[1]) = points.row(needle[0]) + 1e-9 * Eigen::RowVector3d(1, -2, 1);
  const int flap = mesh->num_vertices();
  points.conservativeResize(flap + 2, 3);
  points.row(flap) << 0.3, -0.2, 0.9;
  points.row(flap + 1) << 5, 5, 5;
  mesh->triangles.push_back({some()[0], flap, some()[1]});
  if (mesh->triangles.back()[0] == mesh->triangles.back()[2]) mesh->triangles.pop_back();
  mesh->triangles.push_back({moved[0], moved[1], flap});
}

Eigen::MatrixXd SummedCotangents(const SolveMesh& mesh) {
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(mesh.num_vertices(), mesh.num_vertices());
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const int o = triangle[corner], i = triangle[(corner + 1) % 3],
                j = triangle[(corner + 2) % 3];
      const Eigen::Vector3d a = mesh.shapes[0].row(i) - mesh.shapes[0].row(o);
      const Eigen::Vector3d b = mesh.shapes[0].row(j) - mesh.shapes[0].row(o);
      const double weight = 0.5 * a.dot(b) / a.cross(b).norm();
      laplacian(i, i) += weight;
      laplacian(j, j) += weight;
      laplacian(i, j) -= weight;
      laplacian(j, i) -= weight;
    }
  }
  return laplacian;
}

SolveMesh Rewound(const SolveMesh& mesh, uint32_t seed) {
  SolveMesh result = mesh;
  std::mt19937 random(seed);
  const Vector<int> order = Shuffle(static_cast<int>(mesh.triangles.size()), seed);
  for (size_t t = 0; t < order.size(); ++t) {
    std::array<int, 3> triangle = mesh.triangles[t];
    std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
    if (random() % 2 == 0) std::swap(triangle[0], triangle[1]);
    result.triangles[order[t]] = triangle;
  }
  return result;
}

Eigen::VectorXd SolveWithFixed(const Eigen::MatrixXd& laplacian, const Eigen::VectorXd& right_side,
                               const Vector<bool>& is_fixed, const Eigen::VectorXd& fixed_values) {
  Eigen::MatrixXd matrix = laplacian;
  Eigen::VectorXd rhs = right_side;
  for (Eigen::Index v = 0; v < rhs.size(); ++v) {
    if (!is_fixed[v]) continue;
    rhs -= matrix.col(v) * fixed_values(v);
    matrix.row(v).setZero();
    matrix.col(v).setZero();
    matrix(v, v) = 1;
  }
  for (Eigen::Index v = 0; v < rhs.size(); ++v) {
    if (is_fixed[v]) rhs(v) = fixed_values(v);
  }
  return matrix.partialPivLu().solve(rhs);
}

Vector<bool> OnOutline(const SolveMesh& mesh) {
  Vector<bool> on_outline;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const double x = mesh.shapes[0](v, 0), y = mesh.shapes[0](v, 1);
    on_outline.push_back(x == 0 || y == 0 || x == 1 || y == 1);
  }
  return on_outline;
}

}  // namespace limber::test
