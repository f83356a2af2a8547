#include "bench/made_surface.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::bench {
namespace {

using Eigen::Vector3d;

// A ring of sectors * steps points and the next wider one, which has one more in each sector.
// `small` and `large` give the number of a ring's point i, counted around.
template <class Small, class Large>
void AddBand(int sectors, int steps, const Small& small, const Large& large, bool flipped,
             Vector<uint32_t>* triangles) {
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    if (flipped) std::swap(b, c);
    triangles->insert(triangles->end(), {a, b, c});
  };
  for (int sector = 0; sector < sectors; ++sector) {
    for (int j = 0; j <= steps; ++j) {
      const int inner = sector * steps + j, outer = sector * (steps + 1) + j;
      add(small(inner), large(outer), large(outer + 1));
      if (j < steps) add(small(inner), large(outer + 1), small(inner + 1));
    }
  }
}

// An octahedron subdivided n times along each edge and blown up to a sphere: rings of
// 4, 8, ..., 4 n, ..., 8, 4 vertices between two poles.
class RingSphere {
 public:
  explicit RingSphere(int n) : n_(n) {}

  Vector<Vector3d> Points() const {
    Vector<Vector3d> points;
    for (int ring = 0; ring <= 2 * n_; ++ring) {
      const double polar = std::numbers::pi * ring / (2 * n_);
      for (int i = 0; i < RingSize(ring); ++i) {
        const double around = 2 * std::numbers::pi * i / RingSize(ring);
        points.emplace_back(std::sin(polar) * std::cos(around), std::cos(polar),
                            -std::sin(polar) * std::sin(around));
      }
    }
    return points;
  }

  Vector<uint32_t> Triangles() const {
    Vector<uint32_t> triangles;
    for (int ring = 0; ring < n_; ++ring) {
      Join(ring, ring + 1, false, &triangles);
      Join(2 * n_ - ring, 2 * n_ - ring - 1, true, &triangles);
    }
    return triangles;
  }

 private:
  int num_vertices() const { return 4 * n_ * n_ + 2; }

  int RingSize(int ring) const { return std::max(1, 4 * std::min(ring, 2 * n_ - ring)); }

  uint32_t At(int ring, int i) const {
    int start = 0;  // sums of arithmetic series from the nearer pole
    if (ring > 0 && ring <= n_) start = 1 + 2 * ring * (ring - 1);
    if (ring > n_) start = num_vertices() - 1 - 2 * (2 * n_ - ring) * (2 * n_ - ring + 1);
    if (ring == 2 * n_) start = num_vertices() - 1;
    return static_cast<uint32_t>(start + i % RingSize(ring));
  }

  // A ring and the next one nearer to the equator.
  void Join(int small, int large, bool flipped, Vector<uint32_t>* triangles) const {
    AddBand(
        4, std::min(small, 2 * n_ - small), [&](int i) { return At(small, i); },
        [&](int i) { return At(large, i); }, flipped, triangles);
  }

  int n_;
};

}  // namespace

MadeSurface MakeSphere(int num_points) {
  const RingSphere sphere(
      std::max(1, static_cast<int>(std::ceil(std::sqrt((num_points - 2) / 4.0)))));
  return {sphere.Points(), sphere.Triangles()};
}

// Rings of 1, 6, 12, ..., 6 n points.
MadeSurface MakeDisc(int num_points) {
  const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(num_points / 3.0) - 0.5)));
  MadeSurface disc;
  disc.points.emplace_back(0, 0, 0);
  for (int ring = 1; ring <= n; ++ring) {
    for (int i = 0; i < 6 * ring; ++i) {
      const double around = 2 * std::numbers::pi * i / (6 * ring);
      disc.points.emplace_back(std::cos(around) * ring / n, std::sin(around) * ring / n, 0);
    }
  }
  const auto at = [](int ring, int i) {
    return static_cast<uint32_t>(ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring));
  };
  for (int ring = 0; ring < n; ++ring) {
    AddBand(
        6, ring, [&](int i) { return at(ring, i); }, [&](int i) { return at(ring + 1, i); }, false,
        &disc.triangles);
  }
  return disc;
}

}  // namespace limber::bench
