// OBJ in, glTF out, and the source's own order back.
#include "core/vector.h"
#include "import/import_gltf.h"
#include "import/import_obj.h"
#include "import/pack_obj.h"
#include "import/source_faces.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

namespace limber::test {
namespace {

using bake::ObjMesh;
using bake::ParseObj;

constexpr char kVertices[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 9 9 9\n";

ObjMesh Obj(const std::string& text) {
  auto mesh = ParseObj(text, "test.obj");
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return mesh.ok() ? *mesh : ObjMesh();
}

TEST(ParseObj, PolygonsNegativeIndicesAndContinuedLines_AreRead) {
  const ObjMesh mesh = Obj(std::string("# a comment\r\no thing\r\n") + kVertices +
                           "vt 0.5\nvt 0 1 0\nvn 0 0 2\ns off\nusemtl paint\n"
                           "f 1//1 2//1 \\\n 3//1 4//1\nf -5/-1 5/1 3 # end\n");
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.face_sizes, (Vector<uint32_t>{4, 3}));
  ASSERT_EQ(mesh.corners.size(), 7u);
  EXPECT_EQ(mesh.corners[2].position, 2u);
  EXPECT_EQ(mesh.corners[2].normal, 0);
  EXPECT_EQ(mesh.corners[2].texcoord, -1);
  EXPECT_EQ(mesh.corners[4].position, 1u);
  EXPECT_EQ(mesh.corners[4].texcoord, 1);
  EXPECT_EQ(mesh.texcoords[0], (std::array<float, 2>{0.5f, 0}));
}

TEST(ParseObj, Mistakes_NameTheLine) {
  const struct {
    const char* line;
    const char* part;
  } cases[] = {{"v 1 2", "3 numbers"},   {"v 1 2 x", "\"x\""},
               {"v 1 nan 2", "nan"},     {"v 1 inf 2", "inf"},
               {"v 1 1e99 2", "1e99"},   {"f 1 2", "2 corners"},
               {"f 1 2 9", "vertex 9"},  {"f 0 1 2", "vertex 0"},
               {"f 1 2 -7", "-7"},       {"f 1/1 2/1 3/1", "texture"},
               {"f 1//1 2 3", "normal"}, {"f 1/2/3/4 2 3", "corner"},
               {"f a b c", "\"a\""},     {"f 99999999999999999999 1 2", "index"}};

  for (const auto& bad : cases) {
    const Status status =
        ParseObj(std::string(kVertices) + bad.line + "\nf 1 2 3\n", "test.obj").status();
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << bad.line;
    EXPECT_EQ(status.message().rfind("test.obj:7: ", 0), 0u) << status.message();
    EXPECT_NE(status.message().find(bad.part), std::string::npos) << status.message();
  }
  EXPECT_FALSE(ParseObj("", "test.obj").ok());
  EXPECT_FALSE(ParseObj(kVertices, "test.obj").ok()) << "no face";
  EXPECT_EQ(bake::ReadObj("/no/such.obj").status().code(), StatusCode::kNotFound);
}

TEST(Fans, ConcaveQuad_IsCutWhereNoTriangleTurnsOver) {
  // An arrowhead: a fan about corner 0 or 2 would leave the polygon.
  const ObjMesh mesh = Obj("v 0 0 0\nv 4 -2 0\nv 1 0 0\nv 4 2 0\nf 2 3 4 1\n");
  const bake::FanTriangles fans = bake::CutIntoFans(mesh);
  EXPECT_EQ(fans.starts, (Vector<uint32_t>{1}));
  EXPECT_EQ(fans.corners, (Vector<uint32_t>{1, 2, 3, 1, 3, 0}));
}

struct Packed {
  bake::RawCharacter raw;
  bake::SourceFaces faces;
};

Packed Pack(const ObjMesh& base, const ObjMesh& shape) {
  const Vector<ObjMesh> shapes = {shape};
  const Vector<std::string> names = {"shape"};
  const auto bytes = bake::PackMeshes(base, shapes, names, "thing");
  EXPECT_TRUE(bytes.ok()) << bytes.status().message();
  const auto file = GltfFile::Parse(*bytes, "packed");
  EXPECT_TRUE(file.ok()) << file.status().message();
  auto raw = bake::ImportGltf(*file);
  auto faces = bake::ReadSourceFaces(*file, 0);
  EXPECT_TRUE(raw.ok() && faces.ok());
  return {std::move(*raw), std::move(*faces)};
}

TEST(PackObj, SourceVerticesAndPolygons_ComeBackInTheirOrder) {
  const std::string faces =
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3 4/4\nf 2/1 5/2 3/3\nf 4 1 5 3 2\n";
  const ObjMesh base = Obj(kVertices + faces);
  const ObjMesh shape =
      Obj("v 0 0 1\nv 1 0 0\nv 1.5 1 0.1\nv 0 1 0\nv 2 0 0.333333333\nv 8 9 9\n" + faces);
  const Packed packed = Pack(base, shape);
  EXPECT_EQ(packed.raw.num_source_vertices, 6u);
  EXPECT_EQ(packed.faces.num_vertices, 6u);
  EXPECT_EQ(packed.faces.sizes, base.face_sizes);
  Vector<uint32_t> corners;
  for (const bake::ObjCorner& corner : base.corners)
    corners.push_back(corner.position);
  EXPECT_EQ(packed.faces.corners, corners);
  EXPECT_GT(packed.raw.num_draw_vertices(), 6) << "split where texture coordinates differ";
  EXPECT_EQ(packed.raw.shape_names, (Vector<std::string>{"base", "shape"}));
  Vector<bool> seen(6, false);
  for (int d = 0; d < packed.raw.num_draw_vertices(); ++d) {
    const uint32_t source = packed.raw.source_vertex[static_cast<size_t>(d)];
    seen[source] = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      EXPECT_NEAR(packed.raw.shapes[0](d, axis), base.positions[source][a], 1e-7);
      EXPECT_NEAR(packed.raw.shapes[1](d, axis), shape.positions[source][a], 1e-7);
    }
  }
  EXPECT_EQ(seen, Vector<bool>(6, true)) << "also the vertex that no face uses";
}

TEST(PackObj, NormalsOfEqualValue_SplitNothing) {
  const ObjMesh mesh = Obj(std::string(kVertices) +
                           "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//2 3//2 4//3\n");
  EXPECT_EQ(Pack(mesh, mesh).raw.num_draw_vertices(), 6);
}

TEST(PackObj, OtherTopology_IsRefusedWithFileAndCounts) {
  ObjMesh base = Obj(std::string(kVertices) + "f 1 2 3\nf 1 3 4\n");
  base.file = "base.obj";
  const Vector<std::string> names = {"s"};
  const auto refuse = [&](const std::string& text, std::initializer_list<const char*> parts) {
    const Vector<ObjMesh> shapes = {Obj(text)};
    const Status status = bake::PackMeshes(base, shapes, names, "x").status();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    for (const char* part : parts) {
      EXPECT_NE(status.message().find(part), std::string::npos) << status.message();
    }
  };
  refuse(std::string(kVertices) + "v 0 0 0\nf 1 2 3\nf 1 3 4\n",
         {"test.obj", "base.obj", "7", "6", "vertices"});
  refuse(std::string(kVertices) + "f 1 2 3\n", {"test.obj", "base.obj", "1 faces", "has 2"});
  refuse(std::string(kVertices) + "f 1 2 3\nf 1 4 3\n", {"test.obj", "base.obj", "face 1"});
  EXPECT_EQ(bake::PackMeshes(base, {}, {}, "x").status().code(), StatusCode::kInvalidArgument);
}

TEST(PackObj, Files_NameShapesAfterThemselves) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name) {
    std::ofstream(folder.path() / name) << kVertices << "f 1 2 3\n";
    return folder.path() / name;
  };
  const Vector<std::filesystem::path> shapes = {write("smile.obj"), write("frown.obj")};
  const auto out = folder.path() / "out.glb";
  const Status status = bake::PackObj(write("face.obj"), shapes, {}, out);
  ASSERT_TRUE(status.ok()) << status.message();
  const auto raw = bake::ImportGltf(out);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  EXPECT_EQ(raw->name, "face");
  EXPECT_EQ(raw->shape_names, (Vector<std::string>{"base", "smile", "frown"}));
}

}  // namespace
}  // namespace limber::test
