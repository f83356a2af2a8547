// `limber inspect` from outside: the pictures that were asked for, and one clear line for what is
// not there.
#include "core/vector.h"
#include "run_limber.h"
#include "scoped_variable.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

namespace limber::test {
namespace {

using Json = nlohmann::json;
using Words = Vector<std::string>;

class LimberInspect : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteText(Path("bar.glb"), MakeBar(12).ToGlb());
    WriteText(Path("frames.json"),
              R"({"frames":[{"targets":{}},{"targets":{"handle_0":[0,6,0]}}]})");
    const CommandResult bake =
        RunLimber({"bake", Path("bar.glb"), "-o", Path("baked.glb"), "--auto-handles", "3"});
    ASSERT_EQ(bake.exit_code, 0) << bake.err;
  }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  CommandResult Inspect(Words more) const {
    Words words = {"inspect", Path("baked.glb"), "-o", Path("look"), "--size", "64x48"};
    words.insert(words.end(), more.begin(), more.end());
    return RunLimber(words);
  }

  TemporaryFolder folder_;
  // The driver leaves allocations behind that the leak checker would report as the command's.
  ScopedVariable no_leak_check_{"ASAN_OPTIONS", "detect_leaks=0"};
};

TEST_F(LimberInspect, WritesWhatIsAskedFor_WithoutAWordFromTheValidationLayers) {
  const CommandResult all = Inspect({"--json", "--validate"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  const Json report = Json::parse(all.out);
  const Words expected = {"weights_handle_0.png", "weights_handle_1.png", "weights_handle_2.png",
                          "weights.png",          "groups.png",           "examples.png"};
  EXPECT_EQ(report["pictures"].get<Words>(), expected);
  EXPECT_EQ(report["examples"].size(), 3u) << "a colour for each shape";
  EXPECT_EQ(FilesBelow(folder_.path() / "look").size(), expected.size());
  const CommandResult one = Inspect({"--what", "weights", "--handle", "handle_1", "--json"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(Json::parse(one.out)["pictures"].get<Words>(),
            (Words{"weights_handle_1.png", "weights.png"}));
}

// At rest the first example alone takes part; where another one is dragged up, it does not.
TEST_F(LimberInspect, Examples_ChangeWithThePose) {
  ASSERT_EQ(Inspect({"--what", "examples"}).exit_code, 0);
  const std::string rest = ReadText(Path("look") + "/examples.png");
  const CommandResult posed =
      Inspect({"--what", "examples", "--targets", Path("frames.json"), "--frame", "1"});
  ASSERT_EQ(posed.exit_code, 0) << posed.err;
  EXPECT_NE(ReadText(Path("look") + "/examples.png"), rest);
}

TEST_F(LimberInspect, WhatIsNotThere_IsNamedInOneLine) {
  const Words before = FilesBelow(folder_.path());
  const auto expect_refused = [&](const Words& words, int exit_code, const char* text) {
    const CommandResult result = Inspect(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
    EXPECT_EQ(FilesBelow(folder_.path()), before);
  };
  expect_refused({"--handle", "tail"}, 1, "handle_0, handle_1, handle_2");
  expect_refused({"--targets", Path("frames.json"), "--frame", "2"}, 1, "frames 0 to 1");
  expect_refused({"--what", "teeth"}, 2, "teeth");
  expect_refused({"--frame", "1"}, 2, "--targets");
  expect_refused({"--size", "64"}, 2, "--size");
}

TEST_F(LimberInspect, WithoutADevice_IsOneLineAndExitCode3) {
  const ScopedVariable icd("VK_ICD_FILENAMES", Path("no_such_driver.json"));
  const ScopedVariable drivers("VK_DRIVER_FILES", Path("no_such_driver.json"));
  const CommandResult result = Inspect({});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find("vulkan: no driver found"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(Path("look")));
}

TEST_F(LimberInspect, ABakeWithoutGroups_SaysToBakeAgain_AndStillShowsWeights) {
  const std::string old = std::string(LIMBER_SOURCE_DIR) + "/content/baked/v2/tube.glb";
  const CommandResult groups =
      RunLimber({"inspect", old, "-o", Path("old"), "--what", "groups", "--size", "64x48"});
  EXPECT_EQ(groups.exit_code, 1);
  EXPECT_NE(groups.err.find("bake it again"), std::string::npos) << groups.err;
  const CommandResult weights =
      RunLimber({"inspect", old, "-o", Path("old"), "--what", "weights", "--size", "64x48"});
  EXPECT_EQ(weights.exit_code, 0) << weights.err;
}

}  // namespace
}  // namespace limber::test
