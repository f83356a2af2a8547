// Bake, write, load: the same mesh comes back, to the bit, and the tables as exactly as they are
// packed.
#include "bake/write_baked.h"
#include "core/vector.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using bake::BakedCharacter;
using bake::RawCharacter;

RawCharacter Import(const fs::path& path, const bake::ImportOptions& options = {}) {
  auto raw = bake::ImportGltf(path, options);
  EXPECT_TRUE(raw.ok()) << raw.status().message();
  return raw.ok() ? std::move(*raw) : RawCharacter();
}

std::shared_ptr<const Rig> Load(const fs::path& path, int rig_index = 0) {
  RigLoadOptions options;
  options.rig_index = rig_index;
  const auto rig = LoadRig(path, options);
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? *rig : nullptr;
}

void ExpectOk(const Status& status) {
  EXPECT_TRUE(status.ok()) << status.message();
}

// To the rounding of the packing, a step of 2^-23 of the largest number.
void ExpectClose(const char* name, const Vector<float>& written, const Vector<float>& loaded) {
  ASSERT_EQ(written.size(), loaded.size()) << name;
  float largest = 0;
  for (const float number : written)
    largest = std::max(largest, std::abs(number));
  for (size_t i = 0; i < written.size(); ++i)
    ASSERT_NEAR(written[i], loaded[i], 0x1p-23 * static_cast<double>(largest)) << name << " " << i;
}

void ExpectSameTables(const RigTables& written, const RigTables& loaded) {
  EXPECT_EQ(written.dimension, loaded.dimension);
  EXPECT_EQ(written.num_groups, loaded.num_groups);
  EXPECT_EQ(written.num_modes, loaded.num_modes);
  EXPECT_EQ(written.num_single_modes, loaded.num_single_modes);
  EXPECT_EQ(written.residual_rank, loaded.residual_rank);
  EXPECT_EQ(written.has_rotations, loaded.has_rotations);
  EXPECT_EQ(written.space, loaded.space);
  EXPECT_EQ(written.shape_names, loaded.shape_names);
  ASSERT_EQ(written.handles.size(), loaded.handles.size());
  for (size_t h = 0; h < written.handles.size(); ++h) {
    RigHandle expected = written.handles[h];
    EXPECT_GE(loaded.handles[h].node, 0) << "every handle gets a node";
    if (expected.node < 0) expected.node = loaded.handles[h].node;
    EXPECT_EQ(expected, loaded.handles[h]) << expected.name;
  }
  int num_tables = 0;
  Vector<const Vector<float>*> tables;
  VisitRigTables(written, [&](const char*, const Vector<float>& table, const auto&) {
    tables.push_back(&table);
  });
  VisitRigTables(loaded, [&](const char* name, const Vector<float>& table, const auto&) {
    ExpectClose(name, *tables[static_cast<size_t>(num_tables++)], table);
  });
  EXPECT_EQ(num_tables, 9);
}

void ExpectSameMesh(const SkinMesh& written, const SkinMesh& loaded) {
  EXPECT_EQ(written.num_solve_vertices, loaded.num_solve_vertices);
  EXPECT_EQ(written.num_draw_vertices, loaded.num_draw_vertices);
  EXPECT_EQ(written.num_handles, loaded.num_handles);
  EXPECT_EQ(written.num_shapes, loaded.num_shapes);
  EXPECT_EQ(written.weights, loaded.weights);
  EXPECT_EQ(written.solve_vertex, loaded.solve_vertex);
  EXPECT_EQ(written.triangles, loaded.triangles);
  EXPECT_EQ(written.source_vertex, loaded.source_vertex);
  EXPECT_EQ(written.num_source_vertices, loaded.num_source_vertices);
  EXPECT_EQ(written.shape_positions, loaded.shape_positions);
  EXPECT_EQ(written.rest_normals, loaded.rest_normals);
  EXPECT_EQ(written.rest_tangents, loaded.rest_tangents);
  EXPECT_EQ(written.texcoords, loaded.texcoords);
  ASSERT_EQ(written.primitives.size(), loaded.primitives.size());
  for (size_t p = 0; p < written.primitives.size(); ++p) {
    EXPECT_EQ(written.primitives[p].first_vertex, loaded.primitives[p].first_vertex);
    EXPECT_EQ(written.primitives[p].num_triangles, loaded.primitives[p].num_triangles);
    EXPECT_EQ(written.primitives[p].material, loaded.primitives[p].material);
  }
}

struct RoundTripCase {
  const char* name;
  const char* output;
  bool include_base;
  SyntheticOptions bake;
};

class RoundTrip : public testing::TestWithParam<RoundTripCase> {};

