// Files made to do harm: each gives a Status, and nothing else.
#include "core/vector.h"
#include "load/gltf_file.h"
#include "load/gltf_mesh.h"
#include "load/rig_loader.h"
#include "runtime/load/small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Opens a file and reads all that Limber reads of it.
Status ReadAll(Result<GltfFile> file) {
  if (!file.ok()) return file.status();
  EXPECT_FALSE(LoadRig(*file).ok()) << "not baked";
  const auto mesh = ReadMorphMesh(*file, 0);
  return mesh.status();
}

TEST(Hostile, TheGoodFileBehindAllThese_IsRead) {
  const SmallGltf gltf;
  EXPECT_TRUE(ReadAll(gltf.Parse()).ok());
  EXPECT_TRUE(ReadAll(GltfFile::Parse(gltf.Glb(), "good.glb")).ok());
}

TEST(Hostile, GlbTruncatedAtEveryLength_IsMalformed) {
  const Vector<uint8_t> whole = SmallGltf().Glb();
  for (size_t length = 0; length < whole.size(); ++length) {
    const Status status = ReadAll(GltfFile::Parse({whole.data(), length}, "cut.glb"));
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << length << ": " << status.message();
    EXPECT_EQ(status.message().rfind("cut.glb: ", 0), 0u) << status.message();
  }
}

