// A lumpy, many-layered surface to shoot at, and the slow way to know what is hit.
#pragma once

#include "core/vector.h"
#include "pick/picker.h"
#include "rig/skin_mesh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace limber::test {

using Vec3d = Eigen::Vector3d;

inline Vec3d ToEigen(Vec3 v) {
  return {v.x, v.y, v.z};
}

inline Vec3 FromEigen(const Vec3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// A torus of `rings` x `sides` quads whose draw vertices are doubled along both seams, so that draw
// and solve vertices differ; radius 1 and 0.4.
struct TorusScene {
  SkinMesh mesh;
  Vector<Vec3> rest;  // solve vertices

  TorusScene(int rings, int sides) {
    mesh.num_solve_vertices = static_cast<uint32_t>(rings * sides);
    for (int i = 0; i < rings; ++i) {
      for (int j = 0; j < sides; ++j) {
        const double u = 2 * std::numbers::pi * i / rings, v = 2 * std::numbers::pi * j / sides;
        const double r = 1 + 0.4 * std::cos(v);
        rest.push_back(FromEigen({r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v)}));
      }
    }
    for (int i = 0; i <= rings; ++i) {
      for (int j = 0; j <= sides; ++j) {
        mesh.solve_vertex.push_back(static_cast<uint32_t>(i % rings * sides + j % sides));
      }
    }
    mesh.num_draw_vertices = static_cast<uint32_t>(mesh.solve_vertex.size());
    for (int i = 0; i < rings; ++i) {
      for (int j = 0; j < sides; ++j) {
        const auto a = static_cast<uint32_t>(i * (sides + 1) + j), b = a + 1;
        const uint32_t c = a + static_cast<uint32_t>(sides) + 1, d = c + 1;
        mesh.triangles.insert(mesh.triangles.end(), {a, c, d, a, d, b});
      }
    }
  }

  // Bent, twisted and dented.
  Vector<Vec3> Deformed(double amount) const {
    Vector<Vec3> result;
    for (const Vec3& rest_point : rest) {
      Vec3d p = ToEigen(rest_point);
      const double twist = amount * p.x();
      p = Eigen::AngleAxisd(twist, Vec3d::UnitX()) * p;
      p.z() += 0.3 * amount * std::sin(3 * p.x()) + 0.1 * amount * p.y() * p.y();
      p.y() *= 1 + 0.5 * amount * std::cos(5 * p.z());
      result.push_back(FromEigen(p));
    }
    return result;
  }
};

struct BruteHit {
  double distance = 0;
  uint32_t triangle = 0;
  double edge_margin = 0;  // smallest barycentric of the hit: below 0 outside, near 0 on an edge
};

// Every triangle, by planes through the origin of the ray: does not share a line with the code
// under test. `slack` widens (or with a minus shrinks) triangles in barycentrics.
inline std::optional<BruteHit> BruteForce(const SkinMesh& mesh, const Vector<Vec3>& points,
                                          const PickRay& ray, double slack) {
  const Vec3d origin = ToEigen(ray.origin), direction = ToEigen(ray.direction).normalized();
  std::optional<BruteHit> best;
  for (uint32_t t = 0; t < mesh.num_triangles(); ++t) {
    Eigen::Matrix3d m;  // columns: edges and the direction back; solve for barycentrics, distance
    const auto corner = [&](int i) {
      return ToEigen(points[mesh.solve_vertex[mesh.triangles[3 * t + static_cast<uint32_t>(i)]]]);
    };
    m << corner(1) - corner(0), corner(2) - corner(0), -direction;
    if (std::abs(m.determinant()) < 1e-14) continue;
    const Vec3d x = m.inverse() * (origin - corner(0));
    const double margin = std::min({x[0], x[1], 1 - x[0] - x[1]});
    if (margin < -slack || x[2] < ray.near_distance || x[2] > ray.far_distance) continue;
    if (!best || x[2] < best->distance) best = {x[2], t, margin};
  }
  return best;
}

// Rays from a sphere of radius 4 to points within a box of half-width 1.6.
inline PickRay RandomRay(std::mt19937* random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> inside(-1.6, 1.6);
  const Vec3d from = 4 * Vec3d(normal(*random), normal(*random), normal(*random)).normalized();
  const Vec3d to(inside(*random), inside(*random), inside(*random));
  PickRay ray;
  ray.origin = FromEigen(from);
  ray.direction = FromEigen(to - from);
  return ray;
}

}  // namespace limber::test
