// The Khronos validator's own corpus of broken and valid files: none may crash the reader.
#include "load/gltf_file.h"
#include "load/gltf_mesh.h"
#include "load/rig_loader.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

TEST(Corpus, EveryValidatorFile_GivesAStatus) {
  const fs::path data = SharedDataFolder();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  int opened = 0, refused = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data / "gltf_validator")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    const auto file = GltfFile::Open(entry.path());
    if (!file.ok()) {
      ++refused;
      EXPECT_EQ(file.status().message().rfind(entry.path().string() + ": ", 0), 0u)
          << file.status().message();
      EXPECT_EQ(file.status().message().find('\n'), std::string::npos) << "one line";
      continue;
    }
    ++opened;
    EXPECT_FALSE(LoadRig(*file).ok()) << "none of them is baked";
    for (int mesh = 0; mesh < 3; ++mesh)
      (void)ReadMorphMesh(*file, mesh);
  }
  EXPECT_GT(opened, 20);
  EXPECT_GT(refused, 40);
}

}  // namespace
}  // namespace limber::test
