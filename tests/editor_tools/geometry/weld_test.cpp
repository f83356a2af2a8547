#include "geometry/weld.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace limber::geometry {
namespace {

PointMatrix Points(std::initializer_list<std::array<double, 3>> rows) {
  PointMatrix points(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::Index i = 0;
  for (const auto& row : rows)
    points.row(i++) << row[0], row[1], row[2];
  return points;
}

// The partition that the welding makes of the draw vertices, whatever its numbers.
std::set<std::set<int>> Partition(const SolveMesh& mesh, const Vector<int>& name_of_draw) {
  std::map<uint32_t, std::set<int>> sets;
  for (size_t d = 0; d < mesh.solve_vertex.size(); ++d) {
    sets[mesh.solve_vertex[d]].insert(name_of_draw[d]);
  }
  std::set<std::set<int>> partition;
  for (const auto& [number, set] : sets)
    partition.insert(set);
  return partition;
}

TEST(WeldMesh, Seam_BecomesOneVertex) {
  // Two triangles that share an edge by position only, as at a texture seam.
  const PointMatrix rest =
      Points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const Vector<uint32_t> triangles = {0, 1, 2, 3, 4, 5};
  const SolveMesh mesh = WeldMesh(std::span(&rest, 1), triangles, 0);
  EXPECT_EQ(mesh.num_vertices(), 4);
  EXPECT_EQ(mesh.solve_vertex, (Vector<uint32_t>{0, 1, 2, 1, 3, 2}));
  EXPECT_EQ(mesh.triangles, (Vector<std::array<int, 3>>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.shapes[0].row(3), rest.row(4));
  EXPECT_TRUE(mesh.component.empty());
  EXPECT_TRUE(mesh.bridges.empty());
}

TEST(WeldMesh, ClosedLipsThatOpenInAnotherShape_StayApart) {
  const PointMatrix rest = Points({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  PointMatrix open = rest;
  open(2, 1) = -0.5;
  const Vector<PointMatrix> shapes = {rest, open};
  const SolveMesh mesh = WeldMesh(shapes, {}, 1e-3);
  EXPECT_EQ(mesh.solve_vertex, (Vector<uint32_t>{0, 1, 2, 1}));
}

TEST(WeldMesh, BaseCollapsedToAPoint_KeepsWhatOtherShapesTellApart) {
  const int count = 2000;
  PointMatrix spread(count, 3);
  for (int i = 0; i < count; ++i)
    spread.row(i) << i, 2 * i, 0;
  const Vector<PointMatrix> shapes = {PointMatrix::Zero(count, 3), spread};
  EXPECT_EQ(WeldMesh(shapes, {}, 1e-3).num_vertices(), count);
}

TEST(WeldMesh, Tolerance_IsAbsoluteAndIncludesItsBorder) {
  const PointMatrix rest = Points({{0, 0, 0}, {0.5, 0, 0}, {100, 0, 0}, {100.75, 0, 0}});
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0.5).num_vertices(), 3);
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0.75).num_vertices(), 2);
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0).num_vertices(), 4);
}

TEST(WeldMesh, PairsAcrossCellBorders_AreFound) {
  // Pairs at every offset from the grid's lines, in all eight directions around the origin.
  for (int direction = 0; direction < 8; ++direction) {
    const Eigen::RowVector3d sign(direction & 1 ? 1 : -1, direction & 2 ? 1 : -1,
                                  direction & 4 ? 1 : -1);
    for (int step = 0; step < 20; ++step) {
      PointMatrix rest(2, 3);
      rest.row(0) = Eigen::RowVector3d(0.013, 0.02, 0.031) * step;
      rest.row(1) = rest.row(0) + 0.0577 * sign;  // distance 0.09994
      EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0.1).num_vertices(), 1);
      EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0.0999).num_vertices(), 2);
    }
  }
}

TEST(WeldMesh, Chain_IsOneVertexInAnyOrder) {
  // Neighbours are within the tolerance, the ends are not: closeness is made transitive.
  const Vector<int> order = test::Shuffle(50, 7);
  PointMatrix rest(50, 3);
  for (int i = 0; i < 50; ++i)
    rest.row(order[i]) << 0.9 * i, 0, 0;
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 1).num_vertices(), 1);
}

TEST(WeldMesh, VertexOrder_ChangesOnlyTheNumbers) {
  const SolveMesh blob = test::MakeBlob(12, 9);
  const int count = blob.num_vertices();
  PointMatrix rest(2 * count, 3);  // every vertex twice, a tenth of them pulled off their twins
  rest << blob.shapes[0], blob.shapes[0];
  for (int v = 0; v < count; v += 10)
    rest.row(count + v).array() += 2e-3;
  const Vector<PointMatrix> shapes = {rest, -2 * rest};
  Vector<int> names(static_cast<size_t>(2 * count));
  for (size_t i = 0; i < names.size(); ++i)
    names[i] = static_cast<int>(i);
  const SolveMesh welded = WeldMesh(shapes, {}, 1e-3);
  EXPECT_EQ(welded.num_vertices(), count + (count + 9) / 10);

  for (const uint32_t seed : {1U, 2U, 3U}) {
    const Vector<int> order = test::Shuffle(2 * count, seed);
    Vector<PointMatrix> shuffled = shapes;
    Vector<int> name_of_draw(order.size());
    for (int v = 0; v < 2 * count; ++v) {
      name_of_draw[order[v]] = v;
      for (size_t s = 0; s < shapes.size(); ++s)
        shuffled[s].row(order[v]) = shapes[s].row(v);
    }
    const SolveMesh again = WeldMesh(shuffled, {}, 1e-3);
    EXPECT_EQ(Partition(again, name_of_draw), Partition(welded, names));
    // Numbers follow the first draw vertices.
    uint32_t next = 0;
    for (const uint32_t v : again.solve_vertex) {
      ASSERT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
}

TEST(WeldMesh, CollapsedTriangle_IsDropped) {
  const PointMatrix rest = Points({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  const Vector<uint32_t> triangles = {0, 1, 2, 0, 1, 3, 1, 1, 3};
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), triangles, 0).triangles.size(), 1U);
}

TEST(WeldMesh, SignedZeros_AreOnePoint) {
  const PointMatrix rest = Points({{0.0, 1, 0}, {-0.0, 1, 0}});
  EXPECT_EQ(WeldMesh(std::span(&rest, 1), {}, 0).num_vertices(), 1);
}

TEST(WeldMesh, NoVertices_GivesAnEmptyMesh) {
  const PointMatrix none(0, 3);
  EXPECT_EQ(WeldMesh(std::span(&none, 1), {}, 1e-6).num_vertices(), 0);
  EXPECT_EQ(WeldMesh({}, {}, 1e-6).num_shapes(), 0);
}

}  // namespace
}  // namespace limber::geometry
