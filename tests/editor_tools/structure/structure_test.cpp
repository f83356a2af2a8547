// The tree keeps its shape: includes point one way, and no file grows into two things.
#include "core/vector.h"
#include "include_rules.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

std::string Joined(const Vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines)
    text += line + "\n";
  return text;
}

// A tree with one file that holds one include line.
IncludeReport CheckOne(const std::string& file, const std::string& line) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / file;
  fs::create_directories(path.parent_path());
  std::ofstream(path) << "// A comment.\n" << line << "\n";
  return CheckIncludes(folder.path());
}

TEST(IncludeDirection, WholeTree_HasNoViolation) {
  const IncludeReport report = CheckIncludes(LIMBER_SOURCE_DIR);
  EXPECT_GT(report.num_files, 40) << "the test looked at hardly any file";
  EXPECT_GT(report.num_includes, 150);
  EXPECT_TRUE(report.violations.empty()) << Joined(report.violations);
}

TEST(IncludeDirection, ForbiddenIncludes_AreFound) {
  const Vector<std::pair<std::string, std::string>> cases = {
      {"runtime/core/a.cpp", "#include \"bake/bake.h\""},
      {"runtime/skin/a.cpp", "  #  include \"import/raw_character.h\""},
      {"runtime/solve/a.h", "#include <tiny_gltf.h>"},
      {"runtime/solve/a.h", "#include \"load/rig_loader.h\""},
      {"runtime/skin/a.h", "#include <vulkan/vulkan.h>"},
      {"runtime/pick/a.h", "#include <volk.h>"},
      {"runtime/skin/a.cpp", "#include \"skin_vulkan/vulkan_skinner.h\""},
      {"runtime/rig/a.h", "#include \"../../editor_tools/bake/bake.h\""},
      {"runtime/unknown_room/a.h", "#include <vector>"},
      {"editor_tools/geometry/a.cpp", "#include \"bake/bake.h\""},
      {"editor_tools/deform/killing/a.cpp", "#include \"viewer/headless.h\""},
      {"editor_tools/bake/a.cpp", "#include \"cli/console.h\""},
      {"editor_tools/bake/a.cpp", "#include <vulkan/vulkan.h>"},
  };
  for (const auto& [file, line] : cases) {
    EXPECT_EQ(CheckOne(file, line).violations.size(), 1u) << file << " " << line;
  }
}

TEST(IncludeDirection, AllowedIncludes_PassAndAreCounted) {
  const Vector<std::pair<std::string, std::string>> cases = {
      {"runtime/solve/a.cpp", "#include \"rig/rig.h\""},
      {"runtime/skin_vulkan/a.cpp", "#include <vulkan/vulkan.h>"},
      {"editor_tools/viewer/a.cpp", "#include \"solve/pose_solver.h\""},
      {"editor_tools/cli/a.cpp", "#include \"bake/bake.h\""},
  };
  for (const auto& [file, line] : cases) {
    const IncludeReport report = CheckOne(file, line);
    EXPECT_EQ(report.num_files, 1) << file;
    EXPECT_EQ(report.num_includes, 1) << file;
    EXPECT_TRUE(report.violations.empty()) << Joined(report.violations);
  }
}

TEST(FileLength, EverySource_StaysBelow600Lines) {
  int num_files = 0;
  for (const char* part : {"runtime", "editor_tools", "shaders", "content", "tests"}) {
    for (const fs::path& file : SourcesBelow(fs::path(LIMBER_SOURCE_DIR) / part,
                                             {".h", ".hpp", ".c", ".cpp", ".comp", ".vert", ".frag",
                                              ".glsl", ".py", ".js", ".mjs", ".sh"})) {
      std::ifstream stream(file);
      const auto num_lines = std::count(std::istreambuf_iterator<char>(stream), {}, '\n');
      EXPECT_LT(num_lines, 600) << file;
      ++num_files;
    }
  }
  EXPECT_GT(num_files, 60) << "the test looked at hardly any file";
}

}  // namespace
}  // namespace limber::test
