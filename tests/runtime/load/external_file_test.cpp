// The files that a glTF names: how much of them is read, and from where.
#include "load/gltf_file.h"
#include "runtime/load/small_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A folder "own" with a small glTF's data in it, inside another folder that is none of its
// business.
class ExternalFiles : public ::testing::Test {
 protected:
  ExternalFiles() {
    fs::create_directory(own_);
    Write(own_ / "data.bin", data_);
    Write(outer_.path() / "secret.bin", data_);
    Write(outer_.path() / "secret.png", "a picture");
  }

  static void Write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  Result<GltfFile> Open(const GltfLimits& limits = {}) {
    Write(own_ / "thing.gltf", gltf_.json.dump());
    return GltfFile::Open(own_ / "thing.gltf", limits);
  }

  Result<GltfFile> OpenWithUri(const std::string& uri) {
    gltf_.json["buffers"][0]["uri"] = uri;
    return Open();
  }

  // Appends a buffer that nothing uses.
  void AddBuffer(const std::string& uri, uint64_t bytes) {
    gltf_.json["buffers"].push_back({{"byteLength", bytes}, {"uri", uri}});
  }

  const TemporaryFolder outer_;
  const fs::path own_ = outer_.path() / "own";
  SmallGltf gltf_;
  const std::string data_{gltf_.bin.begin(), gltf_.bin.end()};
};

TEST_F(ExternalFiles, OnlyTheDeclaredBytes_AreRead) {
  // Sparse: no disk holds it. Were it read whole, the limit on all buffers would refuse it.
  fs::resize_file(own_ / "data.bin", 1ull << 36);
  const auto file = OpenWithUri("data.bin");
  ASSERT_TRUE(file.ok()) << file.status().message();
  EXPECT_EQ(file->BufferBytes(0).size(), data_.size());
}

TEST_F(ExternalFiles, ShorterThanDeclared_IsMalformed) {
  fs::resize_file(own_ / "data.bin", data_.size() - 1);
  const Status status = OpenWithUri("data.bin").status();
  EXPECT_EQ(status.code(), StatusCode::kMalformed);
  EXPECT_NE(status.message().find("buffers[0]: "), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("truncated"), std::string::npos) << status.message();
}

TEST_F(ExternalFiles, TotalAboveTheLimit_IsRefusedBeforeAnythingIsRead) {
  gltf_.json["buffers"][0]["uri"] = "is not there.bin";
  AddBuffer("data.bin", 100);
  GltfLimits limits;
  limits.max_buffer_bytes = data_.size() + 99;
  EXPECT_EQ(Open(limits).status().code(), StatusCode::kLimitExceeded);
  limits.max_buffer_bytes += 1;
  EXPECT_EQ(Open(limits).status().code(), StatusCode::kNotFound);
}

TEST_F(ExternalFiles, BuffersOfOneFile_AreEachItsBeginning) {
  gltf_.json["buffers"][0]["uri"] = "data.bin";
  for (const uint64_t size : {uint64_t{1}, uint64_t{data_.size()}, uint64_t{7}, uint64_t{90}})
    AddBuffer("data.bin", std::min<uint64_t>(size, data_.size()));
  Write(own_ / "data.bin", data_ + "and more that nobody declares");
  AddBuffer("data.bin", data_.size() + 8);
  const auto file = Open();
  ASSERT_TRUE(file.ok()) << file.status().message();
  for (size_t b = 0; b < gltf_.json["buffers"].size(); ++b) {
    const auto bytes = file->BufferBytes(static_cast<int64_t>(b));
    const std::string found(bytes.begin(), bytes.end());
    EXPECT_EQ(found.size(), gltf_.json["buffers"][b]["byteLength"].get<size_t>());
    EXPECT_EQ(found, (data_ + "and more").substr(0, found.size())) << b;
  }
}

TEST_F(ExternalFiles, LinksThatLeaveTheFolder_AreRefused) {
  fs::create_symlink(outer_.path() / "secret.bin", own_ / "link.bin");
  fs::create_symlink("../secret.bin", own_ / "relative.bin");
  fs::create_symlink("link.bin", own_ / "twice.bin");
  fs::create_directory_symlink(outer_.path(), own_ / "up");
  for (const std::string uri : {"link.bin", "relative.bin", "twice.bin", "up/secret.bin",
                                "l%69nk.bin", "u%70/secret%2Ebin", "up%2Fsecret.bin"}) {
    const Status status = OpenWithUri(uri).status();
    EXPECT_EQ(status.code(), StatusCode::kUnsupported) << uri << ": " << status.message();
    EXPECT_NE(status.message().find("leads out"), std::string::npos) << status.message();
  }
  gltf_.json["images"] = {{{"uri", "up/secret.png"}}};
  const auto file = OpenWithUri("data.bin");
  ASSERT_TRUE(file.ok()) << file.status().message();
  EXPECT_EQ(file->ImageBytes(0).status().code(), StatusCode::kUnsupported);
}

TEST_F(ExternalFiles, LinksThatStay_AreFollowed) {
  fs::create_directory(own_ / "deep");
  Write(own_ / "deep" / "picture.png", "own picture");
  fs::create_symlink("../data.bin", own_ / "deep" / "link.bin");
  gltf_.json["images"] = {{{"uri", "deep/picture.png"}}};
  const auto file = OpenWithUri("deep/l%69nk.bin");
  ASSERT_TRUE(file.ok()) << file.status().message();
  EXPECT_TRUE(file->ImageBytes(0).ok());
  // The character's folder itself may be anywhere.
  fs::create_directory_symlink(own_, outer_.path() / "elsewhere");
  EXPECT_TRUE(GltfFile::Open(outer_.path() / "elsewhere" / "thing.gltf").ok());
}

TEST_F(ExternalFiles, LinkCyclesAndFolders_AreNoFiles) {
  fs::create_symlink("b.bin", own_ / "a.bin");
  fs::create_symlink("a.bin", own_ / "b.bin");
  fs::create_directory(own_ / "deep");
  for (const char* uri : {"a.bin", "deep", "data.bin/x", "dangling.bin"})
    EXPECT_FALSE(OpenWithUri(uri).ok()) << uri;
}

// A sibling folder whose name begins like the own one is another folder.
TEST_F(ExternalFiles, FoldersAreComparedByWholeNames) {
  fs::create_directory(outer_.path() / "own2");
  Write(outer_.path() / "own2" / "data.bin", data_);
  fs::create_symlink("../own2/data.bin", own_ / "link.bin");
  EXPECT_EQ(OpenWithUri("link.bin").status().code(), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace limber::test
