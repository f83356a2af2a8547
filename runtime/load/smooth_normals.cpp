#include "load/smooth_normals.h"

#include "core/vector.h"

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

}  // namespace

Vector<Vec3> SmoothNormals(std::span<const Vec3> positions, std::span<const uint32_t> shared,
                           std::span<const uint32_t> triangles) {
  Vector<Double3> sums(positions.size(), Double3{});
  for (size_t t = 0; t + 3 <= triangles.size(); t += 3) {
    const Double3 a = Widen(positions[triangles[t]]);
    const Double3 area = Cross(Minus(Widen(positions[triangles[t + 1]]), a),
                               Minus(Widen(positions[triangles[t + 2]]), a));
    for (size_t corner = t; corner < t + 3; ++corner) {
      Double3& sum = sums[shared[triangles[corner]]];
      sum = AddScaled(sum, 1, area);
    }
  }
  Vector<Vec3> normals;
  normals.reserve(positions.size());
  for (const uint32_t id : shared) {
    Double3 normal = sums[id];
    normals.push_back(Normalise(&normal) ? Narrow(normal) : Vec3{0, 0, 1});
  }
  return normals;
}

void CompleteNormals(std::span<const Vec3> positions, std::span<const uint32_t> shared,
                     std::span<const uint32_t> triangles, Vector<Vec3>* normals) {
  Vector<Vec3> smooth;
  for (size_t v = 0; v < normals->size(); ++v) {
    Double3 normal = Widen((*normals)[v]);
    if (Normalise(&normal)) {
      (*normals)[v] = Narrow(normal);
      continue;
    }
    if (smooth.empty()) smooth = SmoothNormals(positions, shared, triangles);
    (*normals)[v] = smooth[v];
  }
}

}  // namespace limber
