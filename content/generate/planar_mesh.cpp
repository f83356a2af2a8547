#include "generate/planar_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace limber::content {
namespace {

using Face = std::array<uint32_t, 3>;
using Edge = std::pair<uint32_t, uint32_t>;

double Turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

Vector2d Gradient(const PlaneField& field, const Vector2d& p) {
  constexpr double kStep = 1e-5;
  const Vector2d x(kStep, 0), y(0, kStep);
  return Vector2d(field(p + x) - field(p - x), field(p + y) - field(p - y)) / (2 * kStep);
}

// Onto the outline along the gradient.
Vector2d Project(const PlaneField& field, Vector2d p) {
  for (int step = 0; step < 4; ++step) {
    const Vector2d g = Gradient(field, p);
    p -= field(p) * g / std::max(g.squaredNorm(), 1e-6);
  }
  return p;
}

// Walks along the outline from `start`, inside on the left, until it closes.
std::vector<Vector2d> WalkOutline(const PlaneField& field, const Vector2d& start, double step) {
  std::vector<Vector2d> line = {start};
  constexpr size_t kLongest = 100000;
  while (line.size() < kLongest) {
    const Vector2d g = Gradient(field, line.back()).normalized();
    line.push_back(Project(field, line.back() + step * Vector2d(-g.y(), g.x())));
    if (line.size() > 4 && (line.back() - start).norm() < 0.75 * step) break;
  }
  return line;
}

// Points `spacing` apart, or a little less so that they come out even, along a closed line.
std::vector<Vector2d> Resample(std::vector<Vector2d> line, double spacing) {
  line.back() = line.front();
  double length = 0;
  for (size_t i = 1; i < line.size(); ++i)
    length += (line[i] - line[i - 1]).norm();
  const auto count = static_cast<size_t>(std::ceil(length / spacing));
  std::vector<Vector2d> even;
  double at = 0, next = 0;
  for (size_t i = 1; i < line.size() && even.size() < count; ++i) {
    const double piece = (line[i] - line[i - 1]).norm();
    while (next <= at + piece && even.size() < count) {
      even.emplace_back(line[i - 1] + (next - at) / piece * (line[i] - line[i - 1]));
      next += length / double(count);
    }
    at += piece;
  }
  return even;
}

// All outlines: one walk from each sign change of a coarse scan that no earlier walk passed by.
std::vector<Vector2d> OutlinePoints(const PlaneField& field, const Vector2d& low,
                                    const Vector2d& high, double spacing) {
  std::vector<Vector2d> walked, points;
  const auto columns = static_cast<int>(std::ceil((high.x() - low.x()) / spacing));
  const auto rows = static_cast<int>(std::ceil((high.y() - low.y()) / spacing));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = low.x() + column * spacing, y = low.y() + row * spacing;
      if ((field({x, y}) < 0) == (field({x + spacing, y}) < 0)) continue;
      const Vector2d start = Project(field, {x + spacing / 2, y});
      const bool known = std::any_of(walked.begin(), walked.end(), [&](const Vector2d& p) {
        return (p - start).norm() < spacing / 2;
      });
      if (known || std::abs(field(start)) > 1e-6) continue;
      const std::vector<Vector2d> line = WalkOutline(field, start, spacing / 8);
      walked.insert(walked.end(), line.begin(), line.end());
      const std::vector<Vector2d> even = Resample(line, spacing);
      points.insert(points.end(), even.begin(), even.end());
    }
  }
  return points;
}

// A Delaunay triangulation by inserting the points one at a time (Bowyer, Watson 1981).
class Delaunay {
 public:
  explicit Delaunay(const std::vector<Vector2d>& points) : p_(points) {
    const auto n = static_cast<uint32_t>(points.size());
    p_.insert(p_.end(), {Vector2d(-50, -50), Vector2d(50, -50), Vector2d(0, 80)});
    faces_ = {{n, n + 1, n + 2}};
    for (uint32_t v = 0; v < n; ++v)
      Insert(v);
    std::erase_if(faces_, [n](const Face& f) { return f[0] >= n || f[1] >= n || f[2] >= n; });
  }

  const std::vector<Face>& faces() const { return faces_; }

 private:
  bool InCircle(const Face& f, const Vector2d& q) const {
    Eigen::Matrix3d m;
    for (int k = 0; k < 3; ++k) {
      const Vector2d d = p_[f[k]] - q;
      m.row(k) << d.x(), d.y(), d.squaredNorm();
    }
    return m.determinant() > 0;
  }

  void Insert(uint32_t v) {
    std::set<Edge> rim;
    std::erase_if(faces_, [&](const Face& f) {
      if (!InCircle(f, p_[v])) return false;
      for (int k = 0; k < 3; ++k) {
        const Edge edge(f[k], f[(k + 1) % 3]);
        // An edge seen from both sides lies inside the cavity.
        if (rim.erase({edge.second, edge.first}) == 0) rim.insert(edge);
      }
      return true;
    });
    for (const auto& [a, b] : rim)
      faces_.push_back({a, b, v});
  }

  std::vector<Vector2d> p_;
  std::vector<Face> faces_;
};

std::vector<uint32_t> TriangulateInside(const PlaneField& field, const std::vector<Vector2d>& p) {
  std::vector<uint32_t> triangles;
  const Delaunay delaunay(p);
  for (const Face& f : delaunay.faces()) {
    const Vector2d middle = (p[f[0]] + p[f[1]] + p[f[2]]) / 3;
    if (field(middle) >= 0 || Turn(p[f[0]], p[f[1]], p[f[2]]) <= 1e-9) continue;
    triangles.insert(triangles.end(), f.begin(), f.end());
  }
  return triangles;
}

// Inner points towards the mean of their neighbours.
void Relax(PlanarMesh* mesh) {
  std::vector<Vector2d> sum(mesh->positions.size(), Vector2d::Zero());
  std::vector<int> count(mesh->positions.size(), 0);
  for (size_t i = 0; i < mesh->triangles.size(); ++i) {
    const uint32_t v = mesh->triangles[i];
    const uint32_t next = mesh->triangles[i - i % 3 + (i + 1) % 3];
    sum[v] += mesh->positions[next];
    ++count[v];
  }
  for (uint32_t v = mesh->num_outline; v < mesh->positions.size(); ++v) {
    if (count[v] > 0) mesh->positions[v] = sum[v] / count[v];
  }
}

}  // namespace

PlanarMesh FillOutline(const PlaneField& field, const Vector2d& low, const Vector2d& high,
                       double spacing) {
  PlanarMesh mesh;
  mesh.positions = OutlinePoints(field, low, high, spacing);
  mesh.num_outline = static_cast<uint32_t>(mesh.positions.size());
  const double rise = spacing * std::sqrt(0.75);
  for (int row = 0; low.y() + row * rise < high.y(); ++row) {
    for (int column = 0; low.x() + column * spacing < high.x(); ++column) {
      const Vector2d p(low.x() + (column + 0.5 * (row % 2)) * spacing, low.y() + row * rise);
      if (field(p) < -0.65 * spacing) mesh.positions.push_back(p);
    }
  }
  for (int round = 0; round < 4; ++round) {
    mesh.triangles = TriangulateInside(field, mesh.positions);
    for (int sweep = 0; sweep < 3; ++sweep)
      Relax(&mesh);
  }
  mesh.triangles = TriangulateInside(field, mesh.positions);
  return mesh;
}

}  // namespace limber::content
