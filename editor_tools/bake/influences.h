// How many handles a vertex may follow: weights cut down to the largest few before the tensors are
// summed over them, so that what the solver minimises is what the skin shows.
#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace limber::bake {

struct InfluenceReport {
  int kept = 0;              // K; 0: all
  int most = 0;              // the most handles that one vertex followed before
  int64_t cut_vertices = 0;  // vertices that lost some
  // Against the weights before, over all entries: the largest difference, and the root mean square
  // over vertices of a row's.
  double largest_change = 0;
  double rms_change = 0;
};

// weights: V x H, rows that sum to one. Each row keeps its `most_kept` largest (the first of
// equals), scaled to sum to one again: a handle's own vertex keeps its weight of one. most_kept <=
// 0 keeps all.
InfluenceReport PruneInfluences(int most_kept, Eigen::MatrixXd* weights);

}  // namespace limber::bake
