#include "viewer/image.h"

#include "core/vector.h"
#include "support/temporary_folder.h"
#include "viewer/texture.h"

#include <gtest/gtest.h>

#include <fstream>

namespace limber::viewer {
namespace {

Image Gradient(uint32_t width, uint32_t height) {
  Image image;
  image.width = width;
  image.height = height;
  for (uint32_t i = 0; i < width * height; ++i) {
    for (uint32_t c = 0; c < 4; ++c)
      image.rgba.push_back(static_cast<uint8_t>(37 * i + 91 * c));
  }
  return image;
}

TEST(Png, RoundTrip_KeepsEveryByte) {
  const test::TemporaryFolder folder;
  const Image image = Gradient(17, 9);
  ASSERT_TRUE(WritePng(folder.path() / "a.png", image).ok());
  const Result<Image> back = ReadPng(folder.path() / "a.png");
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back->width, 17u);
  EXPECT_EQ(back->rgba, image.rgba);
  // Nothing but the picture is left.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Png, FolderThatDoesNotExist_IsAnIoErrorThatNamesIt) {
  const Status status = WritePng("/nonexistent/folder/a.png", Gradient(2, 2));
  EXPECT_EQ(status.code(), StatusCode::kIoError);
  EXPECT_NE(status.message().find("/nonexistent/folder/a.png"), std::string::npos);
}

TEST(Png, SizeThatDoesNotFit_IsRefused) {
  Image image = Gradient(4, 4);
  image.height = 5;
  EXPECT_EQ(WritePng("/tmp/never.png", image).code(), StatusCode::kInvalidArgument);
}

TEST(Png, TruncatedFile_IsMalformed) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.png";
  ASSERT_TRUE(WritePng(path, Gradient(64, 64)).ok());
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_EQ(ReadPng(path).status().code(), StatusCode::kMalformed);
  std::filesystem::resize_file(path, 3);
  EXPECT_EQ(ReadPng(path).status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ReadPng(folder.path() / "b.png").status().code(), StatusCode::kNotFound);
}

TEST(DecodeImage, PngInMemory_IsDecodedAndHostileOnesAreNot) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.png";
  const Image image = Gradient(5, 3);
  ASSERT_TRUE(WritePng(path, image).ok());
  std::ifstream file(path, std::ios::binary);
  Vector<uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
  ASSERT_TRUE(DecodeImage(bytes).ok());
  EXPECT_EQ(DecodeImage(bytes)->rgba, image.rgba);
  // A header that promises 65,536 pixels a side.
  Vector<uint8_t> bomb = bytes;
  bomb[17] = 1;
  EXPECT_FALSE(DecodeImage(bomb).ok());
  bytes.resize(bytes.size() / 2);
  EXPECT_FALSE(DecodeImage(bytes).ok());
  EXPECT_EQ(DecodeImage({}).status().code(), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace limber::viewer
