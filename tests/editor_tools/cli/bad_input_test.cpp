// Bad input from outside: one line that names file, place and reason, exit code 1, nothing left
// over.
#include "core/vector.h"
#include "run_limber.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <limits>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = Vector<std::string>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class BadInput : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  std::string Write(const std::string& name, const std::string& content) const {
    WriteText(Path(name), content);
    return Path(name);
  }

  // A good baked bar with the handles "left" and "right".
  std::string BakeGoodBar() const {
    const std::string source = Write("bar.glb", MakeBar(12).ToGlb());
    const std::string handles = Write(
        "handles.json", R"({"handles":[{"name":"left","vertex":0},{"name":"right","vertex":48}]})");
    const CommandResult result =
        RunLimber({"bake", source, "-o", Path("baked.glb"), "--handles", handles});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Path("baked.glb");
  }

  // Runs it and checks the whole promise; `words` must all stand in the one line.
  void ExpectRefused(const Words& arguments, const Words& words) const {
    const Words before = FilesBelow(folder_.path());
    const CommandResult result = RunLimber(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.err.find("limber: error: "), 0u) << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& word : words) {
      EXPECT_NE(result.err.find(word), std::string::npos)
          << "no '" << word << "' in " << result.err;
    }
    EXPECT_EQ(FilesBelow(folder_.path()), before);
  }

  void ExpectBakeRefused(const std::string& source, const Words& words) const {
    ExpectRefused({"bake", source, "-o", Path("out.glb"), "--auto-handles", "3"}, words);
  }

  TemporaryFolder folder_;
};

// The GLB with its JSON chunk changed by `edit`.
template <class Edit>
std::string WithEditedJson(const std::string& glb, Edit&& edit) {
  uint32_t json_size = 0;
  std::memcpy(&json_size, glb.data() + 12, 4);
  Json gltf = Json::parse(glb.substr(20, json_size));
  edit(&gltf);
  std::string text = gltf.dump();
  while (text.size() % 4 != 0)
    text += ' ';
  std::string edited = glb.substr(0, 20) + text + glb.substr(20 + json_size);
  const auto new_json_size = static_cast<uint32_t>(text.size());
  const auto new_size = static_cast<uint32_t>(edited.size());
  std::memcpy(edited.data() + 8, &new_size, 4);
  std::memcpy(edited.data() + 12, &new_json_size, 4);
  return edited;
}

TEST_F(BadInput, MissingFile_IsNamed) {
  ExpectBakeRefused(Path("nowhere.glb"), {"nowhere.glb"});
  ExpectRefused({"info", Path("nowhere.glb")}, {"nowhere.glb"});
  ExpectRefused({"solve", Path("nowhere.glb"), "--targets", Path("f.json"), "-o", Path("out")},
                {"nowhere.glb"});
  ExpectRefused({"pack", Path("nowhere.obj"), Path("b.obj"), "-o", Path("out.glb")},
                {"nowhere.obj"});
}

TEST_F(BadInput, TruncatedGlb_IsRefusedAtEveryLength) {
  const std::string good = MakeBar(4).ToGlb();
  for (const size_t size : {size_t{0}, size_t{3}, size_t{11}, size_t{12}, size_t{19}, size_t{20},
                            size_t{200}, good.size() / 2, good.size() - 4, good.size() - 1}) {
    SCOPED_TRACE(size);
    ExpectBakeRefused(Write("short.glb", good.substr(0, size)), {"short.glb"});
  }
}

TEST_F(BadInput, UnequalTargetCounts_AreNamed) {
  SmallGltf bar = MakeBar(4);
  bar.has_second_primitive = true;
  bar.targets_of_second = 1;
  ExpectBakeRefused(Write("unequal.glb", bar.ToGlb()), {"unequal.glb", "primitive", "1", "2"});
}

TEST_F(BadInput, NoMorphTarget_IsNamed) {
  SmallGltf bar = MakeBar(4);
  bar.targets.clear();
  const std::string glb = WithEditedJson(
      bar.ToGlb(), [](Json* gltf) { (*gltf)["meshes"][0]["primitives"][0].erase("targets"); });
  ExpectBakeRefused(Write("plain.glb", glb), {"plain.glb", "morph target"});
}

TEST_F(BadInput, NonFinitePositions_AreNamedByVertex) {
  SmallGltf bar = MakeBar(4);
  bar.positions[7][1] = kNan;
  ExpectBakeRefused(Write("nan_base.glb", bar.ToGlb()), {"nan_base.glb", "7"});
  bar = MakeBar(4);
  bar.targets[1][11][2] = kInfinity;
  ExpectBakeRefused(Write("inf_target.glb", bar.ToGlb()), {"inf_target.glb", "11"});
}

