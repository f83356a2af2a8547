// Edge groups come back from a baked file as they were written, or it is said what is wrong.
#include "inspect/vertex_groups.h"

#include "bake/write_baked.h"
#include "core/vector.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "load/rig_loader.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

namespace limber::inspect {
namespace {

class VertexGroups : public ::testing::Test {
 protected:
  void SetUp() override {
    source_ = test::WriteRichSource(folder_.path());  // two primitives, a seam
    auto raw = bake::ImportGltf(source_, {});
    ASSERT_TRUE(raw.ok()) << raw.status().message();
    raw_ = std::move(*raw);
    baked_ = test::MakeSyntheticBake(raw_, {});
    num_groups_ = baked_.tables.num_groups;
    for (uint32_t v = 0; v < baked_.mesh.num_solve_vertices; ++v)
      baked_.vertex_groups.push_back(static_cast<int>(v * 5 + 1) % num_groups_);
  }

  // Writes the bake and reads its groups back.
  Result<Vector<int>> WriteAndRead() {
    const auto path = folder_.path() / "baked.glb";
    const Status written = bake::WriteBaked(source_, raw_, baked_, path);
    if (!written.ok()) return written;
    auto file = GltfFile::Open(path.string());
    if (!file.ok()) return file.status();
    auto rig = LoadRig(*file, {});
    if (!rig.ok()) return rig.status();
    return ReadVertexGroups(*file, raw_.mesh, **rig);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path source_;
  bake::RawCharacter raw_;
  bake::BakedCharacter baked_;
  int num_groups_ = 0;
};

TEST_F(VertexGroups, ComeBackAsWritten) {
  const auto read = WriteAndRead();
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(*read, baked_.vertex_groups);
}

TEST_F(VertexGroups, ThatAreNotThere_AreNamed) {
  baked_.vertex_groups.clear();
  const auto read = WriteAndRead();
  ASSERT_EQ(read.status().code(), StatusCode::kNotFound) << read.status().message();
  EXPECT_NE(read.status().message().find("bake it again"), std::string::npos);
}

TEST_F(VertexGroups, BeyondTheirNumber_AreRefused_WhileTheRigLoads) {
  for (const int wrong : {num_groups_, -1}) {
    baked_.vertex_groups.back() = wrong;
    const auto read = WriteAndRead();
    ASSERT_EQ(read.status().code(), StatusCode::kMalformed) << read.status().message();
    EXPECT_NE(read.status().message().find("_LIMBER_GROUP"), std::string::npos);
  }
}

}  // namespace
}  // namespace limber::inspect
