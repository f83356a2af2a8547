// `limber render` from outside: pictures of the asked size, and not a word from the validation
// layers.
#include "core/vector.h"
#include "run_limber.h"
#include "scoped_variable.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace limber::test {
namespace {

using Json = nlohmann::json;

class LimberRender : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteText(Path("bar.glb"), MakeBar(12).ToGlb());
    WriteText(Path("frames.json"),
              R"({"frames":[{"targets":{}},{"targets":{"handle_0":[0,6,0]}},{"targets":{}}]})");
    const CommandResult bake =
        RunLimber({"bake", Path("bar.glb"), "-o", Path("baked.glb"), "--auto-handles", "4"});
    ASSERT_EQ(bake.exit_code, 0) << bake.err;
  }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
  // Of the command's own process: a Vulkan driver that is unloaded at its end leaves allocations
  // behind that the leak checker would report as the command's.
  ScopedVariable no_leak_check_{"ASAN_OPTIONS", "detect_leaks=0"};
};

// A big-endian number of a PNG's header.
uint32_t HeaderNumber(const std::string& png, size_t offset) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4; ++i)
    number = number << 8 | static_cast<uint8_t>(png.at(offset + i));
  return number;
}

TEST_F(LimberRender, Frames_ArePicturesOfTheAskedSizeWithoutAMessage) {
  const CommandResult result =
      RunLimber({"render", Path("baked.glb"), "--targets", Path("frames.json"), "-o", Path("out"),
                 "--size", "321x200", "--dots", "--validate", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(FilesBelow(Path("out")),
            (Vector<std::string>{"frame_0000.png", "frame_0001.png", "frame_0002.png"}));
  const std::string rest = ReadText(Path("out/frame_0000.png"));
  const std::string dragged = ReadText(Path("out/frame_0001.png"));
  ASSERT_GT(rest.size(), 24u);
  EXPECT_EQ(rest.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(HeaderNumber(rest, 16), 321u);
  EXPECT_EQ(HeaderNumber(rest, 20), 200u);
  EXPECT_NE(rest, dragged);
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report["frames"], 3);
  for (const char* stage : {"solve", "skin", "draw"}) {
    EXPECT_GT(report["ms_per_frame"][stage].get<double>(), 0.0) << stage;
  }
}

TEST_F(LimberRender, WithoutADevice_IsOneLineAndExitCode3) {
  const ScopedVariable icd("VK_ICD_FILENAMES", Path("no_such_driver.json"));
  const ScopedVariable drivers("VK_DRIVER_FILES", Path("no_such_driver.json"));
  const CommandResult result =
      RunLimber({"render", Path("baked.glb"), "--targets", Path("frames.json"), "-o", Path("out")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(FilesBelow(folder_.path()).size(), 3u);
}

}  // namespace
}  // namespace limber::test
