// limber bench from outside: what it reports must hang together; no time itself is judged.
#include "core/vector.h"
#include "run_limber.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include <algorithm>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = Vector<std::string>;

class BenchCommand : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  // The result, expected to succeed.
  static Json Bench(Words words) {
    words.insert(words.begin(), "bench");
    words.insert(words.end(), {"--json", "--frames", "20"});
    const CommandResult result = RunLimber(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return Json::parse(result.out);
  }

  // A bar as OBJ, its target number `index` (-1: none) in full.
  static std::string BarObj(const SmallGltf& bar, int index) {
    std::string text;
    for (size_t v = 0; v < bar.positions.size(); ++v) {
      text += "v";
      for (size_t i = 0; i < 3; ++i) {
        const float moved = index < 0 ? 0 : bar.targets[static_cast<size_t>(index)][v][i];
        text += " " + std::to_string(bar.positions[v][i] + moved);
      }
      text += "\n";
    }
    for (size_t t = 0; t < bar.indices.size(); t += 3) {
      text += "f";
      for (size_t i = 0; i < 3; ++i)
        text += " " + std::to_string(bar.indices[t + i] + 1);
      text += "\n";
    }
    return text;
  }

  void WriteHorse(const SmallGltf& bar) const {
    fs::create_directories(Path("data/horse"));
    WriteText(Path("data/horse/horse_ref.obj"), BarObj(bar, -1));
    WriteText(Path("data/horse/horse-01.obj"), BarObj(bar, 0));
    WriteText(Path("data/horse/horse-02.obj"), BarObj(bar, 1));
  }

  TemporaryFolder folder_;
};

void ExpectTimesHangTogether(const Json& row) {
  EXPECT_GT(row["alternation_us"].get<double>(), 0);
  EXPECT_GT(row["mean_us"].get<double>(), 0);
  for (const char* stage : {"rotations", "nearness", "blend", "transforms"})
    EXPECT_GT(row["stages_us"][stage].get<double>(), 0) << stage;
}

TEST_F(BenchCommand, Quick_GivesTheRowOfTheTable) {
  const Json report = Bench({"--quick", "--only", "snake"});
  EXPECT_EQ(report["frames"], 20);
  ASSERT_EQ(report["rows"].size(), 1u);
  const Json& row = report["rows"][0];
  EXPECT_EQ(row["name"], "snake");
  EXPECT_EQ(row["dimension"], 2);
  EXPECT_EQ(row["vertices"], 817);
  EXPECT_EQ(row["shapes"], 5);
  EXPECT_EQ(row["handles"], 2);
  EXPECT_EQ(row["mesh"], "made");
  EXPECT_TRUE(row["precompute_s"].is_null());
  ExpectTimesHangTogether(row);
  EXPECT_EQ(row["paper"]["alternation_us"], 1e4);
  EXPECT_NEAR(row["times_faster"].get<double>() * row["alternation_us"].get<double>(), 1e4, 1e-6);
}

TEST_F(BenchCommand, WholeBake_IsMeasuredAndRowsKeepThePapersOrder) {
  const Json report = Bench({"--only", "caterpillar", "--only", "snake"});
  ASSERT_EQ(report["rows"].size(), 2u);
  EXPECT_EQ(report["rows"][0]["name"], "snake");
  EXPECT_EQ(report["rows"][1]["name"], "caterpillar");
  for (const Json& row : report["rows"])
    EXPECT_GT(row["precompute_s"].get<double>(), 0);
}

TEST_F(BenchCommand, Heads_AreSolvedWithoutRotations) {
  const Json report = Bench({"--quick", "--only", "head"});
  EXPECT_EQ(report["rows"][0]["rotations"], false);
}

