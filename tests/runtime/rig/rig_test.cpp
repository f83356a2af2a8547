// What Rig::Create lets pass: a good character is bent in one number at a time.
#include "rig/rig.h"

#include "load/rig_loader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace limber {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Parts {
  RigTables tables;
  SkinMesh mesh;
};

Parts GoodParts() {
  const auto rig = LoadRig(LIMBER_SOURCE_DIR "/content/baked/v2/square.glb");
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? Parts{(*rig)->tables(), (*rig)->mesh()} : Parts{};
}

Status CreateWith(const std::function<void(Parts*)>& bend) {
  static const Parts good = GoodParts();
  Parts parts = good;
  bend(&parts);
  return Rig::Create("bent", std::move(parts.tables), std::move(parts.mesh)).status();
}

TEST(Rig, GoodParts_AreAccepted) {
  EXPECT_TRUE(CreateWith([](Parts*) {}).ok());
}

TEST(Rig, EachNumberThatIsNotFinite_IsRefusedWithItsPlace) {
  struct Case {
    const char* place;
    std::function<float*(Parts*)> number;
  };

  const Case cases[] = {
      {"skinning weights: vertex 2, component 1", [](Parts* p) { return &p->mesh.weights[7]; }},
      {"shape 1, vertex 3",
       [](Parts* p) { return &p->mesh.shape_positions[p->mesh.num_solve_vertices + 3].y; }},
      {"normals: vertex 5", [](Parts* p) { return &p->mesh.rest_normals[5].z; }},
      {"tangents: vertex 2, component 3", [](Parts* p) { return &p->mesh.rest_tangents[11]; }},
      {"texture coordinates: vertex 4, component 1",
       [](Parts* p) { return &p->mesh.texcoords[9]; }},
      {"modeTransforms: element 6", [](Parts* p) { return &p->tables.mode_transforms[6]; }},
      {"singleModeTransforms: element 11",
       [](Parts* p) { return &p->tables.single_mode_transforms[11]; }},
      {"handleReach: element 7", [](Parts* p) { return &p->tables.handle_reach[7]; }},
      {"handle \"centre\"", [](Parts* p) { return &p->tables.handles[1].rest_position.y; }},
      {"space origin: element 2", [](Parts* p) { return &p->tables.space.origin[2]; }},
  };
  for (const Case& c : cases) {
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
      const Status status = CreateWith([&](Parts* parts) { *c.number(parts) = bad; });
      EXPECT_EQ(status.code(), StatusCode::kMalformed) << c.place;
      EXPECT_EQ(status.message().rfind(std::string("bent: ") + c.place, 0), 0u)
          << c.place << " in: " << status.message();
    }
  }
}

TEST(Rig, TablesOfVersionTwo_MayBeEmptyButNotOfTheWrongSize) {
  EXPECT_TRUE(CreateWith([](Parts* p) {
                p->tables.handle_reach.clear();
                p->tables.single_mode_transforms.clear();
              }).ok());
  const std::string short_reach =
      CreateWith([](Parts* p) { p->tables.handle_reach.pop_back(); }).message();
  EXPECT_EQ(short_reach, "bent: handleReach: has 8 elements; expected 9");
  const std::string long_transforms =
      CreateWith([](Parts* p) { p->tables.single_mode_transforms.push_back(0); }).message();
  EXPECT_EQ(long_transforms.rfind("bent: singleModeTransforms: has ", 0), 0u) << long_transforms;
  EXPECT_FALSE(CreateWith([](Parts* p) { p->tables.single_edges.clear(); }).ok());
}

TEST(Rig, NegativeReach_IsRefusedByElement) {
  const Status status = CreateWith([](Parts* p) { p->tables.handle_reach[5] = -0.25f; });
  EXPECT_EQ(status.code(), StatusCode::kMalformed);
  EXPECT_EQ(status.message(), "bent: handleReach: element 5 is -0.25; expected zero or more");
}

TEST(Rig, WeightsThatDoNotSumToOne_AreRefusedByVertex) {
  // Three handles: element 120 is the first of vertex 40.
  for (const float change : {1e-3f, -1e-3f, 0.5f, -1.0f}) {
    const Status status = CreateWith([&](Parts* p) { p->mesh.weights[120] += change; });
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << change;
    EXPECT_NE(status.message().find("vertex 40"), std::string::npos) << status.message();
  }
  EXPECT_EQ(CreateWith([](Parts* p) { p->mesh.weights.assign(p->mesh.weights.size(), 0); }).code(),
            StatusCode::kMalformed);
}

TEST(Rig, WeightsRoundedByAnyTool_AreAccepted) {
  const Status status = CreateWith([](Parts* p) {
    for (float& weight : p->mesh.weights)
      weight = std::round(weight * 65535) / 65535;
  });
  EXPECT_TRUE(status.ok()) << status.message();
}

TEST(Rig, CharacterWithoutSize_IsDegenerate) {
  EXPECT_EQ(CreateWith([](Parts* p) {
              p->tables.space.scale = 3e38f;
              for (Vec3& x : p->mesh.shape_positions)
                x = {9 * x.x, 9 * x.y, 9 * x.z};
            }).code(),
            StatusCode::kDegenerate)
      << "its size is no float";
  EXPECT_EQ(CreateWith([](Parts* p) {
              p->mesh.shape_positions.assign(p->mesh.shape_positions.size(), Vec3{1, 1, 1});
            }).code(),
            StatusCode::kDegenerate);
}

TEST(Rig, NamesFromTheFile_CannotBreakTheMessage) {
  const Status status = CreateWith([](Parts* p) {
    p->tables.handles[0].name = p->tables.handles[1].name = "a\nb" + std::string(100000, 'x');
  });
  EXPECT_EQ(status.code(), StatusCode::kMalformed);
  EXPECT_EQ(status.message().find('\n'), std::string::npos);
  EXPECT_LT(status.message().size(), 300u);
  Parts parts = GoodParts();
  parts.mesh.weights.pop_back();
  const Status named = Rig::Create("line\nline" + std::string(100000, 'x'), std::move(parts.tables),
                                   std::move(parts.mesh))
                           .status();
  EXPECT_EQ(named.message().rfind("line\\nline", 0), 0u);
  EXPECT_LT(named.message().size(), 300u);
}

}  // namespace
}  // namespace limber
