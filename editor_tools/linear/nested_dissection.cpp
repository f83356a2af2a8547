#include "linear/nested_dissection.h"

#include "core/vector.h"

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <utility>

namespace limber::linear {
namespace {

using Eigen::SparseMatrix;

constexpr size_t kSmallPart = 200;

// Where the separating level may lie, of a part's columns.
constexpr double kEarliest = 0.35, kLatest = 0.65;

class Dissection {
 public:
  explicit Dissection(const SparseMatrix<double>& Q)
      : Q_(Q),
        places_(static_cast<size_t>(Q.cols())),
        part_(places_.size(), 0),
        level_(places_.size(), 0) {}

  Vector<int> Run() {
    Part whole;
    for (int column = 0; column < Q_.cols(); ++column)
      whole.columns.push_back(column);
    whole.end = static_cast<int>(whole.columns.size());
    Vector<Part> parts;
    parts.push_back(std::move(whole));
    while (!parts.empty()) {
      const Part part = std::move(parts.back());
      parts.pop_back();
      Split(part, &parts);
    }
    return places_;
  }

 private:
  // Columns that take the places before `end`.
  struct Part {
    Vector<int> columns;
    int end = 0;
  };

  // Levels of a search within the part numbered mark, from `start`, which it fills with columns
  // level by level; returns where each level begins, and the end.
  Vector<size_t> Search(int start, int mark, Vector<int>* reached) {
    const int seen = ++last_mark_;
    reached->assign(1, start);
    part_[static_cast<size_t>(start)] = seen;
    Vector<size_t> levels = {0};
    for (size_t from = 0; from < reached->size();) {
      const size_t end = reached->size();
      levels.push_back(end);
      for (; from < end; ++from) {
        level_[static_cast<size_t>((*reached)[from])] = static_cast<int>(levels.size()) - 2;
        for (SparseMatrix<double>::InnerIterator it(Q_, (*reached)[from]); it; ++it) {
          int& number = part_[static_cast<size_t>(it.row())];
          if (number != mark) continue;
          number = seen;
          reached->push_back(static_cast<int>(it.row()));
        }
      }
    }
    return levels;
  }

  void Mark(const Vector<int>& columns) {
    ++last_mark_;
    for (const int column : columns)
      part_[static_cast<size_t>(column)] = last_mark_;
  }

  void Split(const Part& part, Vector<Part>* parts) {
    if (part.columns.size() <= kSmallPart) return PlaceByDegree(part);
    Mark(part.columns);
    Vector<int> reached;
    Search(part.columns[0], last_mark_, &reached);
    if (reached.size() < part.columns.size()) return SplitOff(std::move(reached), part, parts);
    // From the farthest column, twice: from one end to the other.
    Vector<size_t> levels;
    for (int again = 0; again < 2; ++again)
      levels = Search(reached.back(), last_mark_, &reached);
    const size_t chosen = SmallestLevel(levels, reached.size());
    if (chosen == 0) return PlaceByDegree(part);
    SplitAt(reached, levels[chosen], levels[chosen + 1], part.end, parts);
  }

  // What the search did not reach is a part by itself.
  void SplitOff(Vector<int> reached, const Part& part, Vector<Part>* parts) {
    Part rest;
    for (const int column : part.columns) {
      if (part_[static_cast<size_t>(column)] != last_mark_) rest.columns.push_back(column);
    }
    rest.end = part.end;
    const int end = part.end - static_cast<int>(rest.columns.size());
    parts->push_back(std::move(rest));
    parts->push_back({std::move(reached), end});
  }

  // The smallest level that leaves enough on both sides, 0 for none.
  static size_t SmallestLevel(const Vector<size_t>& levels, size_t count) {
    size_t chosen = 0;
    for (size_t level = 1; level + 2 < levels.size(); ++level) {
      const auto before = static_cast<double>(levels[level]);
      const auto through = static_cast<double>(levels[level + 1]);
      if (through < kEarliest * static_cast<double>(count)) continue;
      if (before > kLatest * static_cast<double>(count)) break;
      const auto size = [&](size_t l) { return levels[l + 1] - levels[l]; };
      if (chosen == 0 || size(level) < size(chosen)) chosen = level;
    }
    return chosen;
  }

  // Columns [first, end) of `reached`, a level, separate those before from those after; the ones
  // that touch nothing after them need not.
  void SplitAt(const Vector<int>& reached, size_t first, size_t end, int place,
               Vector<Part>* parts) {
    Vector<int> before(reached.begin(), reached.begin() + static_cast<ptrdiff_t>(first));
    Vector<int> after(reached.begin() + static_cast<ptrdiff_t>(end), reached.end());
    for (size_t i = first; i < end; ++i) {
      const int column = reached[i], level = level_[static_cast<size_t>(column)];
      bool touches = false;
      for (SparseMatrix<double>::InnerIterator it(Q_, column); it && !touches; ++it) {
        const auto row = static_cast<size_t>(it.row());
        touches = part_[row] == last_mark_ && level_[row] > level;
      }
      if (touches) {
        places_[static_cast<size_t>(column)] = --place;
      } else {
        before.push_back(column);
      }
    }
    const int middle = place - static_cast<int>(after.size());
    parts->push_back({std::move(after), place});
    parts->push_back({std::move(before), middle});
  }

  void PlaceByDegree(const Part& part) {
    Vector<Eigen::Triplet<double>> entries;
    for (size_t i = 0; i < part.columns.size(); ++i)
      level_[static_cast<size_t>(part.columns[i])] = static_cast<int>(i);
    Mark(part.columns);
    for (size_t i = 0; i < part.columns.size(); ++i) {
      for (SparseMatrix<double>::InnerIterator it(Q_, part.columns[i]); it; ++it) {
        const auto row = static_cast<size_t>(it.row());
        if (part_[row] == last_mark_) entries.emplace_back(level_[row], static_cast<int>(i), 1.0);
      }
    }
    const auto size = static_cast<Eigen::Index>(part.columns.size());
    SparseMatrix<double> pattern(size, size);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(pattern, order);
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto column =
          static_cast<size_t>(part.columns[static_cast<size_t>(order.indices()(i))]);
      places_[column] = part.end - static_cast<int>(size - i);
    }
  }

  const SparseMatrix<double>& Q_;
  Vector<int> places_;
  Vector<int> part_;   // of each column the last mark or search that had it
  Vector<int> level_;  // within that search, or its number in a small part
  int last_mark_ = 0;
};

}  // namespace

Vector<int> NestedDissection(const SparseMatrix<double>& Q) {
  return Dissection(Q).Run();
}

}  // namespace limber::linear
