// Characters made in code are what a bake may be given, and the drag path is one that means
// something.
#include "bench/made_character.h"

#include "bench/drag_path.h"
#include "bench/made_surface.h"
#include "bench/paper_table.h"
#include "bench/quick_bake.h"
#include "core/vector.h"
#include "rig/rig.h"

#include <gtest/gtest.h>

#include <map>

namespace limber::bench {
namespace {

// How often each edge is used in each direction, and by how much Euler's characteristic says.
struct Topology {
  int characteristic = 0, num_rim_edges = 0;
  bool consistent = true;  // no edge twice in the same direction
};

Topology TopologyOf(const MadeSurface& surface) {
  std::map<std::pair<uint32_t, uint32_t>, int> halves;
  for (size_t t = 0; t < surface.triangles.size(); t += 3) {
    for (size_t i = 0; i < 3; ++i)
      ++halves[{surface.triangles[t + i], surface.triangles[t + (i + 1) % 3]}];
  }
  Topology topology;
  int num_edges = 0;
  for (const auto& [edge, count] : halves) {
    const bool has_twin = halves.contains({edge.second, edge.first});
    topology.consistent = topology.consistent && count == 1;
    topology.num_rim_edges += has_twin ? 0 : 1;
    num_edges += has_twin && edge.first > edge.second ? 0 : 1;
  }
  topology.characteristic = static_cast<int>(surface.points.size()) - num_edges +
                            static_cast<int>(surface.triangles.size() / 3);
  return topology;
}

TEST(MadeSurface, Sphere_IsClosedAndSeenFromOutside) {
  for (const int wanted : {6, 7, 100, 4000}) {
    const MadeSurface sphere = MakeSphere(wanted);
    EXPECT_GE(static_cast<int>(sphere.points.size()), wanted);
    const Topology topology = TopologyOf(sphere);
    EXPECT_EQ(topology.characteristic, 2);
    EXPECT_EQ(topology.num_rim_edges, 0);
    EXPECT_TRUE(topology.consistent);
    for (size_t t = 0; t < sphere.triangles.size(); t += 3) {
      const Eigen::Vector3d& a = sphere.points[sphere.triangles[t]];
      const Eigen::Vector3d& b = sphere.points[sphere.triangles[t + 1]];
      const Eigen::Vector3d& c = sphere.points[sphere.triangles[t + 2]];
      ASSERT_GT((b - a).cross(c - a).dot(a + b + c), 0);
    }
  }
}

TEST(MadeSurface, Disc_HasOneRimAndThePapersSize) {
  for (const int wanted : {7, 481, 817, 3532}) {
    const MadeSurface disc = MakeDisc(wanted);
    EXPECT_NEAR(static_cast<double>(disc.points.size()), wanted, 0.03 * wanted);
    const Topology topology = TopologyOf(disc);
    EXPECT_EQ(topology.characteristic, 1);
    EXPECT_GT(topology.num_rim_edges, 0);
    EXPECT_TRUE(topology.consistent);
  }
}

TEST(MadeCharacter, Planar_LiesInThePlaneAndFoldsNowhereAtRest) {
  const bake::RawCharacter raw = MakeRawCharacter({3532, 6, 3, 0, 2});
  for (const bake::PointMatrix& shape : raw.shapes)
    EXPECT_EQ(shape.col(2).cwiseAbs().maxCoeff(), 0);
  for (size_t t = 0; t < raw.triangles.size(); t += 3) {
    const auto point = [&](size_t i) -> Eigen::Vector3d {
      return raw.shapes[0].row(raw.triangles[t + i]).transpose();
    };
    ASSERT_GT((point(1) - point(0)).cross(point(2) - point(0)).z(), 0);
  }
}

std::shared_ptr<const Rig> QuickRig(const CharacterSize& size) {
  const bake::RawCharacter raw = MakeRawCharacter(size);
  auto baked = BakeQuickly(raw, raw.marked_handles, {}, {});
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  return Rig::Create(raw.name, std::move(baked->tables), std::move(baked->mesh)).value();
}

// Baked for the number of axes asked for, and every shape comes in turn on the way.
TEST(DragPath, BothDimensions_UseEveryShape) {
  for (const int dimension : {2, 3}) {
    const auto rig = QuickRig({500, 4, 3, 0, dimension});
    ASSERT_EQ(rig->tables().dimension, dimension);
    PoseState pose = PoseState::Create(rig).value();
    Vector<double> most(3, 0);
    for (const Vector<Vec3>& targets : DragPath(*rig, 60)) {
      ASSERT_TRUE(SetTargets(targets, &pose).ok());
      ASSERT_TRUE(pose.Solve({}, nullptr).ok());
      const auto blend = pose.blend_weights();
      for (size_t i = 0; i < blend.size(); ++i)
        most[i % 3] = std::max(most[i % 3], blend[i]);
    }
    for (const double weight : most)
      EXPECT_GT(weight, 0.5) << dimension;
  }
}

TEST(DragPath, Cancelled_SaysSo) {
  const auto rig = QuickRig({100, 3, 2, 0, 2});
  int asked = 0;
  const auto times = TimeAlternations(rig, 10, [&](double) { return ++asked < 5; });
  EXPECT_EQ(times.status().message(), "cancelled");
  EXPECT_EQ(asked, 5);
}

// A row in its own size, whatever it is made of.
TEST(PaperTable, EveryRow_GivesACharacterOfItsSize) {
  for (const PaperRow& row : PaperTable()) {
    const auto character = CharacterOf(row, {});
    ASSERT_TRUE(character.ok()) << character.status().message();
    EXPECT_FALSE(character->is_the_papers);
    const bake::RawCharacter& raw = character->raw;
    EXPECT_EQ(raw.shapes.size(), static_cast<size_t>(row.shapes));
    EXPECT_EQ(raw.marked_handles.size(), static_cast<size_t>(row.handles));
    EXPECT_NEAR(raw.num_draw_vertices(), row.vertices, 0.04 * row.vertices) << row.name;
  }
}

}  // namespace
}  // namespace limber::bench