TEST_P(RoundTrip, RichSource_GivesTheTablesAndTheSameMesh) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path());
  bake::ImportOptions import;
  import.include_base = GetParam().include_base;
  const RawCharacter raw = Import(source, import);
  EXPECT_EQ(raw.shapes.size(), GetParam().include_base ? 3u : 2u);
  const BakedCharacter baked = MakeSyntheticBake(raw, GetParam().bake);
  EXPECT_LT(baked.mesh.num_solve_vertices, baked.mesh.num_draw_vertices) << "the seam is welded";
  const fs::path out = folder.path() / GetParam().output;
  ExpectOk(bake::WriteBaked(source, raw, baked, out));
  const auto rig = Load(out);
  ASSERT_NE(rig, nullptr);
  EXPECT_EQ(rig->name(), "sheet");
  ExpectSameTables(baked.tables, rig->tables());
  ExpectSameMesh(baked.mesh, rig->mesh());
}

SyntheticOptions Options(int handles, bool rotations, int rank) {
  SyntheticOptions options;
  options.num_handles = handles;
  options.rotations = rotations;
  options.residual_rank = rank;
  return options;
}

INSTANTIATE_TEST_SUITE_P(
    All, RoundTrip,
    testing::Values(RoundTripCase{"Glb", "out.glb", true, Options(5, true, 2)},
                    RoundTripCase{"Gltf", "out.gltf", true, Options(5, true, 2)},
                    RoundTripCase{"WithoutBase", "out.glb", false, Options(4, true, 1)},
                    RoundTripCase{"WithoutRotations", "out.glb", true, Options(3, false, 3)},
                    RoundTripCase{"EmptyTable", "out.glb", true, Options(8, true, 0)}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(WriteBaked, SameInput_SameBytes) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path());
  const RawCharacter raw = Import(source);
  const BakedCharacter baked = MakeSyntheticBake(raw, {});
  ExpectOk(bake::WriteBaked(source, raw, baked, folder.path() / "a.glb"));
  ExpectOk(bake::WriteBaked(source, raw, baked, folder.path() / "b.glb"));
  EXPECT_EQ(ReadBytes(folder.path() / "a.glb"), ReadBytes(folder.path() / "b.glb"));
}

TEST(WriteBaked, BakingTheBakedFileAgain_ChangesNoByte) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path()), first = folder.path() / "first.glb";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, {}), first));
  const RawCharacter again = Import(first);
  EXPECT_EQ(again.marked_handles.size(), 5u) << "all handles have nodes that a re-bake finds";
  const fs::path second = folder.path() / "second.glb";
  ExpectOk(bake::WriteBaked(first, again, MakeSyntheticBake(again, {}), second));
  // The nodes made by the first bake hand back the handles' names; their other facts are synthetic.
  const auto before = ReadGltfJson(first), after = ReadGltfJson(second);
  EXPECT_EQ(before["accessors"], after["accessors"]);
  EXPECT_EQ(before["bufferViews"], after["bufferViews"]);
  EXPECT_EQ(before["buffers"], after["buffers"]);
  EXPECT_EQ(before["meshes"], after["meshes"]);
  EXPECT_EQ(before["nodes"], after["nodes"]);
  EXPECT_EQ(ReadBytes(first), ReadBytes(second));
}

TEST(WriteBaked, StiffnessOfHandles_IsFoundByTheNextBake) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path()), out = folder.path() / "out.glb";
  const RawCharacter raw = Import(source);
  BakedCharacter baked = MakeSyntheticBake(raw, {});
  const Vector<RigHandle>& handles = baked.tables.handles;
  for (size_t h = 0; h < handles.size(); ++h)
    baked.handle_stiffness.push_back(h % 2 == 0 ? 1 : 10 * double(h));
  ExpectOk(bake::WriteBaked(source, raw, baked, out));
  int made = 0;
  for (const bake::HandleSpec& found : Import(out).marked_handles) {
    const auto handle = std::find_if(
        handles.begin(), handles.end(),
        [&found](const RigHandle& other) { return std::string_view(other.name) == found.name; });
    ASSERT_NE(handle, handles.end());
    if (handle->node >= 0) continue;  // a node of the artist, which is left alone
    EXPECT_EQ(found.stiffness, baked.handle_stiffness[size_t(handle - handles.begin())]);
    ++made;
  }
  EXPECT_GE(made, 3);
}

TEST(WriteBaked, BakingWithFewerHandles_LeavesNothingOfTheOldBake) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path()), first = folder.path() / "first.glb";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, Options(9, true, 4)), first));
  RawCharacter again = Import(first);
  again.marked_handles.resize(3);
  const fs::path second = folder.path() / "second.glb", direct = folder.path() / "direct.glb";
  const BakedCharacter small = MakeSyntheticBake(again, Options(3, true, 0));
  ExpectOk(bake::WriteBaked(first, again, small, second));
  BakedCharacter from_source = small;
  for (RigHandle& handle : from_source.tables.handles) {
    if (handle.name != "tip") handle.node = -1;
  }
  ExpectOk(bake::WriteBaked(source, raw, from_source, direct));
  EXPECT_EQ(ReadBytes(direct).size(), ReadBytes(second).size());
  EXPECT_EQ(ReadGltfJson(direct), ReadGltfJson(second));
}

