// Regions that are stiffer than the rest.
#include "bake/bake.h"
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::bake {
namespace {

// The straight cylinder alone, with these stiffnesses of bottom, middle and top.
RawCharacter MakeCylinder(double bottom, double middle, double top) {
  RawCharacter raw = test::MakeBendCylinder(12, 20);
  for (HandleSpec& handle : raw.marked_handles) {
    handle.stiffness = handle.name == "bottom" ? bottom : handle.name == "top" ? top : middle;
  }
  return raw;
}

struct Stretched {
  PoseReport report;
  Vector<Eigen::Vector3d> points;
  std::shared_ptr<const Rig> rig;

  // By how much the part between two heights at rest is longer now.
  double Stretch(double low, double high) const {
    const auto height = [this](double rest) {
      double sum = 0;
      int count = 0;
      for (uint32_t v = 0; v < points.size(); ++v) {
        if (std::abs(test::ShapePosition(*rig, 0, v).y() - rest) > 0.051) continue;
        sum += points[v].y();
        ++count;
      }
      return sum / count;
    };
    return (height(high) - height(low)) / (high - low);
  }
};

Stretched Stretch(const RawCharacter& raw) {
  Stretched result;
  result.rig = test::BakeInMemory(raw);
  PoseState state = PoseState::Create(result.rig).value();
  EXPECT_TRUE(state.SetTarget(result.rig->FindHandle("top"), {0.1f, 2.6f, 0}).ok());
  PoseOptions options;
  options.iterations = 5000;
  options.settle_tolerance = 1e-10;
  EXPECT_TRUE(state.Solve(options, &result.report).ok());
  result.points = test::SkinNaively(*result.rig, state.transforms());
  return result;
}

TEST(Stiffness, OneEverywhere_IsAsIfNoneWereSaid) {
  const Result<BakedCharacter> plain =
      Bake(test::MakeBendCylinder(12, 20), test::MakeBendCylinder(12, 20).marked_handles, {}, {});
  const RawCharacter raw = MakeCylinder(1, 1, 1);
  const Result<BakedCharacter> said = Bake(raw, raw.marked_handles, {}, {});
  ASSERT_TRUE(plain.ok() && said.ok());
  EXPECT_EQ(plain->tables.mode_edges, said->tables.mode_edges);
  EXPECT_EQ(plain->tables.residual_factor, said->tables.residual_factor);
  EXPECT_EQ(plain->tables.single_group_factors, said->tables.single_group_factors);
}

// A common factor scales every energy and changes no pose.
TEST(Stiffness, TheSameEverywhere_ScalesTheEnergyAlone) {
  const Stretched plain = Stretch(MakeCylinder(1, 1, 1)), stiff = Stretch(MakeCylinder(9, 9, 9));
  EXPECT_NEAR(stiff.report.energy, 3 * plain.report.energy, 1e-4 * plain.report.energy);
  EXPECT_NEAR(stiff.report.elastic, 3 * plain.report.elastic, 1e-4 * plain.report.elastic);
  for (size_t v = 0; v < plain.points.size(); ++v)
    EXPECT_LT((plain.points[v] - stiff.points[v]).norm(), 1e-4);
}

TEST(Stiffness, OfOneRegion_MovesTheStretchToTheOthers) {
  const Stretched plain = Stretch(MakeCylinder(1, 1, 1)), stiff = Stretch(MakeCylinder(1, 1, 100));
  const Stretched soft = Stretch(MakeCylinder(1, 1, 0.05));
  const auto top = [](const Stretched& cylinder) { return cylinder.Stretch(1.4, 1.8) - 1; };
  const auto bottom = [](const Stretched& cylinder) { return cylinder.Stretch(0.2, 0.6) - 1; };
  ASSERT_GT(top(plain), 0.05);
  EXPECT_LT(top(stiff), 0.5 * top(plain));
  EXPECT_GT(bottom(stiff), bottom(plain));
  EXPECT_GT(top(soft), top(plain));
  EXPECT_LT(bottom(soft), bottom(plain));
}

RawCharacter Painted(double low, double high) {
  RawCharacter raw = test::MakeBendCylinder(12, 20);
  for (int v = 0; v < raw.num_draw_vertices(); ++v)
    raw.stiffness.push_back(static_cast<float>(raw.shapes[0](v, 1) < 1 ? low : high));
  return raw;
}

TEST(Stiffness, PaintedOneEverywhere_ChangesNoBit) {
  const RawCharacter plain = test::MakeBendCylinder(12, 20), painted = Painted(1, 1);
  const auto without = Bake(plain, plain.marked_handles, {}, {});
  const auto with = Bake(painted, painted.marked_handles, {}, {});
  ASSERT_TRUE(without.ok() && with.ok());
  EXPECT_EQ(without->tables.mode_edges, with->tables.mode_edges);
  EXPECT_EQ(without->tables.residual_factor, with->tables.residual_factor);
}

// The same everywhere, on the surface or at the handles: both scale every edge alike.
TEST(Stiffness, Painted_MultipliesThatOfTheHandles) {
  const Stretched painted = Stretch(Painted(4, 4)), said = Stretch(MakeCylinder(4, 4, 4));
  EXPECT_NEAR(painted.report.energy, said.report.energy, 1e-5 * said.report.energy);
  RawCharacter both = MakeCylinder(2, 2, 2);
  both.stiffness = Painted(2, 2).stiffness;
  EXPECT_NEAR(Stretch(both).report.energy, said.report.energy, 1e-5 * said.report.energy);
}

TEST(Stiffness, PaintedOnOneHalf_MovesTheStretchToTheOther) {
  const Stretched plain = Stretch(Painted(1, 1)), stiff_top = Stretch(Painted(1, 100));
  EXPECT_LT(stiff_top.Stretch(1.4, 1.8) - 1, 0.5 * (plain.Stretch(1.4, 1.8) - 1));
  EXPECT_GT(stiff_top.Stretch(0.2, 0.6), plain.Stretch(0.2, 0.6));
}

TEST(Stiffness, OfAnotherNumberOfVertices_IsRefused) {
  RawCharacter raw = Painted(1, 1);
  raw.stiffness.pop_back();
  const Status status = Bake(raw, raw.marked_handles, {}, {}).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("stiffness"), std::string::npos) << status.message();
}

TEST(Stiffness, OutOfRange_IsRefusedByName) {
  for (const double wrong : {0.0, -1.0, 1e4, std::nan("")}) {
    const RawCharacter raw = MakeCylinder(1, wrong, 1);
    const Status status = Bake(raw, raw.marked_handles, {}, {}).status();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_NE(status.message().find("middle"), std::string::npos) << status.message();
  }
}

}  // namespace
}  // namespace limber::bake