TEST_F(BadInput, ZeroAreaTriangles_BakeOrOneLine) {
  SmallGltf bar = MakeBar(6);
  bar.indices.insert(bar.indices.end(), {0, 0, 1, 5, 5, 5});     // repeated corners
  bar.positions.push_back({3, 1, 1});                            // the same point as vertex 14, and
  bar.indices.insert(bar.indices.end(), {10, 14, 28, 0, 4, 8});  // three on one line
  for (auto& target : bar.targets)
    target.push_back(target[14]);
  const std::string source = Write("flat.glb", bar.ToGlb());
  const CommandResult result =
      RunLimber({"bake", source, "-o", Path("out.glb"), "--auto-handles", "3"});
  if (result.exit_code == 0) {
    EXPECT_TRUE(fs::exists(Path("out.glb")));
    const CommandResult info = RunLimber({"info", Path("out.glb")});
    EXPECT_EQ(info.exit_code, 0) << info.err;  // the loader refuses any non-finite table
  } else {
    ExpectBakeRefused(source, {"flat.glb"});
  }
}

TEST_F(BadInput, AllTrianglesFlat_BakeOrOneLine) {
  SmallGltf bar = MakeBar(4);
  for (auto& p : bar.positions)
    p = {p[0], 0, 0};
  for (auto& target : bar.targets) {
    for (auto& d : target)
      d = {d[0], 0, 0};
  }
  const std::string source = Write("line.glb", bar.ToGlb());
  const CommandResult result =
      RunLimber({"bake", source, "-o", Path("out.glb"), "--auto-handles", "2"});
  if (result.exit_code != 0) ExpectBakeRefused(source, {"line.glb"});
}

TEST_F(BadInput, NoHandles_NamesTheThreeWays) {
  const std::string source = Write("bar.glb", MakeBar(4).ToGlb());
  ExpectRefused({"bake", source, "-o", Path("out.glb")},
                {"bar.glb", "--handles", "--auto-handles", "extras"});
  const std::string handles = Write("empty.json", R"({"handles":[]})");
  ExpectRefused({"bake", source, "-o", Path("out.glb"), "--handles", handles}, {"handle"});
}

TEST_F(BadInput, HandlesThatClash_AreNamed) {
  const std::string source = Write("bar.glb", MakeBar(4).ToGlb());
  const auto refuse = [&](const std::string& text, const Words& words) {
    const std::string handles = Write("clash.json", text);
    ExpectRefused({"bake", source, "-o", Path("out.glb"), "--handles", handles}, words);
  };
  refuse(R"({"handles":[{"name":"tail","vertex":3},{"name":"knee","vertex":3}]})",
         {"tail", "knee", "vertex"});
  refuse(R"({"handles":[{"name":"tail","vertex":3},{"name":"tail","vertex":9}]})", {"tail"});
  refuse(R"({"handles":[{"name":"tail","vertex":3},{"name":"far","vertex":20}]})", {"far", "20"});
  refuse(R"({"handles":[{"name":"tail","vertex":3,"free":true}]})", {"bar.glb", "pin"});
  refuse(R"({"handles":[{"name":"tail"}]})", {"clash.json", "tail"});
  refuse(R"({"handles":[{"name":"tail","vertex":-1}]})", {"clash.json"});
  refuse(R"({"handles":)", {"clash.json"});
}

TEST_F(BadInput, UnknownHandleName_ListsTheKnownOnes) {
  const std::string baked = BakeGoodBar();
  const std::string frames =
      Write("frames.json", R"({"frames":[{"targets":{}},{"targets":{"tail":[0,0,0]}}]})");
  ExpectRefused({"solve", baked, "--targets", frames, "-o", Path("out")},
                {"frames.json", "1", "tail", "left", "right"});
  ExpectRefused({"render", baked, "--targets", frames, "-o", Path("out")},
                {"frames.json", "1", "tail", "left", "right"});
}

TEST_F(BadInput, BrokenFrames_AreNamed) {
  const std::string baked = BakeGoodBar();
  for (const char* text :
       {"", "[]", R"({"frames":{}})", R"({"frames":[{"targets":{"left":[1,2]}}]})",
        R"({"frames":[{"targets":{"left":[1,2,"x"]}}]})",
        R"({"frames":[{"targets":{"left":[1e999,0,0]}}]})"}) {
    SCOPED_TRACE(text);
    const std::string frames = Write("broken.json", text);
    ExpectRefused({"solve", baked, "--targets", frames, "-o", Path("out")}, {"broken.json"});
  }
}

TEST_F(BadInput, BakeOfAnotherVersion_IsRefused) {
  const std::string baked = BakeGoodBar();
  const std::string newer = WithEditedJson(
      ReadText(baked), [](Json* gltf) { (*gltf)["extensions"]["LIMBER_mesh_ik"]["version"] = 99; });
  const std::string file = Write("newer.glb", newer);
  const std::string frames = Write("frames.json", R"({"frames":[{"targets":{}}]})");
  ExpectRefused({"solve", file, "--targets", frames, "-o", Path("out")},
                {"newer.glb", "version", "99"});
}

