#include "generate/surface.h"

#include <Eigen/Geometry>

#include <array>
#include <map>
#include <set>
#include <utility>

namespace limber::content {
namespace {

using Triangles = std::vector<uint32_t>;
using Edge = std::pair<uint32_t, uint32_t>;

// Field values at the corners of a grid of cells, and the vertex of each cell that has one.
class SurfaceNet {
 public:
  SurfaceNet(const Field& field, const Vector3d& low, const Vector3d& high, double cell)
      : low_(low),
        cell_(cell) {
    for (int axis = 0; axis < 3; ++axis) {
      size_[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / cell)) + 1;
    }
    values_.resize(static_cast<size_t>(size_[0]) * size_[1] * size_[2]);
    cell_vertex_.assign(values_.size(), 0);
    ForEachCorner([&](const Eigen::Array3i& at) { values_[Index(at)] = field(Place(at)); });
  }

  Surface Build() {
    Surface surface;
    ForEachCorner([&](const Eigen::Array3i& at) { AddVertex(at, &surface); });
    ForEachCorner([&](const Eigen::Array3i& at) { AddQuads(at, &surface); });
    return surface;
  }

 private:
  template <class Visit>
  void ForEachCorner(const Visit& visit) const {
    for (int z = 0; z < size_[2]; ++z) {
      for (int y = 0; y < size_[1]; ++y) {
        for (int x = 0; x < size_[0]; ++x)
          visit(Eigen::Array3i(x, y, z));
      }
    }
  }

  size_t Index(const Eigen::Array3i& at) const {
    return (static_cast<size_t>(at[2]) * size_[1] + at[1]) * size_[0] + at[0];
  }

  Vector3d Place(const Eigen::Array3i& at) const {
    return low_ + cell_ * at.cast<double>().matrix();
  }

  // The mean of the crossings on the twelve edges of the cell that begins at corner `at`.
  void AddVertex(const Eigen::Array3i& at, Surface* surface) {
    if ((at + 1 >= Eigen::Array3i(size_[0], size_[1], size_[2])).any()) return;
    Vector3d sum = Vector3d::Zero();
    int num_crossings = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 4; ++side) {
        Eigen::Array3i from = at;
        from[(axis + 1) % 3] += side & 1;
        from[(axis + 2) % 3] += side >> 1;
        Eigen::Array3i to = from;
        to[axis] += 1;
        const double a = values_[Index(from)], b = values_[Index(to)];
        if ((a < 0) == (b < 0)) continue;
        sum += Place(from) + a / (a - b) * (Place(to) - Place(from));
        ++num_crossings;
      }
    }
    if (num_crossings == 0) return;
    cell_vertex_[Index(at)] = static_cast<uint32_t>(surface->positions.size());
    surface->positions.emplace_back(sum / num_crossings);
  }

  // One quad for each grid edge that leaves corner `at` and crosses the surface.
  void AddQuads(const Eigen::Array3i& at, Surface* surface) const {
    for (int axis = 0; axis < 3; ++axis) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      if (at[axis] + 1 >= size_[axis] || at[b] == 0 || at[c] == 0) continue;
      Eigen::Array3i to = at;
      to[axis] += 1;
      const bool inside = values_[Index(at)] < 0;
      if (inside == (values_[Index(to)] < 0)) continue;
      std::array<uint32_t, 4> quad{};
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Array3i cell = at;
        cell[b] -= (corner == 0 || corner == 3) ? 1 : 0;
        cell[c] -= corner < 2 ? 1 : 0;
        quad[corner] = cell_vertex_[Index(cell)];
      }
      if (!inside) std::swap(quad[1], quad[3]);
      const std::vector<Vector3d>& p = surface->positions;
      const bool cut = (p[quad[0]] - p[quad[2]]).norm() > (p[quad[1]] - p[quad[3]]).norm();
      const int k = cut ? 1 : 0;
      for (int i : {k, k + 1, k + 2, k, k + 2, (k + 3) % 4}) {
        surface->triangles.push_back(quad[i % 4]);
      }
    }
  }

  Vector3d low_;
  double cell_;
  std::array<int, 3> size_{};
  std::vector<double> values_;
  std::vector<uint32_t> cell_vertex_;
};

// The cosine of the angle at `apex` of the triangle (apex, a, b).
double CosineAt(const Vector3d& apex, const Vector3d& a, const Vector3d& b) {
  return (a - apex).normalized().dot((b - apex).normalized());
}

