// What the README says is so: its code compiles and runs, its links lead somewhere.
#include "bake/bake.h"
#include "bake/write_baked.h"
#include "import/import_gltf.h"
#include "load/rig_loader.h"
#include "readme_library.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

const fs::path kTop = LIMBER_SOURCE_DIR;

std::string Read(const fs::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// What stands between two marks, without blank lines around it; empty where a mark is missing.
std::string Between(const std::string& text, const std::string& begin, const std::string& end) {
  const size_t from = text.find(begin);
  if (from == std::string::npos) return "";
  const size_t to = text.find(end, from + begin.size());
  if (to == std::string::npos) return "";
  const std::string inner = text.substr(from + begin.size(), to - from - begin.size());
  const size_t first = inner.find_first_not_of('\n');
  return first == std::string::npos ? ""
                                    : inner.substr(first, inner.find_last_not_of('\n') - first + 1);
}

// The shipped square, baked into `folder`.
fs::path BakeSquare(const fs::path& folder) {
  const fs::path source = kTop / "content/characters/square.glb";
  const auto raw = bake::ImportGltf(source);
  EXPECT_TRUE(raw.ok()) << raw.status().message();
  if (!raw.ok()) return {};
  const auto baked = bake::Bake(*raw, raw->marked_handles, {}, nullptr);
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  if (!baked.ok()) return {};
  const Status written = bake::WriteBaked(source, *raw, *baked, folder / "square_baked.glb");
  EXPECT_TRUE(written.ok()) << written.message();
  return folder / "square_baked.glb";
}

TEST(Readme, LibraryLines_AreTheCompiledOnes) {
  const std::string in_readme = Between(Read(kTop / "README.md"), "```cpp\n", "```");
  const std::string compiled =
      Between(Read(kTop / "tests/pipeline/readme_library.cpp"), "// [the README's lines begin]\n",
              "// [the README's lines end]");
  ASSERT_FALSE(compiled.empty());
  EXPECT_EQ(in_readme, compiled);
}

// The consumer of the installed package compiles and runs them.
TEST(Readme, LinesForEngines_AreTheCompiledOnes) {
  const std::string in_readme = Between(Read(kTop / "README.md"), "```c\n", "```");
  const std::string compiled =
      Between(Read(kTop / "tests/runtime/package/consumer/frame.h"),
              "/* [the README's lines begin] */\n", "\n/* [the README's lines end] */");
  ASSERT_FALSE(compiled.empty());
  EXPECT_EQ(in_readme, compiled);
}

// The consumer compiles them, tests/runtime/host runs them.
TEST(Readme, LinesForVulkanRenderers_AreTheCompiledOnes) {
  const std::string readme = Read(kTop / "README.md");
  const std::string in_readme =
      Between(readme.substr(readme.find("### Into an existing Vulkan renderer")), "```c\n", "```");
  const std::string compiled =
      Between(Read(kTop / "tests/runtime/package/consumer/frame_vulkan.h"),
              "/* [the README's lines begin] */\n", "\n/* [the README's lines end] */");
  ASSERT_FALSE(compiled.empty());
  EXPECT_EQ(in_readme, compiled);
}

TEST(Readme, LibraryLines_RaiseTheHandle) {
  const TemporaryFolder folder;
  const fs::path baked = BakeSquare(folder.path());
  const auto rig = LoadRig(baked);
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  const RigHandle& last = (*rig)->tables().handles.back();
  int num_frames = 0;
  Vec3 position;
  const Status status =
      RaiseHandle(baked.c_str(), last.name.c_str(), [&](const DeformedMesh& mesh) {
        ++num_frames;
        position = mesh.solve_positions[last.vertex];
      });
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(num_frames, 60);
  // 60 steps of 0.5 % of the size, and the skin is where its handle was put.
  const float size = (*rig)->diagonal();
  EXPECT_NEAR(position.x, last.rest_position.x, 1e-4f * size);
  EXPECT_NEAR(position.y, last.rest_position.y + 0.3f * size, 1e-4f * size);
}

TEST(Readme, RelativeLinks_LeadToFiles) {
  int num_links = 0;
  for (const char* page : {"README.md", "CONTRIBUTING.md", "THIRD_PARTY.md", "CHANGELOG.md"}) {
    const std::string text = Read(kTop / page);
    const std::regex link(R"(\]\(([^)#]+)\))");
    for (std::sregex_iterator i(text.begin(), text.end(), link), end; i != end; ++i) {
      const std::string target = (*i)[1].str();
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(kTop / target)) << page << " links to " << target;
      ++num_links;
    }
  }
  EXPECT_GT(num_links, 5);
}

TEST(Readme, FoldersOfContributing_Exist) {
  const std::string text = Read(kTop / "CONTRIBUTING.md");
  const std::regex folder(R"(`((runtime|editor_tools|tests|shaders|content)/[a-zA-Z_/.]*)`)");
  int num_folders = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), folder), end; i != end; ++i) {
    EXPECT_TRUE(fs::exists(kTop / (*i)[1].str())) << (*i)[1].str();
    ++num_folders;
  }
  EXPECT_GT(num_folders, 15);
}

}  // namespace
}  // namespace limber::test
