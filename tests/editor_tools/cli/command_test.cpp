// The command from outside: help, usage, JSON, and a bar that is baked, inspected and dragged.
#include "core/vector.h"
#include "run_limber.h"
#include "small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = Vector<std::string>;
using Points = Vector<std::array<float, 3>>;

struct Obj {
  Points vertices;
  Vector<uint32_t> corners;  // triangles, from 0
};

Obj ParseObj(const std::string& text) {
  Obj obj;
  std::istringstream lines(text);
  std::string kind;
  while (lines >> kind) {
    if (kind == "v") {
      std::array<float, 3> p = {};
      lines >> p[0] >> p[1] >> p[2];
      obj.vertices.push_back(p);
    } else {
      for (int i = 0; i < 3; ++i) {
        uint32_t corner = 0;
        lines >> corner;
        obj.corners.push_back(corner - 1);
      }
    }
  }
  return obj;
}

double LargestDistance(const Points& a, const Points& b) {
  if (a.size() != b.size()) return 1e30;
  double largest = 0;
  for (size_t v = 0; v < a.size(); ++v) {
    largest = std::max(largest,
                       double(std::hypot(a[v][0] - b[v][0], a[v][1] - b[v][1], a[v][2] - b[v][2])));
  }
  return largest;
}

class LimberCommand : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  std::string Write(const std::string& name, const std::string& content) const {
    WriteText(Path(name), content);
    return Path(name);
  }

  void BakeBar(int length) {
    bar_ = MakeBar(length);
    const std::string source = Write("bar.glb", bar_.ToGlb());
    const std::string handles = Write(
        "handles.json", R"({"handles":[{"name":"left","vertex":0},{"name":"right","vertex":)" +
                            std::to_string(4 * length) + "}]}");
    const CommandResult result =
        RunLimber({"bake", source, "-o", Path("baked.glb"), "--handles", handles, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    bake_report_ = Json::parse(result.out);
  }

  // The bar with its target number `index` (-1: none) in full, and its right handle there.
  Points Example(int index) const {
    Points points = bar_.positions;
    if (index < 0) return points;
    for (size_t v = 0; v < points.size(); ++v) {
      for (size_t i = 0; i < 3; ++i)
        points[v][i] += bar_.targets[size_t(index)][v][i];
    }
    return points;
  }

  TemporaryFolder folder_;
  SmallGltf bar_;
  Json bake_report_;
};

TEST_F(LimberCommand, HelpOfEverySubcommand_TeachesWithExamples) {
  EXPECT_EQ(RunLimber({"--help"}).exit_code, 0);
  for (const char* name : {"pack", "bake", "info", "solve", "bench", "render", "play"}) {
    const CommandResult help = RunLimber({name, "--help"});
    EXPECT_EQ(help.exit_code, 0) << name;
    EXPECT_NE(help.out.find("limber " + std::string(name)), std::string::npos) << help.out;
    EXPECT_NE(help.out.find("Examples:"), std::string::npos) << help.out;
    EXPECT_EQ(help.err, "");
  }
}

TEST_F(LimberCommand, SolveAndRender_HaveTheVariantsOfTheEnergy) {
  for (const char* name : {"solve", "render"}) {
    const CommandResult help = RunLimber({name, "--help"});
    for (const char* flag : {"--no-rotations", "--uniform", "--no-roots"})
      EXPECT_NE(help.out.find(flag), std::string::npos) << name << " " << flag;
  }
}

TEST_F(LimberCommand, WrongUsage_IsOneLineAndExitCode2) {
  for (const Words& words :
       {Words{}, Words{"fly"}, Words{"bake"}, Words{"bake", "a.glb"},
        Words{"bake", "a.glb", "-o", "b.glb", "--auto-handles", "no"},
        Words{"bake", "a.glb", "-o", "b.glb", "--unknown"},
        Words{"solve", "a.glb", "-o", "d", "--targets", "f", "--iterations", "0"},
        Words{"render", "a.glb", "-o", "d", "--targets", "f", "--size", "12by7"}}) {
    const CommandResult result = RunLimber(words);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("--help"), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(LimberCommand, Bake_ReportsWhatItMade) {
  BakeBar(12);
  EXPECT_EQ(bake_report_["draw_vertices"], 52);
  EXPECT_EQ(bake_report_["solve_vertices"], 52);
  EXPECT_EQ(bake_report_["dimension"], 3);
  EXPECT_EQ(bake_report_["shapes"].size(), 3u);
  EXPECT_EQ(bake_report_["handles"].size(), 2u);
  EXPECT_EQ(bake_report_["bytes"], fs::file_size(Path("baked.glb")));
}

TEST_F(LimberCommand, Bake_SameInputGivesTheSameBytes) {
  BakeBar(12);
  const std::string first = ReadText(Path("baked.glb"));
  const CommandResult again = RunLimber({"bake", Path("bar.glb"), "-o", Path("again.glb"),
                                         "--handles", Path("handles.json"), "--threads", "1"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadText(Path("again.glb")), first);
}

TEST_F(LimberCommand, Info_KnowsSourceAndBake) {
  BakeBar(12);
  const CommandResult source = RunLimber({"info", Path("bar.glb"), "--json"});
  ASSERT_EQ(source.exit_code, 0) << source.err;
  const Json plain = Json::parse(source.out);
  EXPECT_EQ(plain["baked"], false);
  EXPECT_EQ(plain["shapes"].size(), 3u);
  EXPECT_EQ(plain["draw_vertices"], 52);
  const CommandResult result = RunLimber({"info", Path("baked.glb"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json baked = Json::parse(result.out);
  EXPECT_EQ(baked["baked"], true);
  EXPECT_EQ(baked["version"], 3);
  EXPECT_EQ(baked["handles"][1]["name"], "right");
  EXPECT_EQ(baked["triangles"], plain["triangles"]);
  for (int s = 0; s < 3; ++s) {
    const auto at = baked["handles"][1]["examples"][size_t(s)].get<std::array<float, 3>>();
    EXPECT_LT(LargestDistance({at}, {Example(s - 1)[48]}), 1e-5) << "shape " << s;
  }
  EXPECT_EQ(RunLimber({"info", Path("baked.glb")}).exit_code, 0);
}

TEST_F(LimberCommand, Solve_RestAndExamplesComeBackInSourceOrder) {
  BakeBar(12);
  Json frames = {{"frames", Json::array({Json{{"targets", Json::object()}}})}};
  const auto right = size_t(48);
  const Points bent = Example(0);
  frames["frames"].push_back({{"targets", {{"right", bent[right]}, {"left", bent[0]}}}});
  Write("frames.json", frames.dump());
  const CommandResult result = RunLimber({"solve", Path("baked.glb"), "--targets",
                                          Path("frames.json"), "-o", Path("out"), "--settle"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(FilesBelow(Path("out")), (Words{"frame_0000.obj", "frame_0001.obj", "solve.json"}));

  const Obj rest = ParseObj(ReadText(Path("out/frame_0000.obj")));
  EXPECT_EQ(rest.corners, bar_.indices);
  EXPECT_LT(LargestDistance(rest.vertices, bar_.positions), 1e-4 * 12);
  const Obj dragged = ParseObj(ReadText(Path("out/frame_0001.obj")));
  EXPECT_LT(LargestDistance(dragged.vertices, bent), 0.01 * 12);

  const Json report = Json::parse(ReadText(Path("out/solve.json")));
  ASSERT_EQ(report["frames"].size(), 2u);
  for (const Json& frame : report["frames"]) {
    EXPECT_TRUE(frame["energy"].is_number());
    EXPECT_GE(frame["iterations"].get<int>(), 1);
    EXPECT_GE(frame["seconds"].get<double>(), 0.0);
    for (const Json& group : frame["blend_weights"]) {
      ASSERT_EQ(group.size(), 3u);
      double sum = 0;
      for (const Json& weight : group)
        sum += weight.get<double>();
      EXPECT_NEAR(sum, 1, 1e-5);
    }
  }
}

TEST_F(LimberCommand, SolveUniform_AllGroupsHaveTheSameBlend) {
  const std::string square = LIMBER_SOURCE_DIR "/content/characters/square.glb";
  ASSERT_EQ(RunLimber({"bake", square, "-o", Path("baked.glb")}).exit_code, 0);
  // Where the square begins to puff, its groups do so one after the other.
  Write("frames.json", R"({"frames":[{"targets":{"right":[1.12,0,0]}}]})");
  const auto spread = [this](const Words& flags) {
    Words words = {"solve", Path("baked.glb"), "--targets", Path("frames.json"),
                   "-o",    Path("out"),       "--settle",  "--no-rotations"};
    words.insert(words.end(), flags.begin(), flags.end());
    const CommandResult result = RunLimber(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(ReadText(Path("out/solve.json")));
    const Json& groups = report["frames"][0]["blend_weights"];
    EXPECT_GT(groups.size(), 1u);
    double largest = 0;
    for (const Json& group : groups)
      largest = std::max(largest, std::abs(group[0].get<double>() - groups[0][0].get<double>()));
    return largest;
  };
  EXPECT_GT(spread({}), 0.01);
  EXPECT_EQ(spread({"--uniform"}), 0);
}

// With lambda 0 both forms have the same optimum; the energy is then E_d or its root.
TEST_F(LimberCommand, SolveNoRoots_EnergyIsTheSquare) {
  BakeBar(12);
  const std::string frames =
      Write("frames.json", R"({"frames":[{"targets":{"right":[15,1,2],"left":[-1,0,1]}}]})");
  const auto energy = [&](const Words& flags) {
    Words words = {"solve",     Path("baked.glb"), "--targets",      frames,     "-o",
                   Path("out"), "--settle",        "--no-rotations", "--lambda", "0"};
    words.insert(words.end(), flags.begin(), flags.end());
    const CommandResult result = RunLimber(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(ReadText(Path("out/solve.json")))["frames"][0]["energy"].get<double>();
  };
  const double root = energy({}), square = energy({"--no-roots"});
  EXPECT_GT(std::abs(root - 1), 0.1) << "a square like its root shows nothing";
  EXPECT_NEAR(square, root * root, 1e-4 * square);
}

// Targets too far apart give way; a weight of null says which does not.
TEST_F(LimberCommand, SolveStretchLimit_GivesWayByTheFramesWeights) {
  BakeBar(12);
  const auto ends = [this](const char* weights) {
    const std::string frames = Write(
        "frames.json", std::string(R"({"frames":[{"targets":{"right":[40,0,0],"left":[0,0,0]},)") +
                           R"("weights":)" + weights + "}]}");
    const CommandResult result = RunLimber({"solve", Path("baked.glb"), "--targets", frames, "-o",
                                            Path("out"), "--settle", "--stretch-limit", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Obj obj = ParseObj(ReadText(Path("out/frame_0000.obj")));
    return std::array{obj.vertices[0][0], obj.vertices[48][0]};
  };
  const auto [left, right] = ends("{}");
  const auto [held_left, near_right] = ends(R"({"left":null})");
  EXPECT_GT(left, 5) << "both give way";
  EXPECT_LT(right, 35);
  EXPECT_NEAR(held_left, 0, 1e-3);
  EXPECT_NEAR(near_right, right - left, 0.01) << "as far apart as before";
}

TEST_F(LimberCommand, Solve_HandleLeftOutKeepsItsTarget) {
  BakeBar(12);
  const std::string moved =
      Write("moved.json", R"({"frames":[{"targets":{"right":[12,3,0]}},{"targets":{}}]})");
  ASSERT_EQ(
      RunLimber({"solve", Path("baked.glb"), "--targets", moved, "-o", Path("out"), "--settle"})
          .exit_code,
      0);
  const Obj first = ParseObj(ReadText(Path("out/frame_0000.obj")));
  const Obj second = ParseObj(ReadText(Path("out/frame_0001.obj")));
  EXPECT_NEAR(second.vertices[48][1], 3, 1e-3);
  EXPECT_LT(LargestDistance(first.vertices, second.vertices), 1e-2);
}

TEST_F(LimberCommand, SolveTwice_GivesTheSameMeshes) {
  BakeBar(12);
  const std::string frames = Write(
      "frames.json", R"({"frames":[{"targets":{"right":[12,3,0]}},{"targets":{"left":[0,1,1]}}]})");
  for (const char* out : {"a", "b"}) {
    ASSERT_EQ(
        RunLimber({"solve", Path("baked.glb"), "--targets", frames, "-o", Path(out)}).exit_code, 0);
  }
  EXPECT_EQ(ReadText(Path("a/frame_0001.obj")), ReadText(Path("b/frame_0001.obj")));
}

TEST_F(LimberCommand, InterruptedBake_LeavesNothing) {
  Write("long.glb", MakeBar(6000).ToGlb());
  const Words before = FilesBelow(folder_.path());
  const CommandResult result = RunLimberAndSignal(
      {"bake", Path("long.glb"), "-o", Path("out.glb"), "--auto-handles", "24"}, SIGINT, 200);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(FilesBelow(folder_.path()), before);
}

TEST_F(LimberCommand, PackedObjs_ComeBackInTheirOwnOrder) {
  // A square of two triangles whose vertices are listed backwards, with its own face order.
  const char* faces = "f 1 4 2\nf 1 3 4\n";
  Write("rest.obj", std::string("v 1 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\n") + faces);
  Write("wide.obj", std::string("v 2 1 0\nv 2 0 0\nv 0 1 0\nv 0 0 0\n") + faces);
  ASSERT_EQ(
      RunLimber({"pack", Path("rest.obj"), Path("wide.obj"), "-o", Path("square.glb")}).exit_code,
      0);
  const std::string handles =
      Write("handles.json", R"({"handles":[{"name":"a","vertex":3},{"name":"b","vertex":1}]})");
  CommandResult result =
      RunLimber({"bake", Path("square.glb"), "-o", Path("baked.glb"), "--handles", handles});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string frames =
      Write("frames.json", R"({"frames":[{"targets":{"a":[0,0,0],"b":[1.5,0,0]}}]})");
  result =
      RunLimber({"solve", Path("baked.glb"), "--targets", frames, "-o", Path("out"), "--settle"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Obj obj = ParseObj(ReadText(Path("out/frame_0000.obj")));
  EXPECT_EQ(obj.corners, (Vector<uint32_t>{0, 3, 1, 0, 2, 3}));
  EXPECT_LT(LargestDistance(obj.vertices, {{1.5f, 1, 0}, {1.5f, 0, 0}, {0, 1, 0}, {0, 0, 0}}),
            1e-3);
}

}  // namespace
}  // namespace limber::test