// One pass of edge flips where the two opposite angles sum to more than a half turn and the
// neighbours are nearly coplanar. Each triangle takes part in one flip a pass at most.
void FlipEdges(const std::vector<Vector3d>& p, Triangles* triangles) {
  std::map<Edge, std::array<int, 2>> sides;  // directed edge -> triangle, corner opposite
  std::set<Edge> present;
  for (size_t t = 0; t < triangles->size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = (*triangles)[t + k], b = (*triangles)[t + (k + 1) % 3];
      sides[{a, b}] = {static_cast<int>(t), (k + 2) % 3};
      present.insert(std::minmax(a, b));
    }
  }
  std::vector<bool> touched(triangles->size(), false);
  for (const auto& [edge, left] : sides) {
    const auto [a, b] = edge;
    const auto found = sides.find({b, a});
    if (a > b || found == sides.end()) continue;
    const auto& right = found->second;
    if (touched[left[0]] || touched[right[0]]) continue;
    const uint32_t c = (*triangles)[left[0] + left[1]], d = (*triangles)[right[0] + right[1]];
    const double cos_c = CosineAt(p[c], p[a], p[b]), cos_d = CosineAt(p[d], p[a], p[b]);
    if (std::acos(cos_c) + std::acos(cos_d) < 3.2 || present.count(std::minmax(c, d)) > 0) continue;
    const Vector3d n1 = (p[b] - p[a]).cross(p[c] - p[a]).normalized();
    const Vector3d n2 = (p[a] - p[b]).cross(p[d] - p[b]).normalized();
    if (n1.dot(n2) < 0.85) continue;
    const Triangles one = {c, a, d}, two = {c, d, b};
    std::copy(one.begin(), one.end(), triangles->begin() + left[0]);
    std::copy(two.begin(), two.end(), triangles->begin() + right[0]);
    present.erase(std::minmax(a, b));
    present.insert(std::minmax(c, d));
    touched[left[0]] = touched[right[0]] = true;
  }
}

// Newton steps along the gradient back to the zero set.
Vector3d Project(const Field& field, Vector3d p) {
  for (int step = 0; step < 3; ++step)
    p -= field(p) * FieldNormal(field, p);
  return p;
}

// One sweep: every vertex towards the area-weighted centre of its triangles, along the surface.
void Relax(const Field& field, Surface* surface) {
  std::vector<Vector3d>& p = surface->positions;
  std::vector<Vector3d> centre(p.size(), Vector3d::Zero());
  std::vector<double> weight(p.size(), 0);
  for (size_t t = 0; t < surface->triangles.size(); t += 3) {
    const uint32_t* v = &surface->triangles[t];
    const double area = (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]).norm();
    const Vector3d middle = (p[v[0]] + p[v[1]] + p[v[2]]) / 3;
    for (int k = 0; k < 3; ++k) {
      centre[v[k]] += area * middle;
      weight[v[k]] += area;
    }
  }
  for (size_t v = 0; v < p.size(); ++v) {
    if (weight[v] <= 0) continue;
    const Vector3d normal = FieldNormal(field, p[v]);
    const Vector3d move = centre[v] / weight[v] - p[v];
    p[v] = Project(field, p[v] + 0.7 * (move - normal * normal.dot(move)));
  }
}

}  // namespace

Vector3d FieldNormal(const Field& field, const Vector3d& p, double step) {
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d d = step * Vector3d::Unit(axis);
    gradient[axis] = field(p + d) - field(p - d);
  }
  const double length = gradient.norm();
  return length > 0 ? Vector3d(gradient / length) : Vector3d::UnitY();
}

Surface ExtractSurface(const Field& field, const Vector3d& low, const Vector3d& high, double cell) {
  Surface surface = SurfaceNet(field, low, high, cell).Build();
  for (int round = 0; round < 5; ++round) {
    for (int sweep = 0; sweep < 3; ++sweep)
      Relax(field, &surface);
    for (int pass = 0; pass < 3; ++pass)
      FlipEdges(surface.positions, &surface.triangles);
  }
  for (int sweep = 0; sweep < 4; ++sweep)
    Relax(field, &surface);
  // Over a good part of a cell: fields of limbs jump by a hair where the nearest point of the spine
  // passes a corner of its polyline, and a narrow difference across such a jump points anywhere.
  for (const Vector3d& p : surface.positions)
    surface.normals.push_back(FieldNormal(field, p, 0.25 * cell));
  return surface;
}

}  // namespace limber::content
