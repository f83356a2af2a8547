// What `bake` and `info` say of weights and costs, and a bake that is stopped at any moment.
#include "core/vector.h"
#include "run_limber.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include <string>

namespace limber::test {
namespace {

using Json = nlohmann::json;
using Words = Vector<std::string>;

class BakeOptionsTest : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  void WriteBar(int segments) { WriteText(Path("bar.glb"), MakeBar(segments).ToGlb()); }

  CommandResult Bake(Words more) const {
    Words words = {"bake", Path("bar.glb"), "-o", Path("baked.glb"), "--auto-handles", "5"};
    words.insert(words.end(), more.begin(), more.end());
    return RunLimber(words);
  }

  TemporaryFolder folder_;
};

TEST_F(BakeOptionsTest, Weights_TheOptimalityOfEachHandleIsReported) {
  WriteBar(40);
  const CommandResult result = Bake({"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json weights = Json::parse(result.out)["weights"];
  EXPECT_EQ(weights["bound_violation"], 0);
  ASSERT_EQ(weights["handles"].size(), 5u);
  for (const Json& handle : weights["handles"]) {
    EXPECT_GT(handle["iterations"], 0) << handle;
    EXPECT_LE(handle["stationarity"], 1e-8) << handle;
    EXPECT_LE(handle["complementarity"], 1e-12) << handle;
  }
}

TEST_F(BakeOptionsTest, HeatWeights_AreAPreviewAndCalledSo) {
  WriteBar(40);
  const CommandResult result = Bake({"--weights", "heat"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("weights  a preview"), std::string::npos) << result.out;
  const CommandResult computed = Bake({"--json"}), heat = Bake({"--weights", "heat", "--json"});
  ASSERT_EQ(heat.exit_code, 0) << heat.err;
  EXPECT_EQ(Json::parse(heat.out)["weights"]["source"], "heat");
  EXPECT_EQ(Json::parse(computed.out)["weights"]["source"], "computed");
}

TEST_F(BakeOptionsTest, Influences_AreCutAndTheChangeIsTold) {
  WriteBar(40);
  const CommandResult all = Bake({"--json"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  const Json whole = Json::parse(all.out)["weights"]["influences"];
  EXPECT_EQ(whole["kept"], 5);
  EXPECT_EQ(whole["cut_vertices"], 0);
  ASSERT_GT(whole["most"], 2) << "nothing to cut";
  const CommandResult cut = Bake({"--influences", "2", "--json"});
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  const Json two = Json::parse(cut.out)["weights"]["influences"];
  EXPECT_EQ(two["kept"], 2);
  EXPECT_GT(two["cut_vertices"], 0);
  EXPECT_GT(two["largest_change"], 0);
  EXPECT_LE(two["rms_change"], two["largest_change"].get<double>() * 5);
  const CommandResult text = Bake({"--influences", "2"});
  EXPECT_NE(text.out.find("cut to 2"), std::string::npos) << text.out;
  EXPECT_EQ(Bake({"--influences", "0"}).exit_code, 2);
}

TEST_F(BakeOptionsTest, Cost_OfASourceIsAtLeastThatOfItsBake) {
  WriteBar(12);
  const CommandResult baked = Bake({"--json"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const Json paid = Json::parse(baked.out)["cost"];
  const CommandResult info = RunLimber({"info", Path("baked.glb"), "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(Json::parse(info.out)["cost"], paid);
  const CommandResult before =
      RunLimber({"info", Path("bar.glb"), "--auto-handles", "5", "--json"});
  ASSERT_EQ(before.exit_code, 0) << before.err;
  const Json thought = Json::parse(before.out)["cost"];
  EXPECT_EQ(thought["handles"], 5);
  EXPECT_EQ(thought["groups"], 10);
  for (const char* key : {"file_bytes", "model_bytes", "mesh_bytes", "alternation_seconds"})
    EXPECT_GE(thought[key], paid[key]) << key;
  EXPECT_FALSE(Json::parse(RunLimber({"info", Path("bar.glb"), "--json"}).out).contains("cost"));
}

TEST_F(BakeOptionsTest, TooManyGroups_AreRefusedWithTheNumberThatFits) {
  WriteBar(12);
  const CommandResult result = Bake({"--groups", "2000"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("--groups 1333 or fewer"), std::string::npos) << result.err;
  EXPECT_EQ(FilesBelow(folder_.path()), Words{"bar.glb"});
}

// Whenever the interrupt comes: either the whole file is there or none of it.
TEST_F(BakeOptionsTest, InterruptedAtAnyMoment_LeavesAWholeFileOrNone) {
  WriteBar(400);
  int stopped = 0;
  for (const int delay_ms : {5, 20, 60, 120, 250, 500}) {
    const CommandResult result = RunLimberAndSignal(
        {"bake", Path("bar.glb"), "-o", Path("baked.glb"), "--auto-handles", "16"}, SIGINT,
        delay_ms);
    if (result.exit_code == 0) {
      EXPECT_EQ(RunLimber({"info", Path("baked.glb")}).exit_code, 0);
      std::filesystem::remove(Path("baked.glb"));
    } else {
      ++stopped;  // before the handler was in place the signal itself ends the process
      EXPECT_TRUE(result.exit_code == 130 || result.exit_code == 128 + SIGINT) << result.exit_code;
    }
    EXPECT_EQ(FilesBelow(folder_.path()), Words{"bar.glb"}) << delay_ms << " ms";
  }
  EXPECT_GT(stopped, 0);
}

}  // namespace
}  // namespace limber::test
