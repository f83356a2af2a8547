// limber pack of an animated glTF, from outside: moments of a clip all the way to a baked
// character.
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "run_limber.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace limber::test {
namespace {

using Json = nlohmann::json;
using Words = Vector<std::string>;

class PackClipCommand : public ::testing::Test {
 protected:
  PackClipCommand() { MakeAnimatedBar().Write(Path("bar.glb")); }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  // limber pack bar.glb, with options between.
  CommandResult Pack(Words options, const std::string& output = "out.glb") const {
    Words words = {"pack", Path("bar.glb"), "-o", Path(output)};
    words.insert(words.end(), options.begin(), options.end());
    return RunLimber(words);
  }

  void ExpectRefused(const CommandResult& result, int exit_code, const std::string& word) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << "no '" << word << "' in " << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(FilesBelow(folder_.path()), Words{"bar.glb"});
  }

  TemporaryFolder folder_;
};

TEST_F(PackClipCommand, MomentsOfAClip_AreBakedAsExampleShapes) {
  const CommandResult packed = Pack({"--clip", "Bend", "--times", "0.5,1", "--json"});
  ASSERT_EQ(packed.exit_code, 0) << packed.err;
  const Json report = Json::parse(packed.out);
  EXPECT_EQ(report["targets"], Json({"Bend@0.5", "Bend@1"}));
  EXPECT_EQ(report["node"], "Bar");
  EXPECT_EQ(report["clip_seconds"], 1.0);
  EXPECT_EQ(report["loops"], false);
  const CommandResult baked =
      RunLimber({"bake", Path("out.glb"), "-o", Path("baked.glb"), "--auto-handles", "6"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const CommandResult info = RunLimber({"info", Path("baked.glb"), "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(Json::parse(info.out)["shapes"], Json({"base", "Bend@0.5", "Bend@1"}));
}

TEST_F(PackClipCommand, Summary_NamesClipMeshAndShapes) {
  const CommandResult result = Pack({"--count", "3"}, "out.gltf");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* word :
       {"\"Bend\"", "1.000 s", "\"Bar\", 68 vertices", "Bend@0, Bend@0.5, Bend@1"})
    EXPECT_NE(result.out.find(word), std::string::npos) << "no '" << word << "' in " << result.out;
  EXPECT_NE(result.err.find("warning: morph target \"Bend@0\""), std::string::npos) << result.err;
}

TEST_F(PackClipCommand, InPlace_TakesTheTravelOut) {
  GltfParts parts = MakeAnimatedBar();
  AddChannel(&parts, 0, kBarRootNode, "translation", {0, 1}, {0, 0, 0, 50, 0, 50});
  parts.Write(Path("bar.glb"));
  const auto farthest = [this](const Words& options) {
    EXPECT_EQ(Pack(options, "out.gltf").exit_code, 0);
    const Json gltf = Json::parse(ReadText(Path("out.gltf")));
    const Json& target = gltf["meshes"][0]["primitives"][0]["targets"][0];
    return gltf["accessors"][target["POSITION"].get<size_t>()]["max"][2].get<double>();
  };
  EXPECT_NEAR(farthest({"--times", "1"}), 50, 1);
  EXPECT_LT(farthest({"--times", "1", "--in-place"}), 1);
}

TEST_F(PackClipCommand, OptionsOfTheOtherUse_AreRefusedAsWrongUsage) {
  constexpr int kUsage = 2;
  ExpectRefused(Pack({}), kUsage, "--times or --count");
  ExpectRefused(Pack({"--times", "0.5", "--count", "2"}), kUsage, "--count");
  ExpectRefused(Pack({"--times", "0.5", "--name", "x"}), kUsage, "--name");
  ExpectRefused(Pack({"--times", "0.5,,1"}), kUsage, "0.5,,1");
  ExpectRefused(Pack({"--times", ""}), kUsage, "--times");
  ExpectRefused(Pack({"--count", "0"}), kUsage, "--count");
  ExpectRefused(
      RunLimber({"pack", Path("bar.glb"), "shape.obj", "-o", Path("out.glb"), "--times", "0"}),
      kUsage, "shape.obj");
  for (const Words& option : Vector<Words>{{"--clip", "Bend"},
                                           {"--times", "0"},
                                           {"--count", "1"},
                                           {"--node", "Bar"},
                                           {"--in-place"}}) {
    Words words = {"pack", "rest.obj", "bent.obj", "-o", Path("out.glb")};
    words.insert(words.end(), option.begin(), option.end());
    ExpectRefused(RunLimber(words), kUsage, option[0]);
  }
  ExpectRefused(RunLimber({"pack", "rest.obj", "-o", Path("out.glb")}), kUsage, "SHAPE");
}

TEST_F(PackClipCommand, ImpossibleMoments_AreRefusedInOneLine) {
  constexpr int kFailed = 1;
  ExpectRefused(Pack({"--times", "3"}), kFailed, "1.000 s long");
  ExpectRefused(Pack({"--times=-1"}), kFailed, "-1");
  ExpectRefused(Pack({"--times", "nan"}), kFailed, "nan");
  ExpectRefused(Pack({"--times", "0", "--clip", "Walk"}), kFailed, "\"Bend\" (0, 1.000 s)");
  ExpectRefused(Pack({"--times", "1"}, "out.obj"), kFailed, ".glb or .gltf");
  ExpectRefused(Pack({"--times", "1"}, "bar.glb"), kFailed, "overwrite");
}

}  // namespace
}  // namespace limber::test
