// Broken skins and animations: one line that says where and why, and no file.
#include "animation/pack_clip.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Spoiled {
  const char* what;
  std::function<void(GltfParts*)> spoil;
  Vector<std::string> words;  // that must stand in the message
};

Json& Primitive(GltfParts* parts) {
  return parts->json["meshes"][0]["primitives"][0];
}

Json& Sampler(GltfParts* parts) {
  return parts->json["animations"][0]["samplers"][0];
}

Vector<uint16_t> Joints(uint16_t joint) {
  return Vector<uint16_t>(4 * BarPositions().size(), joint);
}

Vector<float> Weights(float weight) {
  return Vector<float>(4 * BarPositions().size(), weight);
}

Vector<float> Matrices(size_t count, float scale) {
  Vector<float> numbers(16 * count, 0);
  for (size_t m = 0; m < count; ++m) {
    for (size_t i = 0; i < 4; ++i)
      numbers[16 * m + 5 * i] = i < 3 ? scale : 1;
  }
  return numbers;
}

Vector<Spoiled> SpoiledSkins() {
  return {
      {"joint beyond the skin",
       [](GltfParts* p) {
         Primitive(p)["attributes"]["JOINTS_0"] = p->AddShorts(Joints(2), "VEC4");
       },
       {"JOINTS_0", "vertex 0", "2"}},
      {"joints that are no integers",
       [](GltfParts* p) {
         Primitive(p)["attributes"]["JOINTS_0"] = p->AddFloats(Weights(0.5f), "VEC4");
       },
       {"JOINTS_0", "0.5"}},
      {"no joints",
       [](GltfParts* p) { Primitive(p)["attributes"].erase("JOINTS_0"); },
       {"primitives[0]", "JOINTS_0"}},
      {"no weights",
       [](GltfParts* p) { Primitive(p)["attributes"].erase("WEIGHTS_0"); },
       {"WEIGHTS_0", "missing"}},
      {"too few weights",
       [](GltfParts* p) {
         Primitive(p)["attributes"]["WEIGHTS_0"] = p->AddFloats({1, 0, 0, 0}, "VEC4");
       },
       {"WEIGHTS_0", "1 elements"}},
      {"negative weight",
       [](GltfParts* p) {
         Primitive(p)["attributes"]["WEIGHTS_0"] = p->AddFloats(Weights(-1), "VEC4");
       },
       {"WEIGHTS_0", "vertex 0", "negative"}},
      {"weight that is not a number",
       [](GltfParts* p) {
         Primitive(p)["attributes"]["WEIGHTS_0"] = p->AddFloats(Weights(kNan), "VEC4");
       },
       {"WEIGHTS_0", "finite"}},
      {"skin that is not there",
       [](GltfParts* p) { p->json["nodes"][3]["skin"] = 5; },
       {"skins[5]"}},
      {"skin of another type",
       [](GltfParts* p) { p->json["nodes"][3]["skin"] = "best"; },
       {"skins[-1]"}},
      {"joint that is no node",
       [](GltfParts* p) { p->json["skins"][0]["joints"][1] = 99; },
       {"skins[0].joints", "99"}},
      {"joint twice",
       [](GltfParts* p) { p->json["skins"][0]["joints"][1] = 1; },
       {"skins[0].joints", "twice"}},
      {"no joint at all",
       [](GltfParts* p) { p->json["skins"][0]["joints"] = Json::array(); },
       {"skins[0]", "no joints"}},
      {"too few matrices",
       [](GltfParts* p) {
         p->json["skins"][0]["inverseBindMatrices"] = p->AddFloats(Matrices(1, 1), "MAT4");
       },
       {"inverseBindMatrices", "1 matrices for 2 joints"}},
      {"matrices without an inverse",
       [](GltfParts* p) {
         p->json["skins"][0]["inverseBindMatrices"] = p->AddFloats(Matrices(2, 0), "MAT4");
       },
       {"\"root\"", "inverse"}},
      {"matrices that are vectors",
       [](GltfParts* p) {
         p->json["skins"][0]["inverseBindMatrices"] = p->AddFloats({1, 2, 3, 4}, "VEC4");
       },
       {"inverseBindMatrices", "16"}},
      {"root scaled to nothing",
       [](GltfParts* p) {
         p->json["nodes"][1]["scale"] = {0, 0, 0};
       },
       {"\"root\"", "inverse"}},
      {"projective matrix",
       [](GltfParts* p) {
         Vector<float> numbers = Matrices(2, 1);
         numbers[3] = 1;
         p->json["skins"][0]["inverseBindMatrices"] = p->AddFloats(numbers, "MAT4");
       },
       {"inverseBindMatrices", "last row"}},
      {"nodes in a circle",
       [](GltfParts* p) { p->json["nodes"][2]["children"] = {0}; },
       {"nodes[", "ancestor"}},
  };
}

