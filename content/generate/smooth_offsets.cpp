#include "generate/smooth_offsets.h"

#include <set>
#include <utility>

namespace limber::content {

void SmoothOffsets(const std::vector<uint32_t>& triangles, const std::vector<Vector3d>& rest,
                   int passes, const std::vector<double>& strength, std::vector<Vector3d>* shape) {
  std::set<std::pair<uint32_t, uint32_t>> directed;
  for (size_t i = 0; i < triangles.size(); ++i) {
    directed.insert({triangles[i], triangles[i - i % 3 + (i + 1) % 3]});
  }
  std::vector<std::vector<uint32_t>> around(rest.size()), rim(rest.size());
  for (const auto& [a, b] : directed) {
    around[a].push_back(b);
    if (directed.count({b, a}) > 0) continue;
    rim[a].push_back(b);
    rim[b].push_back(a);
  }
  std::vector<Vector3d> offset(rest.size()), smooth(rest.size());
  for (size_t v = 0; v < rest.size(); ++v)
    offset[v] = (*shape)[v] - rest[v];
  for (int pass = 0; pass < passes; ++pass) {
    for (size_t v = 0; v < rest.size(); ++v) {
      const std::vector<uint32_t>& others = rim[v].empty() ? around[v] : rim[v];
      Vector3d sum = Vector3d::Zero();
      for (uint32_t other : others)
        sum += offset[other];
      const double give = others.empty() ? 0 : 0.5 * strength[v];
      smooth[v] = offset[v];
      if (give > 0) smooth[v] += give * (sum / double(others.size()) - offset[v]);
    }
    offset.swap(smooth);
  }
  for (size_t v = 0; v < rest.size(); ++v)
    (*shape)[v] = rest[v] + offset[v];
}

}  // namespace limber::content
