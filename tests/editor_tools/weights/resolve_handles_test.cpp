#include "bake/resolve_handles.h"

#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace limber::bake {
namespace {

// The figure 1 square with every source vertex split into two draw vertices, the source's numbers
// running backwards, and one source vertex that nothing uses.
RawCharacter SplitSquare() {
  RawCharacter raw = test::MakeStretchSquare(6);
  const auto count = static_cast<uint32_t>(raw.num_draw_vertices());
  for (PointMatrix& shape : raw.shapes) {
    PointMatrix twice(2 * count, 3);
    twice << shape, shape;
    shape = twice;
  }
  raw.source_vertex.resize(2 * size_t{count});
  for (uint32_t d = 0; d < 2 * count; ++d)
    raw.source_vertex[d] = count - 1 - d % count;
  raw.num_source_vertices = count + 1;
  return raw;
}

geometry::SolveMesh Welded(const RawCharacter& raw) {
  geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 1e-6);
  geometry::ConnectComponents(&mesh);
  return mesh;
}

HandleSpec AtVertex(const char* name, uint32_t vertex) {
  HandleSpec spec;
  spec.name = name;
  spec.source_vertex = vertex;
  return spec;
}

HandleSpec AtPosition(const char* name, Vec3 position) {
  HandleSpec spec;
  spec.name = name;
  spec.position = position;
  return spec;
}

Status Resolve(const Vector<HandleSpec>& specs) {
  const RawCharacter raw = SplitSquare();
  return ResolveHandles(raw, Welded(raw), specs).status();
}

void ExpectError(const Status& status, StatusCode code, std::initializer_list<const char*> words) {
  EXPECT_EQ(status.code(), code) << status.message();
  for (const char* word : words) {
    EXPECT_NE(status.message().find(word), std::string::npos) << status.message();
  }
  EXPECT_EQ(status.message().find('\n'), std::string::npos);
}

TEST(ResolveHandles, VerticesAndPositions_LandOnTheirSolveVertices) {
  const RawCharacter raw = SplitSquare();
  const geometry::SolveMesh mesh = Welded(raw);
  ASSERT_EQ(mesh.num_vertices(), 49);
  HandleSpec free_one = AtPosition("b", {0.49F, 0.01F, 0.2F});  // off the surface
  free_one.pinned = false;
  const Vector<HandleSpec> specs = {AtVertex("a", 48), free_one, AtVertex("c", 0)};
  const auto resolved = ResolveHandles(raw, mesh, specs);
  ASSERT_TRUE(resolved.ok()) << resolved.status().message();
  ASSERT_EQ(resolved->size(), 3U);
  EXPECT_EQ((*resolved)[0].vertex, 0);
  EXPECT_EQ((*resolved)[1].vertex, 24);
  EXPECT_EQ((*resolved)[2].vertex, 48);
  EXPECT_EQ((*resolved)[1].spec.name, "b");
  EXPECT_FALSE((*resolved)[1].spec.pinned);
}

TEST(ResolveHandles, Errors_NameTheHandle) {
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  ExpectError(Resolve({}), StatusCode::kNoHandles, {"--auto-handles"});
  HandleSpec loose = AtVertex("loose", 1);
  loose.pinned = false;
  ExpectError(Resolve({loose}), StatusCode::kNoHandles, {"free", "pin"});
  ExpectError(Resolve({AtVertex("far", 50)}), StatusCode::kInvalidArgument, {"'far'", "50"});
  ExpectError(Resolve({AtVertex("unused", 49)}), StatusCode::kInvalidArgument, {"'unused'", "49"});
  ExpectError(Resolve({AtVertex("twin", 1), AtVertex("twin", 2)}), StatusCode::kInvalidArgument,
              {"'twin'", "name"});
  ExpectError(Resolve({AtVertex("one", 3), AtVertex("two", 3)}), StatusCode::kInvalidArgument,
              {"'one'", "'two'", "same vertex"});
  ExpectError(Resolve({AtPosition("near", {0, 0, 0}), AtPosition("too", {0.01F, 0, 0})}),
              StatusCode::kInvalidArgument, {"'near'", "'too'"});
  ExpectError(Resolve({AtPosition("nan", {not_a_number, 0, 0})}), StatusCode::kInvalidArgument,
              {"'nan'", "finite"});
  ExpectError(Resolve({AtVertex("", 3)}), StatusCode::kInvalidArgument, {"name"});
  HandleSpec both = AtVertex("both", 3);
  both.position = Vec3{};
  ExpectError(Resolve({both}), StatusCode::kInvalidArgument, {"'both'"});
  HandleSpec neither;
  neither.name = "neither";
  ExpectError(Resolve({neither}), StatusCode::kInvalidArgument, {"'neither'"});
}

TEST(ChooseHandles, ComeBackFromResolvingWhereTheyWereChosen) {
  const RawCharacter raw = SplitSquare();
  const geometry::SolveMesh mesh = Welded(raw);
  const Vector<HandleSpec> chosen = ChooseHandles(raw, mesh, 6);
  ASSERT_EQ(chosen.size(), 6U);
  const auto resolved = ResolveHandles(raw, mesh, chosen);
  ASSERT_TRUE(resolved.ok()) << resolved.status().message();
  std::set<int> first_four;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(chosen[i].name, "handle_" + std::to_string(i));
    EXPECT_TRUE(chosen[i].pinned);
    if (i < 4) first_four.insert((*resolved)[i].vertex);
  }
  EXPECT_EQ(first_four, (std::set<int>{0, 6, 42, 48}));  // a square's extremities: its corners
}

TEST(ChooseHandles, Cylinder_StartsAtItsEnds) {
  const RawCharacter raw = test::MakeBendCylinder(12, 20);
  const geometry::SolveMesh mesh = Welded(raw);
  const auto resolved = ResolveHandles(raw, mesh, ChooseHandles(raw, mesh, 2));
  ASSERT_TRUE(resolved.ok());
  const double y0 = mesh.shapes[0]((*resolved)[0].vertex, 1);
  const double y1 = mesh.shapes[0]((*resolved)[1].vertex, 1);
  EXPECT_NEAR(std::abs(y1 - y0), 2, 1e-9);
}

}  // namespace
}  // namespace limber::bake