TEST_F(BenchCommand, Data_TakesTheFilesThatAreThere) {
  const SmallGltf bar = MakeBar(12);
  WriteHorse(bar);
  const Json report =
      Bench({"--quick", "--data", Path("data"), "--only", "horse", "--only", "caterpillar"});
  ASSERT_EQ(report["rows"].size(), 2u);
  EXPECT_EQ(report["rows"][0]["mesh"], "made");
  const Json& horse = report["rows"][1];
  EXPECT_EQ(horse["mesh"], "paper");
  EXPECT_EQ(horse["vertices"], bar.positions.size());
  EXPECT_EQ(horse["shapes"], 3);
  EXPECT_EQ(horse["handles"], 10);
}

TEST_F(BenchCommand, BakedFiles_AreMeasuredFreeHandlesIncluded) {
  WriteText(Path("bar.glb"), MakeBar(12).ToGlb());
  WriteText(Path("handles.json"), R"({"handles":[{"name":"a","vertex":0},
      {"name":"b","vertex":24,"free":true},{"name":"c","vertex":48}]})");
  ASSERT_EQ(RunLimber({"bake", Path("bar.glb"), "-o", Path("baked.glb"), "--handles",
                       Path("handles.json")})
                .exit_code,
            0);
  const Json report = Bench({Path("baked.glb"), Path("baked.glb")});
  ASSERT_EQ(report["rows"].size(), 2u);
  for (const Json& row : report["rows"]) {
    EXPECT_EQ(row["name"], "baked");
    EXPECT_EQ(row["vertices"], 52);
    EXPECT_EQ(row["handles"], 3);
    EXPECT_FALSE(row.contains("paper"));
    EXPECT_FALSE(row.contains("precompute_s"));
    ExpectTimesHangTogether(row);
  }
}

TEST_F(BenchCommand, Table_FitsAHundredColumns) {
  const CommandResult table =
      RunLimber({"bench", "--quick", "--only", "caterpillar", "--only", "horse"});
  ASSERT_EQ(table.exit_code, 0) << table.err;
  std::istringstream lines(table.out);
  int num_rows = 0;
  for (std::string line; std::getline(lines, line); ++num_rows)
    EXPECT_LE(line.size(), 100u) << line;
  EXPECT_EQ(num_rows, 3 + 2) << table.out;
}

TEST_F(BenchCommand, WhatCannotBeMeasured_IsOneLine) {
  WriteText(Path("bar.glb"), MakeBar(12).ToGlb());
  fs::create_directories(Path("lions/characters"));
  fs::copy(Path("bar.glb"), Path("lions/characters/lion-poses.glb"));
  WriteHorse(MakeBar(12));
  WriteText(Path("data/horse/horse-02.obj"), "v 0 0 zero\n");
  const Vector<std::tuple<Words, int, std::string>> cases = {
      {{"--only", "unicorn"}, 2, "unicorn"},
      {{Path("bar.glb"), "--quick"}, 2, "--quick"},
      {{"--frames", "0"}, 2, "--frames"},
      {{Path("absent.glb")}, 1, "absent.glb"},
      {{Path("bar.glb")}, 1, "bar.glb"},
      {{"--data", Path("absent")}, 1, "leave --data out"},
      {{"--data", Path("lions"), "--only", "lion"}, 1, "3 shapes; the paper's lion has 6"},
      {{"--data", Path("data"), "--only", "horse"}, 1, "horse-02.obj"},
  };
  for (const auto& [words, exit_code, text] : cases) {
    Words all = {"bench", "--json"};
    all.insert(all.end(), words.begin(), words.end());
    const CommandResult result = RunLimber(all);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
    EXPECT_TRUE(Json::parse(result.out).contains("error")) << result.out;
  }
}

TEST_F(BenchCommand, Interrupted_EndsSoon) {
  const CommandResult result =
      RunLimberAndSignal({"bench", "--only", "face", "--json"}, SIGINT, 300);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(Json::parse(result.out)["error"]["code"], "interrupted");
}

}  // namespace
}  // namespace limber::test