TEST_F(BadInput, SolveOfAnUnbakedFile_SaysToBake) {
  const std::string source = Write("bar.glb", MakeBar(4).ToGlb());
  const std::string frames = Write("frames.json", R"({"frames":[{"targets":{}}]})");
  ExpectRefused({"solve", source, "--targets", frames, "-o", Path("out")}, {"bar.glb", "bake"});
}

TEST_F(BadInput, UnwritableOutput_IsNamed) {
  const std::string baked = BakeGoodBar();
  const std::string source = Path("bar.glb");
  const std::string frames = Write("frames.json", R"({"frames":[{"targets":{}}]})");
  const std::string file = Write("file", "");
  const Words bake = {"bake", source, "--auto-handles", "3", "-o"};
  const auto with = [](Words words, const std::string& last) {
    words.push_back(last);
    return words;
  };
  ExpectRefused(with(bake, Path("no_such_folder/out.glb")), {"no_such_folder"});
  ExpectRefused(with(bake, file + "/out.glb"), {"file"});
  fs::create_directory(Path("folder.glb"));
  ExpectRefused(with(bake, Path("folder.glb")), {"folder.glb"});
  const Words solve = {"solve", baked, "--targets", frames, "-o"};
  ExpectRefused(with(solve, file), {"file"});
  ExpectRefused(with(solve, file + "/deeper/still"), {"deeper"});
  ExpectRefused({"render", baked, "--targets", frames, "-o", file}, {"file"});
}

// Two handles on one vertex end a bake in its first second: what is refused even earlier is never
// found only after minutes of work.
TEST_F(BadInput, WhatCannotBeWritten_IsRefusedBeforeTheBakeBegins) {
  const std::string handles =
      Write("clash.json", R"({"handles":[{"name":"tail","vertex":3},{"name":"knee","vertex":3}]})");
  const std::string good = MakeBar(4).ToGlb();
  const std::string textured = Write("textured.glb", WithEditedJson(good, [](Json* gltf) {
                                       (*gltf)["images"] = {{{"uri", "skin.png"}}};
                                     }));
  const auto refuse = [&](const std::string& source, const Words& words) {
    ExpectRefused({"bake", source, "-o", Path("out.glb"), "--handles", handles}, words);
  };
  refuse(textured, {"textured.glb", "skin.png"});
  Write("skin.png", "this is no picture");
  refuse(textured, {"textured.glb", "images[0]", "PNG"});
  refuse(Write("newer.glb",
               WithEditedJson(good,
                              [](Json* gltf) {
                                (*gltf)["extensions"]["LIMBER_mesh_ik"] = {{"version", 99}};
                              })),
         {"newer.glb", "version", "99"});
  refuse(Write("plain.glb", good), {"tail", "knee"});
}

TEST_F(BadInput, OutputsThatWouldOverwriteAnInput_AreRefused) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string rest = Write("rest.obj", obj), bent = Write("bent.obj", obj);
  ExpectRefused({"pack", rest, bent, "-o", Path("./bent.obj")}, {"bent.obj", "overwrite"});
  ExpectRefused({"pack", rest, bent, "-o", rest}, {"rest.obj", "overwrite"});
  ExpectRefused({"pack", rest, bent, "-o", Path("new.obj")}, {"new.obj", ".glb"});
  EXPECT_EQ(ReadText(rest), obj);
  EXPECT_EQ(ReadText(bent), obj);

  const std::string baked = BakeGoodBar();
  fs::create_directory(Path("out"));
  const std::string frames = Write("out/solve.json", R"({"frames":[{"targets":{}}]})");
  ExpectRefused({"solve", baked, "--targets", frames, "-o", Path("out")},
                {"solve.json", "overwrite"});

  const std::string handles = Write("handles.gltf", R"({"handles":[{"name":"a","vertex":0}]})");
  ExpectRefused({"bake", Path("bar.glb"), "--handles", handles, "-o", handles},
                {"handles.gltf", "overwrite"});
}

TEST_F(BadInput, WithJson_TheErrorIsAnObject) {
  const CommandResult result =
      RunLimber({"bake", Path("nowhere.glb"), "-o", Path("out.glb"), "--json"});
  EXPECT_EQ(result.exit_code, 1);
  const Json error = Json::parse(result.out, nullptr, false);
  ASSERT_TRUE(error.is_object()) << result.out;
  EXPECT_EQ(error["error"]["code"], "not_found");
  EXPECT_NE(error["error"]["message"].get<std::string>().find("nowhere.glb"), std::string::npos);
}

}  // namespace
}  // namespace limber::test
