#include "bake/handle_reach.h"

#include "core/vector.h"
#include "geometry/geodesic.h"
#include "threads/parallel_for.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::bake {
namespace {

// The smallest float that is not below x: a length that was reached stays within reach.
float RoundedUp(double x) {
  const auto rounded = static_cast<float>(x);
  return static_cast<double>(rounded) < x
             ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
             : rounded;
}

}  // namespace

Vector<float> HandleReach(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                          double scale, int num_threads) {
  const size_t num_handles = handle_vertices.size();
  Vector<float> reach(num_handles * num_handles, 0.0f);
  for (int s = 0; s < mesh.num_shapes(); ++s) {
    const geometry::PointMatrix& points = mesh.shapes[s];
    const geometry::SurfaceDistance surface(mesh, s);
    // Each round writes its own entries: those of the pairs whose first handle it is.
    threads::ParallelFor(static_cast<int>(num_handles) - 1, num_threads, [&](int round) {
      const auto a = static_cast<size_t>(round);
      const Eigen::VectorXd distance = surface.From(handle_vertices[a]);
      for (size_t b = a + 1; b < num_handles; ++b) {
        const double over = distance(handle_vertices[b]);
        if (!std::isfinite(over)) continue;
        // First order in the size of the triangles, a path may come out shorter than a straight
        // line.
        const double straight =
            (points.row(handle_vertices[a]) - points.row(handle_vertices[b])).norm();
        float& entry = reach[a * num_handles + b];
        entry = std::max(entry, RoundedUp(std::max(over, straight) / scale));
        reach[b * num_handles + a] = entry;
      }
    });
  }
  return reach;
}

}  // namespace limber::bake