TEST(WriteBaked, InPlace_ReplacesTheSource) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path());
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, {}), source));
  EXPECT_NE(Load(source), nullptr);
}

// What a bake of minutes must not end with is known before it.
TEST(CheckBeforeBake, FindsWhatWritingWouldRefuse) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.glb";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::CheckBeforeBake(source, raw, 3, out));
  ExpectOk(bake::CheckBeforeBake(source, raw, 3, source));
  const auto code = [&](const RawCharacter& character, size_t num_handles, const fs::path& output) {
    return bake::CheckBeforeBake(source, character, num_handles, output).code();
  };
  EXPECT_EQ(code(raw, 3, folder.path() / "out.obj"), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(raw, 3, folder.path() / "none/out.glb"), StatusCode::kIoError);
  EXPECT_EQ(code(raw, 3, folder.path() / (std::string(300, 'n') + ".glb")), StatusCode::kIoError);
  EXPECT_EQ(code(raw, 1025, out), StatusCode::kLimitExceeded);
  RawCharacter other = raw;
  other.primitives.push_back(other.primitives[0]);
  EXPECT_EQ(code(other, 3, out), StatusCode::kInvalidArgument);
  const auto begin = fs::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin, fs::directory_iterator()), 1) << "only the source";
}

TEST(WriteBaked, Refusals_LeaveTheOldFileAndNothingBeside) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.glb";
  const RawCharacter raw = Import(source);
  const BakedCharacter baked = MakeSyntheticBake(raw, {});
  ExpectOk(bake::WriteBaked(source, raw, baked, out));
  const Vector<uint8_t> good = ReadBytes(out);

  BakedCharacter bad = baked;
  bad.tables.mode_transforms[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(bake::WriteBaked(source, raw, bad, out).ok());
  bad = baked;
  bad.mesh.solve_vertex.pop_back();
  EXPECT_EQ(bake::WriteBaked(source, raw, bad, out).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bake::WriteBaked(source, raw, baked, folder.path() / "out.obj").code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(bake::WriteBaked(source, raw, baked, folder.path() / "none/out.glb").code(),
            StatusCode::kIoError);
  EXPECT_EQ(ReadBytes(out), good);
  const auto begin = fs::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin, fs::directory_iterator()), 2) << "source and result, no remains";
}

TEST(LoadRig, EditedMesh_IsAMeshMismatch) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.gltf";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, {}), out));
  auto json = ReadGltfJson(out);
  json["meshes"][0]["primitives"][0].erase("indices");
  json["meshes"][0]["primitives"].erase(1);
  const std::string text = json.dump();
  const auto rig =
      LoadRigFromMemory({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "edited");
  ASSERT_FALSE(rig.ok());
  // Four corners are no whole triangles: the mesh is refused even before its hash.
  json = ReadGltfJson(out);
  std::swap(json["meshes"][0]["primitives"][0]["targets"][0],
            json["meshes"][0]["primitives"][0]["targets"][1]);
  const std::string swapped = json.dump();
  const auto mismatch = LoadRigFromMemory(
      {reinterpret_cast<const uint8_t*>(swapped.data()), swapped.size()}, "edited");
  ASSERT_FALSE(mismatch.ok());
  EXPECT_EQ(mismatch.status().code(), StatusCode::kMeshMismatch) << mismatch.status().message();
}

TEST(LoadRig, OtherVersion_IsAVersionMismatch) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.gltf";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, {}), out));
  auto json = ReadGltfJson(out);
  json["extensions"][kRigExtensionName]["version"] = kRigFormatVersion + 1;
  const std::string text = json.dump();
  const auto rig =
      LoadRigFromMemory({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "newer");
  ASSERT_FALSE(rig.ok());
  EXPECT_EQ(rig.status().code(), StatusCode::kVersionMismatch);
  EXPECT_EQ(LoadRig(source).status().code(), StatusCode::kUnsupported) << "not baked at all";
}

TEST(LoadRig, DamagedExtension_IsAStatusOrARig) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.glb";
  const RawCharacter raw = Import(source);
  ExpectOk(bake::WriteBaked(source, raw, MakeSyntheticBake(raw, {}), out));
  Vector<uint8_t> bytes = ReadBytes(out);
  const auto json = ReadGltfJson(out).dump();
  int refused = 0;
  for (size_t i = 12; i < 20 + json.size(); i += 5) {
    const uint8_t old = bytes[i];
    bytes[i] = static_cast<uint8_t>(i % 2 == 0 ? '9' : ']');
    if (!LoadRigFromMemory(bytes, "damaged").ok()) ++refused;
    bytes[i] = old;
  }
  EXPECT_GT(refused, static_cast<int>(json.size() / 20));
  EXPECT_TRUE(LoadRigFromMemory(bytes, "whole").ok());
}

}  // namespace
}  // namespace limber::test
