#include "bake/influences.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace limber::bake {

InfluenceReport PruneInfluences(int most_kept, Eigen::MatrixXd* weights) {
  InfluenceReport report;
  const auto num_handles = static_cast<int>(weights->cols());
  report.kept = most_kept > 0 && most_kept < num_handles ? most_kept : 0;
  Vector<int> order(static_cast<size_t>(num_handles));
  double squares = 0;
  for (Eigen::Index v = 0; v < weights->rows(); ++v) {
    const Eigen::RowVectorXd before = weights->row(v);
    const auto count = static_cast<int>((before.array() != 0).count());
    report.most = std::max(report.most, count);
    if (report.kept == 0 || count <= report.kept) continue;
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&before](int a, int b) { return before(a) > before(b); });
    for (auto handle = order.begin() + report.kept; handle != order.end(); ++handle)
      (*weights)(v, *handle) = 0;
    weights->row(v) /= weights->row(v).sum();
    const Eigen::RowVectorXd change = weights->row(v) - before;
    report.largest_change = std::max(report.largest_change, change.cwiseAbs().maxCoeff());
    squares += change.squaredNorm();
    ++report.cut_vertices;
  }
  if (weights->rows() > 0)
    report.rms_change = std::sqrt(squares / static_cast<double>(weights->rows()));
  return report;
}

}  // namespace limber::bake
