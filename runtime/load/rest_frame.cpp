#include "load/rest_frame.h"

#include <array>
#include <cmath>

namespace limber {
namespace {

using Double3 = std::array<double, 3>;

Double3 Widen(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Vec3 Narrow(const Double3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Double3 Minus(const Double3& a, const Double3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Double3 AddScaled(const Double3& a, double s, const Double3& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}

double Dot(const Double3& a, const Double3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Double3 Cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// False, and *v unchanged, where it has no direction.
bool Normalise(Double3* v) {
  const double length = std::sqrt(Dot(*v, *v));
  if (!(length > 1e-150) || !std::isfinite(length)) return false;
  for (double& x : *v)
    x /= length;
  return true;
}

// A unit vector orthogonal to the unit vector n.
Double3 AnyOrthogonal(const Double3& n) {
  const Double3 axis = std::abs(n[0]) < 0.6 ? Double3{1, 0, 0} : Double3{0, 1, 0};
  Double3 result = AddScaled(axis, -Dot(axis, n), n);
  return Normalise(&result) ? result : Double3{1, 0, 0};
}

}  // namespace

std::vector<Vec3> SmoothNormals(std::span<const Vec3> positions,
                                std::span<const uint32_t> solve_vertex,
                                std::span<const uint32_t> triangles) {
  std::vector<Double3> sums(positions.size(), Double3{});
  for (size_t t = 0; t + 3 <= triangles.size(); t += 3) {
    const Double3 a = Widen(positions[triangles[t]]);
    const Double3 area = Cross(Minus(Widen(positions[triangles[t + 1]]), a),
                               Minus(Widen(positions[triangles[t + 2]]), a));
    for (size_t corner = t; corner < t + 3; ++corner) {
      Double3& sum = sums[solve_vertex[triangles[corner]]];
      sum = AddScaled(sum, 1, area);
    }
  }
  std::vector<Vec3> normals;
  normals.reserve(positions.size());
  for (const uint32_t solve : solve_vertex) {
    Double3 normal = sums[solve];
    normals.push_back(Normalise(&normal) ? Narrow(normal) : Vec3{0, 0, 1});
  }
  return normals;
}

void CompleteNormals(std::span<const Vec3> positions, std::span<const uint32_t> solve_vertex,
                     std::span<const uint32_t> triangles, std::vector<Vec3>* normals) {
  normals->resize(positions.size());
  std::vector<Vec3> smooth;
  for (size_t v = 0; v < normals->size(); ++v) {
    Double3 normal = Widen((*normals)[v]);
    if (Normalise(&normal)) {
      (*normals)[v] = Narrow(normal);
      continue;
    }
    if (smooth.empty()) smooth = SmoothNormals(positions, solve_vertex, triangles);
    (*normals)[v] = smooth[v];
  }
}

void CompleteTangents(std::span<const Vec3> positions, std::span<const Vec3> normals,
                      std::span<const float> texcoords, std::span<const uint32_t> triangles,
                      std::vector<float>* tangents) {
  tangents->resize(4 * positions.size());
  std::vector<Double3> along_u(positions.size(), Double3{}), along_v = along_u;
  for (size_t t = 0; t + 3 <= triangles.size(); t += 3) {
    const uint32_t i = triangles[t], j = triangles[t + 1], k = triangles[t + 2];
    const Double3 e1 = Minus(Widen(positions[j]), Widen(positions[i]));
    const Double3 e2 = Minus(Widen(positions[k]), Widen(positions[i]));
    const double u1 = double{texcoords[2 * j]} - double{texcoords[2 * i]};
    const double v1 = double{texcoords[2 * j + 1]} - double{texcoords[2 * i + 1]};
    const double u2 = double{texcoords[2 * k]} - double{texcoords[2 * i]};
    const double v2 = double{texcoords[2 * k + 1]} - double{texcoords[2 * i + 1]};
    // The inverse of [u1 v1; u2 v2] without its positive scale: larger triangles count for more.
    const double sign = u1 * v2 - u2 * v1 < 0 ? -1 : 1;
    const Double3 du = AddScaled(AddScaled({}, sign * v2, e1), -sign * v1, e2);
    const Double3 dv = AddScaled(AddScaled({}, sign * u1, e2), -sign * u2, e1);
    for (const uint32_t vertex : {i, j, k}) {
      along_u[vertex] = AddScaled(along_u[vertex], 1, du);
      along_v[vertex] = AddScaled(along_v[vertex], 1, dv);
    }
  }
  for (size_t d = 0; d < positions.size(); ++d) {
    float* tangent = tangents->data() + 4 * d;
    Double3 given = {tangent[0], tangent[1], tangent[2]};
    double handedness = tangent[3] < 0 ? -1 : 1;
    if (!Normalise(&given)) {
      const Double3 n = Widen(normals[d]);
      given = AddScaled(along_u[d], -Dot(along_u[d], n), n);
      if (!Normalise(&given)) given = AnyOrthogonal(n);
      handedness = Dot(Cross(n, given), along_v[d]) < 0 ? -1 : 1;
    }
    for (int axis = 0; axis < 3; ++axis) {
      tangent[axis] = static_cast<float>(given[static_cast<size_t>(axis)]);
    }
    tangent[3] = static_cast<float>(handedness);
  }
}

}  // namespace limber
