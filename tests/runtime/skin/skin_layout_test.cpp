#include "skin/skin_layout.h"

#include "runtime/skin/skin_fixtures.h"
#include "skin/cpu_skinner.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace limber {
namespace {

TEST(CheckSkinMesh, Fixtures_Pass) {
  EXPECT_TRUE(CheckSkinMesh(test::MakeCylinderFixture(9, 4).mesh).ok());
  EXPECT_TRUE(CheckSkinMesh(test::MakeSeamSphereFixture(9, 4).mesh).ok());
  EXPECT_TRUE(CheckSkinMesh(test::MakeCubeFixture().mesh).ok());
}

TEST(CheckSkinMesh, EachBrokenTable_IsNamed) {
  struct Case {
    const char* expected;
    std::function<void(SkinMesh*)> spoil;
  };

  const Case cases[] = {
      {"handles", [](SkinMesh* m) { m->num_handles = 0; }},
      {"shapes", [](SkinMesh* m) { m->num_shapes = -1; }},
      {"weights", [](SkinMesh* m) { m->weights.pop_back(); }},
      {"shape_positions", [](SkinMesh* m) { m->shape_positions.emplace_back(); }},
      {"solve_vertex", [](SkinMesh* m) { m->solve_vertex.pop_back(); }},
      {"solve_vertex[3]", [](SkinMesh* m) { m->solve_vertex[3] = m->num_solve_vertices; }},
      {"triangles", [](SkinMesh* m) { m->triangles.push_back(0); }},
      {"triangles[5]", [](SkinMesh* m) { m->triangles[5] = 0xFFFFFFFF; }},
      {"rest_normals", [](SkinMesh* m) { m->rest_normals.pop_back(); }},
      {"rest_tangents", [](SkinMesh* m) { m->rest_tangents.pop_back(); }},
      {"texcoords", [](SkinMesh* m) { m->texcoords.pop_back(); }},
  };
  for (const Case& c : cases) {
    test::SkinFixture fixture = test::MakeSeamSphereFixture(8, 5);
    c.spoil(&fixture.mesh);
    const Status status = CheckSkinMesh(fixture.mesh);
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << c.expected;
    EXPECT_NE(status.message().find(c.expected), std::string::npos) << status.message();
    EXPECT_FALSE(CpuSkinner::Create(fixture.mesh, fixture.space).ok()) << c.expected;
  }
}

TEST(BuildSkinTopology, ScaleThatIsNoLength_IsRefused) {
  test::SkinFixture fixture = test::MakeCubeFixture();
  for (const float scale : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    fixture.space.scale = scale;
    EXPECT_EQ(BuildSkinTopology(fixture.mesh, fixture.space).status().code(),
              StatusCode::kMalformed);
  }
}

}  // namespace
}  // namespace limber
