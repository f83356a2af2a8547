#include "inspect/group_colors.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace limber::inspect {
namespace {

using Neighbours = Vector<std::set<int>>;  // of each group

Neighbours SharingTriangles(const SkinMesh& mesh, std::span<const int> vertex_group,
                            int num_groups) {
  Neighbours neighbours(static_cast<size_t>(num_groups));
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const size_t next = i % 3 == 2 ? i - 2 : i + 1;
    const int a = vertex_group[mesh.solve_vertex[mesh.triangles[i]]];
    const int b = vertex_group[mesh.solve_vertex[mesh.triangles[next]]];
    if (a == b) continue;
    neighbours[static_cast<size_t>(a)].insert(b);
    neighbours[static_cast<size_t>(b)].insert(a);
  }
  return neighbours;
}

double Distance(const Oklab& x, const Oklab& y) {
  return std::hypot(x.lightness - y.lightness, x.a - y.a, x.b - y.b);
}

// Colours dealt out to groups, and exchanged between two of them.
class Dealing {
 public:
  Dealing(const Vector<Color>& palette, const Neighbours& neighbours)
      : neighbours_(neighbours),
        labs_(palette.size()),
        chosen_(palette.size()) {
    std::transform(palette.begin(), palette.end(), labs_.begin(), ToOklab);
    std::iota(chosen_.begin(), chosen_.end(), size_t{0});
  }

  // Exchanges the colours of two groups if that moves the nearest of their neighbours' colours
  // away.
  bool ExchangeIfBetter(size_t a, size_t b) {
    const double before = std::min(ToNeighbours(a), ToNeighbours(b));
    std::swap(chosen_[a], chosen_[b]);
    if (std::min(ToNeighbours(a), ToNeighbours(b)) > before) return true;
    std::swap(chosen_[a], chosen_[b]);
    return false;
  }

  const Vector<size_t>& chosen() const { return chosen_; }  // index into the palette

 private:
  double ToNeighbours(size_t group) const {
    double least = std::numeric_limits<double>::max();
    for (const int other : neighbours_[group]) {
      const Oklab& theirs = labs_[chosen_[static_cast<size_t>(other)]];
      least = std::min(least, Distance(labs_[chosen_[group]], theirs));
    }
    return least;
  }

  const Neighbours& neighbours_;
  Vector<Oklab> labs_;
  Vector<size_t> chosen_;
};

}  // namespace

Vector<Color> GroupColors(const SkinMesh& mesh, std::span<const int> vertex_group, int num_groups) {
  constexpr int kMaxSweeps = 8;  // each exchange helps the worst of its borders, so that they end
  const Vector<Color> palette = Palette(num_groups);
  const Neighbours neighbours = SharingTriangles(mesh, vertex_group, num_groups);
  Dealing dealing(palette, neighbours);
  bool improves = true;
  for (int sweep = 0; improves && sweep < kMaxSweeps; ++sweep) {
    improves = false;
    for (size_t b = 1; b < palette.size(); ++b) {
      for (size_t a = 0; a < b; ++a)
        improves = dealing.ExchangeIfBetter(a, b) || improves;
    }
  }
  Vector<Color> colors;
  colors.reserve(palette.size());
  for (const size_t index : dealing.chosen())
    colors.push_back(palette[index]);
  return colors;
}

}  // namespace limber::inspect
