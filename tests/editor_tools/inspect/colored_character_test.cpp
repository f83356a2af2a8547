// What a character is dressed in is its own data.
#include "inspect/colored_character.h"

#include "core/vector.h"
#include "runtime/solve/solved_character.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limber::inspect {
namespace {

TEST(ColorByWeight, TextureCoordinatesAreTheWeights) {
  const auto rig = test::BakeInMemory(test::MakeBendCylinder(10, 12));
  ASSERT_NE(rig, nullptr);
  for (int handle = 0; handle < rig->num_handles(); ++handle) {
    const ColoredCharacter character = ColorByWeight(*rig, handle);
    const SkinMesh& mesh = character.mesh;
    ASSERT_EQ(mesh.texcoords.size(), 2 * size_t{mesh.num_draw_vertices});
    for (size_t d = 0; d < mesh.num_draw_vertices; ++d) {
      const size_t at = size_t{mesh.solve_vertex[d]} * mesh.num_handles + handle;
      EXPECT_EQ(mesh.texcoords[2 * d], rig->mesh().weights[at]);
    }
  }
}

TEST(ColorByGroup, EachTriangleHasTheColourOfMostOfItsCorners) {
  const auto rig = test::BakeInMemory(test::MakeBendCylinder(10, 12));
  ASSERT_NE(rig, nullptr);
  Vector<int> groups;
  for (uint32_t v = 0; v < rig->mesh().num_solve_vertices; ++v)
    groups.push_back(static_cast<int>(v * 7 / 3 % 5));
  const ColoredCharacter character = ColorByGroup(*rig, groups, Palette(5));
  const SkinMesh &mesh = character.mesh, &plain = rig->mesh();
  ASSERT_EQ(mesh.num_triangles(), plain.num_triangles());
  ASSERT_EQ(mesh.num_draw_vertices, 3 * mesh.num_triangles());
  ASSERT_EQ(character.materials.images[0].width, 5u);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const uint32_t v = mesh.solve_vertex[mesh.triangles[i]];
    EXPECT_EQ(v, plain.solve_vertex[plain.triangles[i]]) << "the surface stays";
  }
  for (size_t first = 0; first < mesh.triangles.size(); first += 3) {
    int counts[5] = {};
    for (size_t i = first; i < first + 3; ++i)
      ++counts[groups[mesh.solve_vertex[i]]];
    const auto texel = static_cast<int>(mesh.texcoords[2 * first] * 5);
    EXPECT_EQ(counts[texel], *std::max_element(counts, counts + 5));
    for (size_t i = first; i < first + 3; ++i)
      EXPECT_EQ(mesh.texcoords[2 * i], mesh.texcoords[2 * first]);
  }
}

TEST(MixedByBlendWeights, ExamplesAloneKeepTheirColours) {
  const Vector<Color> colors = Palette(3);
  const Vector<double> blend = {1, 0, 0, 0, 0, 1, 0.5, 0.5, 0};
  const Vector<Color> mixed = MixedByBlendWeights(blend, colors);
  ASSERT_EQ(mixed.size(), 3u);
  EXPECT_EQ(mixed[0], colors[0]);
  EXPECT_EQ(mixed[1], colors[2]);
  for (size_t channel = 0; channel < 3; ++channel)
    EXPECT_DOUBLE_EQ(mixed[2][channel], 0.5 * (colors[0][channel] + colors[1][channel]));
}

}  // namespace
}  // namespace limber::inspect