Vector<Spoiled> SpoiledClips() {
  return {
      {"times that do not increase",
       [](GltfParts* p) {
         Sampler(p)["input"] = p->AddFloats({1, 1}, "SCALAR");
       },
       {"animations[0].channels[0]", "keyframe 1", "increase"}},
      {"negative time",
       [](GltfParts* p) {
         Sampler(p)["input"] = p->AddFloats({-1, 1}, "SCALAR");
       },
       {"animations[0].channels[0]", "keyframe 0"}},
      {"time that is not a number",
       [](GltfParts* p) {
         Sampler(p)["input"] = p->AddFloats({0, kNan}, "SCALAR");
       },
       {"input", "finite"}},
      {"more times than values",
       [](GltfParts* p) {
         Sampler(p)["input"] = p->AddFloats({0, 1, 2}, "SCALAR");
       },
       {"output", "2 elements", "3"}},
      {"spline without tangents",
       [](GltfParts* p) { Sampler(p)["interpolation"] = "CUBICSPLINE"; },
       {"output", "2 elements", "6"}},
      {"values that are not numbers",
       [](GltfParts* p) { Sampler(p)["output"] = p->AddFloats(Vector<float>(8, kNan), "VEC4"); },
       {"output", "finite"}},
      {"values of another type",
       [](GltfParts* p) {
         Sampler(p)["output"] = p->AddFloats({1, 2, 3, 4, 5, 6}, "VEC3");
       },
       {"output", "4 numbers"}},
      {"unknown interpolation",
       [](GltfParts* p) { Sampler(p)["interpolation"] = "WOBBLE"; },
       {"samplers[0]", "WOBBLE"}},
      {"sampler that is not there",
       [](GltfParts* p) { p->json["animations"][0]["channels"][0]["sampler"] = 7; },
       {"channels[0]", "sampler", "7"}},
      {"output that is not there",
       [](GltfParts* p) { Sampler(p)["output"] = 1e9; },
       {"samplers[0]", "output"}},
      {"node that is not there",
       [](GltfParts* p) { p->json["animations"][0]["channels"][0]["target"]["node"] = 44; },
       {"channels[0].target", "44"}},
      {"channel without a target",
       [](GltfParts* p) { p->json["animations"][0]["channels"][0].erase("target"); },
       {"channels[0]", "target"}},
      {"channels of another type",
       [](GltfParts* p) { p->json["animations"][0]["channels"] = 3; },
       {"animations[0]", "channels"}},
      {"animation of another type",
       [](GltfParts* p) { p->json["animations"][0] = "Bend"; },
       {"animations[0]"}},
      {"node with a matrix",
       [](GltfParts* p) {
         p->json["nodes"][2].erase("translation");
         p->json["nodes"][2]["matrix"] = Matrices(1, 1);
       },
       {"channels[0]", "matrix"}},
      {"weights of a node without targets",
       [](GltfParts* p) {
         AddChannel(p, 0, 3, "weights", {0, 1}, {0, 1});
       },
       {"channels[1]", "no morph targets"}},
      {"motion beyond all numbers",
       [](GltfParts* p) {
         for (const int node : {1, 2})
           AddChannel(p, 0, node, "scale", {0, 1}, Vector<float>(6, 3e38f));
       },
       {"\"Bend\"", "not finite"}},
      {"no animation", [](GltfParts* p) { p->json.erase("animations"); }, {"animations", "none"}},
      {"clip that moves nothing",
       [](GltfParts* p) {
         p->json["nodes"].push_back({{"name", "lamp"}});
         p->json["animations"][0]["channels"][0]["target"]["node"] = 4;
       },
       {"\"Bend\"", "no mesh"}},
      {"baked before",
       [](GltfParts* p) {
         p->json["nodes"][3]["extensions"]["LIMBER_mesh_ik"] = {{"rig", 0}};
       },
       {"meshes[0]", "baked"}},
  };
}

