// What the shipped characters promise, checked on the files as they ship.
#include "editor_tools/content/shipped_glb.h"
#include "generate/curve.h"
#include "generate/planar_mesh.h"
#include "generate/surface.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace limber::content {
namespace {

using Triangle = std::array<uint32_t, 3>;

// Triangles over all vertices of the character, with vertices at one place made one.
std::vector<Triangle> WeldedTriangles(const Character& character) {
  const std::vector<Vector3d>& p = character.shapes[0].positions;
  std::map<std::tuple<double, double, double>, uint32_t> first;
  std::vector<uint32_t> welded(p.size());
  for (uint32_t v = 0; v < p.size(); ++v) {
    welded[v] = first.emplace(std::make_tuple(p[v].x(), p[v].y(), p[v].z()), v).first->second;
  }
  std::vector<Triangle> triangles;
  for (const Primitive& primitive : character.primitives) {
    for (size_t t = 0; t < primitive.triangles.size(); t += 3) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        triangle[k] = welded.at(primitive.first_vertex + primitive.triangles[t + k]);
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

Vector3d AreaVector(const std::vector<Vector3d>& p, const Triangle& t) {
  return 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

std::map<std::pair<uint32_t, uint32_t>, int> DirectedEdges(const std::vector<Triangle>& triangles) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const Triangle& t : triangles) {
    for (int k = 0; k < 3; ++k)
      ++edges[{t[k], t[(k + 1) % 3]}];
  }
  return edges;
}

double SmallestAngle(const std::vector<Vector3d>& p, const Triangle& t) {
  double smallest = std::numbers::pi;
  for (int k = 0; k < 3; ++k) {
    const Vector3d a = p[t[(k + 1) % 3]] - p[t[k]], b = p[t[(k + 2) % 3]] - p[t[k]];
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest;
}

class ShippedCharacter : public testing::TestWithParam<const char*> {
 protected:
  const Character character_ = ReadShipped(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Content, ShippedCharacter, testing::Values("dragonlet", "fox", "square"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(ShippedCharacter, EveryShape_IsFiniteAndOfModestSize) {
  for (const Shape& shape : character_.shapes) {
    ASSERT_EQ(shape.positions.size(), character_.shapes[0].positions.size()) << shape.name;
    for (const Vector3d& p : shape.positions) {
      ASSERT_TRUE(p.allFinite()) << shape.name;
      ASSERT_LT(p.norm(), 5) << shape.name;
    }
  }
}

TEST_P(ShippedCharacter, EveryExampleShape_DiffersFromAllOthersByAWholeGesture) {
  const auto& shapes = character_.shapes;
  for (size_t a = 0; a < shapes.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      double largest = 0;
      for (size_t v = 0; v < shapes[a].positions.size(); ++v) {
        largest = std::max(largest, (shapes[a].positions[v] - shapes[b].positions[v]).norm());
      }
      EXPECT_GT(largest, 0.3) << shapes[a].name << " and " << shapes[b].name;
    }
  }
}

TEST_P(ShippedCharacter, Triangles_AreEvenAtRest) {
  double sum = 0;
  const std::vector<Triangle> triangles = WeldedTriangles(character_);
  for (const Triangle& t : triangles) {
    const double angle = SmallestAngle(character_.shapes[0].positions, t);
    EXPECT_GT(angle, 0.08);
    sum += angle;
  }
  EXPECT_GT(sum / double(triangles.size()), 0.6);  // 34 degrees on average
}

TEST_P(ShippedCharacter, Handles_AreNodesAtDistinctVertices) {
  const Glb glb(ReadBytes(Shipped(std::string(GetParam()) + ".glb")));
  std::set<std::string> names;
  std::set<size_t> vertices;
  for (const auto& child : glb.json["nodes"][0]["children"]) {
    const auto& node = glb.json["nodes"][child.get<size_t>()];
    ASSERT_TRUE(node["extras"].contains("limber_handle"));
    const auto at = node["translation"].get<std::vector<double>>();
    const Vector3d p(at[0], at[1], at[2]);
    const uint32_t v = NearestVertex(character_, p);
    EXPECT_LT((character_.shapes[0].positions[v] - p).norm(), 1e-6) << node["name"];
    EXPECT_TRUE(names.insert(node["name"]).second);
    EXPECT_TRUE(vertices.insert(v).second) << node["name"];
  }
  EXPECT_GE(names.size(), 3u);
}

TEST_P(ShippedCharacter, Drag_NamesItsHandlesMovesSmoothlyAndLoops) {
  const Glb glb(ReadBytes(Shipped(std::string(GetParam()) + ".glb")));
  std::map<std::string, Vector3d> last;
  for (const auto& child : glb.json["nodes"][0]["children"]) {
    const auto& node = glb.json["nodes"][child.get<size_t>()];
    const auto at = node["translation"].get<std::vector<double>>();
    last[node["name"]] = {at[0], at[1], at[2]};
  }
  const std::map<std::string, Vector3d> start = last;
  const auto bytes = ReadBytes(Shipped(std::string(GetParam()) + "_drag.json"));
  const auto frames = nlohmann::json::parse(bytes).at("frames");
  EXPECT_GE(frames.size(), 72u);
  EXPECT_LE(frames.size(), 128u);
  for (const auto& frame : frames) {
    for (const auto& [name, place] : frame.at("targets").items()) {
      const Vector3d p(place[0], place[1], place[2]);
      ASSERT_EQ(last.count(name), 1u) << name;
      EXPECT_LT((p - last[name]).norm(), 0.55) << name;
      last[name] = p;
    }
  }
  for (const auto& [name, p] : start)
    EXPECT_LT((p - last[name]).norm(), 1e-4) << name;
}

TEST(Dragonlet, Counts_AreThoseOfAnExpressiveCharacter) {
  const Character dragonlet = ReadShipped("dragonlet");
  const Glb glb(ReadBytes(Shipped("dragonlet.glb")));
  EXPECT_GE(dragonlet.shapes.size(), 7u);
  EXPECT_EQ(dragonlet.primitives.size(), 2u);
  EXPECT_GE(dragonlet.shapes[0].positions.size(), 4000u);
  EXPECT_LE(dragonlet.shapes[0].positions.size(), 9000u);
  EXPECT_EQ(glb.json["nodes"][0]["children"].size(), 13u);
  EXPECT_LT(ReadBytes(Shipped("dragonlet.glb")).size(), 1500u << 10);
}

TEST(Dragonlet, Surface_IsClosedInThreeParts) {
  const Character dragonlet = ReadShipped("dragonlet");
  const std::vector<Triangle> triangles = WeldedTriangles(dragonlet);
  const auto edges = DirectedEdges(triangles);
  std::set<uint32_t> vertices;
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
    vertices.insert(edge.first);
  }
  // Body and eyes are spheres to a topologist: V - E + F = 2 each.
  const auto euler =
      int64_t(vertices.size()) - int64_t(edges.size() / 2) + int64_t(triangles.size());
  EXPECT_EQ(euler, 6);
}

TEST(Dragonlet, Normals_AreThoseOfTheSurface) {
  const Character dragonlet = ReadShipped("dragonlet");
  const Glb glb(ReadBytes(Shipped("dragonlet.glb")));
  const auto& body = glb.json["meshes"][0]["primitives"][0];
  const std::vector<Vector3d> normals = glb.Vectors(body["attributes"]["NORMAL"]);
  const std::vector<Vector3d>& p = dragonlet.shapes[0].positions;
  std::vector<Vector3d> area(p.size(), Vector3d::Zero());
  for (const Triangle& t : WeldedTriangles(dragonlet)) {
    for (uint32_t v : t)
      area[v] += AreaVector(p, t);
  }
  for (size_t v = 0; v < normals.size(); ++v) {
    EXPECT_NEAR(normals[v].norm(), 1, 1e-5);
    // Vertices doubled where the picture is cut have their triangles at the first of them.
    if (area[v].norm() == 0) continue;
    EXPECT_GT(normals[v].dot(area[v].normalized()), 0.85) << p[v].transpose();
  }
}

TEST(Dragonlet, EveryShape_KeepsItsLimbsFull) {
  const Character dragonlet = ReadShipped("dragonlet");
  const std::vector<Vector3d>& rest = dragonlet.shapes[0].positions;
  for (const Shape& shape : dragonlet.shapes) {
    for (const Triangle& t : WeldedTriangles(dragonlet)) {
      EXPECT_GT(AreaVector(shape.positions, t).norm(), 0.25 * AreaVector(rest, t).norm())
          << shape.name << " at " << rest[t[0]].transpose();
    }
  }
}

TEST(Dragonlet, EveryShape_EnclosesAVolumeWithoutFoldsOrSlivers) {
  const Character dragonlet = ReadShipped("dragonlet");
  const std::vector<Triangle> triangles = WeldedTriangles(dragonlet);
  const auto edges = DirectedEdges(triangles);
  std::map<std::pair<uint32_t, uint32_t>, Triangle> owner;
  for (const Triangle& t : triangles) {
    for (int k = 0; k < 3; ++k)
      owner[{t[k], t[(k + 1) % 3]}] = t;
  }
  for (const Shape& shape : dragonlet.shapes) {
    double volume = 0;
    for (const Triangle& t : triangles) {
      volume += AreaVector(shape.positions, t).dot(shape.positions[t[0]]) / 3;
    }
    EXPECT_GT(volume, 0.5) << shape.name;
    // A fold shows as neighbours that face each other's back.
    int folds = 0;
    for (const auto& [edge, t] : owner) {
      const Vector3d a = AreaVector(shape.positions, t).normalized();
      const Vector3d b =
          AreaVector(shape.positions, owner.at({edge.second, edge.first})).normalized();
      folds += edge.first < edge.second && a.dot(b) < -0.2 ? 1 : 0;
    }
    EXPECT_LE(folds, 4) << shape.name << " of " << edges.size() / 2 << " edges";
  }
}

class PlanarCharacter : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Content, PlanarCharacter, testing::Values("fox", "square"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(PlanarCharacter, EveryShape_LiesInThePlaneWithNoTriangleFlipped) {
  const Character character = ReadShipped(GetParam());
  const std::vector<Triangle> triangles = WeldedTriangles(character);
  for (const Shape& shape : character.shapes) {
    for (const Vector3d& p : shape.positions)
      ASSERT_EQ(p.z(), 0) << shape.name;
    for (const Triangle& t : triangles) {
      EXPECT_GT(AreaVector(shape.positions, t).z(), 0) << shape.name;
    }
  }
}

TEST(Fox, Mesh_IsOnePieceAndManifold) {
  const Character fox = ReadShipped("fox");
  const auto edges = DirectedEdges(WeldedTriangles(fox));
  std::map<uint32_t, int> rim;  // outgoing rim edges
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    if (edges.count({edge.second, edge.first}) == 0) ++rim[edge.first];
  }
  for (const auto& [v, count] : rim)
    EXPECT_EQ(count, 1) << "vertex " << v;
  EXPECT_GE(fox.shapes[0].positions.size(), 800u);
  EXPECT_LE(fox.shapes[0].positions.size(), 2000u);
}

TEST(Square, Shapes_AreThoseOfThePaper) {
  const Character square = ReadShipped("square");
  ASSERT_EQ(square.shapes.size(), 3u);
  constexpr double kWidth[3] = {1, 1.6, 2.4}, kSwell[3] = {0, 0.5, -0.5};
  const std::vector<Vector3d>& rest = square.shapes[0].positions;
  for (int s = 0; s < 3; ++s) {
    for (size_t v = 0; v < rest.size(); ++v) {
      const double bulge = 1 + kSwell[s] * std::sin(std::numbers::pi * rest[v].x());
      EXPECT_NEAR(square.shapes[s].positions[v].x(), kWidth[s] * rest[v].x(), 3e-5);
      EXPECT_NEAR(square.shapes[s].positions[v].y(), bulge * rest[v].y(), 3e-5);
    }
  }
}

TEST(ExtractSurface, Sphere_IsClosedAndOnTheSphere) {
  const Surface sphere = ExtractSurface([](const Vector3d& p) { return p.norm() - 0.5; },
                                        Vector3d::Constant(-0.7), Vector3d::Constant(0.7), 0.1);
  double volume = 0;
  for (size_t t = 0; t < sphere.triangles.size(); t += 3) {
    const uint32_t* v = &sphere.triangles[t];
    volume += sphere.positions[v[0]].dot(sphere.positions[v[1]].cross(sphere.positions[v[2]])) / 6;
  }
  EXPECT_NEAR(volume, std::numbers::pi / 6, 0.02);
  for (size_t v = 0; v < sphere.positions.size(); ++v) {
    EXPECT_NEAR(sphere.positions[v].norm(), 0.5, 1e-6);
    EXPECT_GT(sphere.normals[v].dot(sphere.positions[v]), 0.499);
  }
}

TEST(FillOutline, Ring_HasTwoRimsAndTheRightArea) {
  const auto ring = [](const Vector2d& p) { return std::abs(p.norm() - 0.7) - 0.3; };
  const PlanarMesh mesh = FillOutline(ring, {-1.2, -1.2}, {1.2, 1.2}, 0.08);
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const Vector2d a = mesh.positions[mesh.triangles[t]], b = mesh.positions[mesh.triangles[t + 1]],
                   c = mesh.positions[mesh.triangles[t + 2]];
    area += 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
  }
  EXPECT_NEAR(area, std::numbers::pi * (1 - 0.16), 0.02);
  // A ring: V - E + F = 0, with 3 F = 2 E - rim edges.
  const auto faces = int64_t(mesh.triangles.size() / 3);
  EXPECT_EQ(2 * int64_t(mesh.positions.size()), faces + int64_t(mesh.num_outline));
}

TEST(MoveWithLimb, SamePose_MovesNothing) {
  const auto turn = [](double u) { return Vector3d(0, -2 * u, 1); };
  const Limb limb{Curve::Turning({0, 0.4, 0}, {0, -0.2, -1}, 1.5, turn),
                  [](double) { return 0.2; }};
  const Curve again = Curve::Turning({0, 0.4, 0}, {0, -0.2, -1}, 1.5, turn);
  for (int i = 0; i < 50; ++i) {
    const Vector3d p = limb.spine.Point(i / 49.0) + 0.15 * Vector3d(std::sin(i), std::cos(i), 0.3);
    EXPECT_LT((MoveWithLimb(
                   limb, again, [](double) { return 1.0; }, p) -
               p)
                  .norm(),
              1e-9);
  }
}

TEST(Validator, ShippedFiles_PassWithoutErrorOrWarning) {
  const std::string root = LIMBER_SOURCE_DIR;
  const std::string find =
      "cd '" + root +
      "' && (node -e \"require.resolve('gltf-validator')\" || "
      "(cd tests && node -e \"require.resolve('gltf-validator')\")) >/dev/null 2>&1";
  if (std::system(find.c_str()) != 0) {
    GTEST_SKIP() << "node or its module gltf-validator is not installed";
  }
  const std::string script =
      "const path=['" + root + "','" + root +
      "/tests'];"
      "const v=require(require.resolve('gltf-validator',{paths:path}));const fs=require('fs');"
      "(async()=>{let bad=0;for(const n of ['dragonlet','fox','square']){"
      "const r=await v.validateBytes(new Uint8Array(fs.readFileSync('" +
      root +
      "/content/characters/'+n+'.glb')));bad+=r.issues.numErrors+r.issues.numWarnings;"
      "for(const m of r.issues.messages)console.log(n,m.code,m.pointer);}"
      "process.exit(bad?1:0)})()";
  EXPECT_EQ(std::system(("node -e \"" + script + "\"").c_str()), 0);
}

}  // namespace
}  // namespace limber::content
