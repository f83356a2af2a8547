#include "geometry/intrinsic_delaunay.h"

#include "core/vector.h"

#include <cmath>

namespace limber::geometry {
namespace {

// Of the opposite cotangents' sizes. Below it an edge counts as Delaunay, so that no rounding makes
// the two diagonals of cocircular corners take turns.
constexpr double kCocircular = 1e-10;

bool IsDelaunay(const IntrinsicTriangulation& triangulation, int h) {
  const double a = OppositeCotangent(triangulation, h);
  const double b = OppositeCotangent(triangulation, triangulation.twin[h]);
  return a + b >= -kCocircular * (1 + std::abs(a) + std::abs(b));
}

// Halfedges whose edges are to be looked at, each at most once.
class EdgeQueue {
 public:
  explicit EdgeQueue(const IntrinsicTriangulation& triangulation)
      : twin_(triangulation.twin),
        queued_(triangulation.twin.size(), false),
        ring_(triangulation.twin.size()) {
    for (int h = 0; h < triangulation.num_halfedges(); ++h)
      Push(h);
  }

  bool empty() const { return count_ == 0; }

  void Push(int h) {
    if (queued_[h] || queued_[twin_[h]]) return;
    queued_[h] = true;
    size_t place = first_ + count_++;
    if (place >= ring_.size()) place -= ring_.size();
    ring_[place] = h;
  }

  int Pop() {
    const int h = ring_[first_];
    if (++first_ == ring_.size()) first_ = 0;
    --count_;
    queued_[h] = false;
    return h;
  }

 private:
  const Vector<int>& twin_;
  Vector<char> queued_;
  Vector<int> ring_;
  size_t first_ = 0, count_ = 0;
};

}  // namespace

double CotangentWeight(const IntrinsicTriangulation& triangulation, int h) {
  return 0.5 * (OppositeCotangent(triangulation, h) +
                OppositeCotangent(triangulation, triangulation.twin[h]));
}

bool FlipToDelaunay(int64_t max_flips, IntrinsicTriangulation* triangulation) {
  EdgeQueue queue(*triangulation);
  bool is_delaunay = true;
  for (int64_t num_flips = 0; !queue.empty();) {
    const int h = queue.Pop();
    if (IsDelaunay(*triangulation, h)) continue;
    if (num_flips == max_flips) return false;
    const int g = triangulation->twin[h];
    if (!FlipEdge(h, triangulation)) {
      is_delaunay = false;
      continue;
    }
    ++num_flips;
    // The four sides; the edge itself is Delaunay now.
    for (const int side : {h, Previous(h), g, Previous(g)})
      queue.Push(side);
  }
  return is_delaunay;
}

}  // namespace limber::geometry
