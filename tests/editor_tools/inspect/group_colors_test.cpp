// Every group has a colour of its own, and groups side by side do not look alike.
#include "inspect/group_colors.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace limber::inspect {
namespace {

// A grid of side x side patches, each a group, triangles across all borders.
struct Patches {
  SkinMesh mesh;
  Vector<int> groups;
};

Patches MakePatches(uint32_t side) {
  Patches patches;
  const auto at = [side](uint32_t x, uint32_t y) { return y * side + x; };
  for (uint32_t v = 0; v < side * side; ++v) {
    patches.mesh.solve_vertex.push_back(v);
    patches.groups.push_back(static_cast<int>(v * 7 % (side * side)));  // neighbours far in number
  }
  for (uint32_t y = 0; y + 1 < side; ++y) {
    for (uint32_t x = 0; x + 1 < side; ++x) {
      for (const uint32_t v :
           {at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)})
        patches.mesh.triangles.push_back(v);
    }
  }
  return patches;
}

double Distance(const Color& x, const Color& y) {
  const Oklab p = ToOklab(x), q = ToOklab(y);
  return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b);
}

double LeastAcrossBorders(const Patches& patches, const Vector<Color>& colors) {
  double least = 1;
  const auto& triangles = patches.mesh.triangles;
  for (size_t i = 0; i < triangles.size(); ++i) {
    const auto a = static_cast<size_t>(patches.groups[triangles[i]]);
    const auto b = static_cast<size_t>(patches.groups[triangles[i - i % 3 + (i + 1) % 3]]);
    least = std::min(least, Distance(colors[a], colors[b]));
  }
  return least;
}

TEST(GroupColors, AreAllOfThePalette) {
  const Patches patches = MakePatches(5);
  Vector<Color> colors = GroupColors(patches.mesh, patches.groups, 25);
  Vector<Color> palette = Palette(25);
  std::sort(colors.begin(), colors.end());
  std::sort(palette.begin(), palette.end());
  EXPECT_EQ(colors, palette);
}

TEST(GroupColors, NeighboursLookDifferent) {
  for (const uint32_t side : {2u, 4u, 6u}) {
    const Patches patches = MakePatches(side);
    const auto num_groups = static_cast<int>(patches.groups.size());
    const auto colors = GroupColors(patches.mesh, patches.groups, num_groups);
    EXPECT_GT(LeastAcrossBorders(patches, colors), 0.17) << side;
    EXPECT_GE(LeastAcrossBorders(patches, colors), LeastAcrossBorders(patches, Palette(num_groups)))
        << "no worse than in the order of their numbers, " << side;
  }
}

TEST(GroupColors, GroupsWithoutNeighboursOrVertices_HaveColoursToo) {
  const SkinMesh none;
  EXPECT_EQ(GroupColors(none, {}, 4), Palette(4));
  EXPECT_TRUE(GroupColors(none, {}, 0).empty());
}

}  // namespace
}  // namespace limber::inspect