TEST(Hostile, EveryByteOfAGlbChanged_NeverCrashes) {
  const Vector<uint8_t> whole = SmallGltf().Glb();
  int refused = 0;
  for (size_t at = 0; at < whole.size(); ++at) {
    for (const uint8_t value : {uint8_t{0}, uint8_t{0xFF}, uint8_t{'9'}, uint8_t{'{'}}) {
      Vector<uint8_t> bytes = whole;
      bytes[at] = value;
      refused += ReadAll(GltfFile::Parse(bytes, "changed.glb")).ok() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 1000);
}

// Every number of the JSON replaced by values that readers have fallen for.
void Replace(const Json& whole, const Json::json_pointer& at, int* refused, int* accepted) {
  const Json& here = whole.at(at);
  if (here.is_structured()) {
    for (const auto& [key, value] : here.items()) {
      Replace(whole, here.is_array() ? at / std::stoul(key) : at / key, refused, accepted);
    }
  }
  if (at.empty()) return;
  static const Vector<Json> kBadValues = {nullptr,
                                          "text",
                                          Json::array(),
                                          Json::object(),
                                          -1,
                                          1.5,
                                          77,
                                          2147483647,
                                          2147483648u,
                                          4294967296u,
                                          9007199254740993,
                                          4611686018427387904,
                                          18446744073709551615u,
                                          1e300,
                                          true};
  for (const Json& bad : kBadValues) {
    SmallGltf gltf;
    gltf.json = whole;
    gltf.json.at(at) = bad;
    (ReadAll(gltf.Parse()).ok() ? *accepted : *refused) += 1;
  }
  SmallGltf gltf;
  gltf.json = whole;
  Json& parent = gltf.json.at(at.parent_pointer());
  if (parent.is_object()) parent.erase(at.back());
  EXPECT_NO_THROW((void)ReadAll(gltf.Parse()));
}

TEST(Hostile, EveryMemberReplaced_NeverCrashes) {
  SmallGltf gltf;
  const size_t indices = gltf.AddView<uint8_t>({1});
  gltf.json["accessors"][1]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", 0}}}};
  gltf.json["nodes"].push_back({{"children", {0}}, {"translation", {1, 2, 3}}});
  gltf.json["scenes"] = {{{"nodes", {1}}}};
  ASSERT_TRUE(ReadAll(gltf.Parse()).ok());
  int refused = 0, accepted = 0;
  Replace(gltf.json, Json::json_pointer(), &refused, &accepted);
  EXPECT_GT(refused, 500);
  EXPECT_LT(accepted, refused / 3) << "names, and members with more than one good value";
}

TEST(Hostile, DeepJson_IsRefusedBeforeItIsParsed) {
  for (const char* bracket : {"[", "{\"a\":"}) {
    std::string text = R"({"asset": {"version": "2.0"}, "extras": )";
    for (int i = 0; i < 100000; ++i)
      text += bracket;
    EXPECT_EQ(ParseText(text).status().code(), StatusCode::kLimitExceeded);
  }
  std::string fits = R"({"asset": {"version": "2.0"}, "extras": )" + std::string(63, '[') +
                     std::string(63, ']') + "}";
  EXPECT_TRUE(ParseText(fits).ok());
  EXPECT_EQ(ParseText(R"({"asset": {"version": "2.0"}, "x": "[[[[\"[[[[{{{{"})").status().code(),
            StatusCode::kOk)
      << "brackets in strings do not nest";
}

// Ordered JSON finds a member by walking along its object: an object of a million members would
// take the better part of an hour.
TEST(Hostile, ObjectsOfVeryManyMembers_AreRefusedBeforeTheyAreParsed) {
  const auto with_members = [](int num_objects, int num_members) {
    std::string text = R"({"asset": {"version": "2.0"}, "extras": [)";
    for (int object = 0; object < num_objects; ++object) {
      text += object > 0 ? ",{" : "{";
      for (int member = 0; member < num_members; ++member) {
        text += (member > 0 ? ",\"" : "\"") + std::to_string(member) + "\":0";
      }
      text += "}";
    }
    return ParseText(text + "]}").status().code();
  };
  EXPECT_EQ(with_members(1, 100000), StatusCode::kLimitExceeded);
  EXPECT_EQ(with_members(100, 2000), StatusCode::kLimitExceeded) << "one after the other";
  EXPECT_EQ(with_members(1, 2000), StatusCode::kOk);
  EXPECT_EQ(with_members(2000, 20), StatusCode::kOk) << "what real files look like";
}

// Primitives may share their accessors, so that a small file can ask for very many triangles.
TEST(Hostile, TrianglesOfStripsAndSharedIndices_AreCountedAgainstTheLimit) {
  SmallGltf gltf;
  const size_t view = gltf.AddView<uint8_t>({0, 1, 2, 0, 1, 2, 0, 1});
  Json& primitives = gltf.json["meshes"][0]["primitives"];
  primitives[0]["indices"] = gltf.AddAccessor(
      {{"bufferView", view}, {"componentType", 5121}, {"count", 8}, {"type", "SCALAR"}});
  primitives[0]["mode"] = 5;
  const auto code_with = [&gltf](uint64_t max_triangles) {
    GltfLimits limits;
    limits.max_triangles = max_triangles;
    return ReadAll(GltfFile::Parse(gltf.Glb(), "strip.glb", limits)).code();
  };
  EXPECT_EQ(code_with(6), StatusCode::kOk);
  EXPECT_EQ(code_with(5), StatusCode::kLimitExceeded);
  primitives.push_back(primitives[0]);
  EXPECT_EQ(code_with(12), StatusCode::kOk);
  EXPECT_EQ(code_with(11), StatusCode::kLimitExceeded);
}

TEST(Hostile, NodeCycles_AreRefused) {
  SmallGltf gltf;
  gltf.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {2}}}, {{"children", {0}}}};
  EXPECT_EQ(gltf.Parse().status().code(), StatusCode::kMalformed);
  gltf.json["nodes"] = {{{"children", {0}}}};
  EXPECT_EQ(gltf.Parse().status().code(), StatusCode::kMalformed);
  gltf.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  EXPECT_EQ(gltf.Parse().status().code(), StatusCode::kMalformed) << "two parents";
}

TEST(Hostile, RequiredExtensions_AreRefusedByName) {
  SmallGltf gltf;
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  Status status = gltf.Parse().status();
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_NE(status.message().find("KHR_draco_mesh_compression"), std::string::npos);
  EXPECT_NE(status.message().find("gltf-transform"), std::string::npos) << "how to remove it";
  gltf.json["extensionsRequired"] = {"VENDOR_unheard_of"};
  EXPECT_EQ(gltf.Parse().status().code(), StatusCode::kUnsupported);
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_TRUE(gltf.Parse().ok());
}

TEST(Hostile, UrisOutOfTheFolder_ReadNothing) {
  const TemporaryFolder outer;
  const fs::path folder = outer.path() / "inner";
  fs::create_directory(folder);
  SmallGltf gltf;
  const auto write = [](const fs::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  };
  const std::string data(gltf.bin.begin(), gltf.bin.end());
  write(outer.path() / "secret.bin", data);
  write(folder / "own.bin", data);
  for (const std::string uri : {"../secret.bin", "%2e%2e/secret.bin", "x/../../secret.bin",
                                "..%2fsecret.bin", "", "file:own.bin", "no.bin", "."}) {
    gltf.json["buffers"][0]["uri"] = uri;
    write(folder / "bad.gltf", gltf.json.dump());
    EXPECT_FALSE(ReadAll(GltfFile::Open(folder / "bad.gltf")).ok()) << uri;
  }
  gltf.json["buffers"][0]["uri"] = (outer.path() / "secret.bin").string();
  write(folder / "bad.gltf", gltf.json.dump());
  EXPECT_EQ(GltfFile::Open(folder / "bad.gltf").status().code(), StatusCode::kUnsupported);
  gltf.json["buffers"][0]["uri"] = "ow%6E.bin";
  write(folder / "good.gltf", gltf.json.dump());
  EXPECT_TRUE(ReadAll(GltfFile::Open(folder / "good.gltf")).ok());
  EXPECT_EQ(ParseText(gltf.json.dump()).status().code(), StatusCode::kUnsupported)
      << "from memory there is no folder";
}

TEST(Hostile, Limits_AreSettings) {
  const SmallGltf gltf;
  const Vector<uint8_t> bytes = gltf.Glb();
  const auto status_with = [&bytes](const std::function<void(GltfLimits*)>& set) {
    GltfLimits limits;
    set(&limits);
    return ReadAll(GltfFile::Parse(bytes, "small.glb", limits)).code();
  };
  EXPECT_EQ(status_with([](GltfLimits*) {}), StatusCode::kOk);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_file_bytes = 100; }),
            StatusCode::kLimitExceeded);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_buffer_bytes = 10; }),
            StatusCode::kLimitExceeded);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_json_values = 5; }), StatusCode::kLimitExceeded);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_vertices = 2; }), StatusCode::kLimitExceeded);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_morph_positions = 2; }),
            StatusCode::kLimitExceeded);
  EXPECT_EQ(status_with([](GltfLimits* l) { l->max_targets = 0; }), StatusCode::kLimitExceeded);
}

TEST(Hostile, NotAGltfAtAll_IsSaid) {
  EXPECT_EQ(GltfFile::Open("/nowhere/at/all.glb").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(GltfFile::Open(fs::temp_directory_path()).status().code(), StatusCode::kIoError);
  EXPECT_EQ(ParseText("").status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ParseText("v 0 0 0\n").status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ParseText("[]").status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ParseText("{}").status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ParseText(R"({"asset": {"version": "1.0"}})").status().code(),
            StatusCode::kUnsupported);
  EXPECT_EQ(ParseText("{\"asset\": {\"version\": \"2.0\"}, \"x\": \"\xFF\"}").status().code(),
            StatusCode::kMalformed)
      << "not UTF-8";
}

}  // namespace
}  // namespace limber::test
