// Outputs appear whole or not at all.
#include "cli/output.h"

#include "cli/obj_text.h"
#include "core/vector.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;

std::string Read(const fs::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

bool Empty(const fs::path& folder) {
  return fs::directory_iterator(folder) == fs::directory_iterator();
}

TEST(OutputFolder, NeverPublished_RemovesWhatItMade) {
  const test::TemporaryFolder folder;
  {
    auto output = OutputFolder::Create(folder.path() / "a" / "b" / "");
    ASSERT_TRUE(output.ok()) << output.status().message();
    ASSERT_TRUE(output->Write("file", "text").ok());
  }
  EXPECT_TRUE(Empty(folder.path()));
}

TEST(OutputFolder, NeverPublished_KeepsWhatWasThere) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "old";
  {
    auto output = OutputFolder::Create(folder.path());
    ASSERT_TRUE(output.ok());
    ASSERT_TRUE(output->Write("file", "new").ok());
    EXPECT_EQ(Read(folder.path() / "file"), "old");
  }
  EXPECT_EQ(Read(folder.path() / "file"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(OutputFolder, Published_HoldsAllFilesAndNoStaging) {
  const test::TemporaryFolder folder;
  const fs::path made = folder.path() / "made";
  {
    auto output = OutputFolder::Create(made);
    ASSERT_TRUE(output.ok());
    ASSERT_TRUE(output->Write("one", "1").ok());
    ASSERT_TRUE(output->Write("two", "2").ok());
    ASSERT_TRUE(output->Publish().ok());
  }
  EXPECT_EQ(Read(made / "one") + Read(made / "two"), "12");
  EXPECT_EQ(std::distance(fs::directory_iterator(made), {}), 2);
}

TEST(OutputFolder, OverAFile_FailsAndNamesIt) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "text";
  for (const char* name : {"file", "file/below"}) {
    const auto output = OutputFolder::Create(folder.path() / name);
    ASSERT_FALSE(output.ok()) << name;
    EXPECT_EQ(output.status().code(), StatusCode::kIoError);
    EXPECT_NE(output.status().message().find("file"), std::string::npos);
  }
  EXPECT_EQ(Read(folder.path() / "file"), "text");
}

TEST(ObjText, SeamVertices_CollapseToTheSourceOrder) {
  // Two triangles over four source vertices; source vertex 2 is split into draw vertices 1 and 3.
  SkinMesh mesh;
  mesh.num_draw_vertices = 5;
  mesh.num_source_vertices = 4;
  mesh.source_vertex = {3, 2, 0, 2, 1};
  mesh.solve_vertex = {0, 1, 2, 1, 3};
  mesh.triangles = {0, 1, 2, 3, 4, 2};
  const Vector<Vec3> solve = {{30, 0, 0}, {20, 0, 0}, {0.1f, 0, 0}, {10, 0, 0}};
  // The source knew them as one quad, and had a fifth vertex that nothing uses.
  const bake::SourceFaces faces = {5, {4}, {3, 2, 1, 0}};
  EXPECT_EQ(ObjText(mesh, faces, solve),
            "v 0.100000001 0 0\nv 10 0 0\nv 20 0 0\nv 30 0 0\nv 0 0 0\nf 4 3 2 1\n");
}

}  // namespace
}  // namespace limber::cli