class HostileClip : public testing::TestWithParam<Spoiled> {};

TEST_P(HostileClip, OneLine_SaysWhereAndWhy) {
  const TemporaryFolder folder;
  const fs::path source = folder.path() / "bar.glb", out = folder.path() / "out.glb";
  GltfParts parts = MakeAnimatedBar();
  GetParam().spoil(&parts);
  parts.Write(source);
  bake::PackClipOptions options;
  options.count = 2;
  const Status status = bake::PackClip(source, options, out).status();
  ASSERT_FALSE(status.ok()) << GetParam().what;
  const std::string& message = status.message();
  EXPECT_EQ(message.find(source.string() + ": "), 0u) << message;
  EXPECT_EQ(message.find(source.string(), 1), std::string::npos) << message;
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
  for (const std::string& word : GetParam().words)
    EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
  EXPECT_FALSE(fs::exists(out));
}

std::string NameOf(const testing::TestParamInfo<Spoiled>& test) {
  std::string name = test.param.what;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Skin, HostileClip, testing::ValuesIn(SpoiledSkins()), NameOf);
INSTANTIATE_TEST_SUITE_P(Clip, HostileClip, testing::ValuesIn(SpoiledClips()), NameOf);

TEST(HostileClip, SeveralClips_AreListedWithTheirLengths) {
  const TemporaryFolder folder;
  const fs::path source = folder.path() / "bar.glb";
  GltfParts parts = MakeAnimatedBar();
  parts.json["animations"].push_back({{"name", "Nod"}});
  AddChannel(&parts, 1, kBarRootNode, "translation", {0, 2.5f}, {0, 0, 0, 1, 1, 1});
  parts.Write(source);
  bake::PackClipOptions options;
  options.times = {0.5};
  const auto message = [&](const std::string& clip) {
    options.clip = clip;
    return bake::PackClip(source, options, folder.path() / "out.glb").status().message();
  };
  EXPECT_EQ(message("Nod"), "");
  EXPECT_EQ(message("0"), "");
  // One that cannot be read is in the list without a length.
  parts.json["animations"].push_back({{"name", "broken"}});
  parts.Write(source);
  for (const char* clip : {"", "Walk"}) {
    for (const char* word : {"\"Bend\" (0, 1.000 s)", "\"Nod\" (1, 2.500 s)", "\"broken\" (2)"})
      EXPECT_NE(message(clip).find(word), std::string::npos) << message(clip);
  }
}

TEST(HostileClip, NodesThatItCannotPack_AreNamedWithTheReason) {
  const TemporaryFolder folder;
  const fs::path source = folder.path() / "bar.glb";
  GltfParts parts = MakeAnimatedBar();
  Json plain = parts.json["meshes"][0];
  parts.json["meshes"].push_back(plain);
  parts.json["nodes"].push_back({{"name", "Prop"}, {"mesh", 1}});
  parts.json["nodes"].push_back({{"name", "Twin"}, {"mesh", 1}, {"skin", 0}});
  parts.Write(source);
  bake::PackClipOptions options;
  options.times = {0.5};
  const auto message = [&](const std::string& node) {
    options.node = node;
    return bake::PackClip(source, options, folder.path() / "out.glb").status().message();
  };
  EXPECT_NE(message("").find("--node: \"Bar\" (3), \"Twin\" (5)"), std::string::npos)
      << message("");
  EXPECT_NE(message("Prop").find("neither a skin nor morph targets"), std::string::npos);
  EXPECT_NE(message("Nobody").find("mesh nodes are"), std::string::npos) << message("Nobody");
  EXPECT_EQ(message("Twin"), "");
}

}  // namespace
}  // namespace limber::test
