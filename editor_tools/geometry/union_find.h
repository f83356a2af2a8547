// Disjoint sets of 0..n-1 with path halving; a set's root is always its smallest member, so that
// results do not depend on the order of the unions.
#pragma once

#include "core/vector.h"

#include <numeric>
#include <utility>

namespace limber::geometry {

class UnionFind {
 public:
  explicit UnionFind(int count) : parent_(static_cast<size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int Find(int i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void Unite(int a, int b) {
    a = Find(a);
    b = Find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

 private:
  Vector<int> parent_;
};

}  // namespace limber::geometry
