#include "load/uri.h"

#include "core/vector.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

TEST(Uri, InsideTheFolder_IsDecoded) {
  EXPECT_EQ(*RelativePathOfUri("data.bin"), "data.bin");
  EXPECT_EQ(*RelativePathOfUri("a/b%20c/%C3%A4.bin"), "a/b c/\xC3\xA4.bin");
  EXPECT_EQ(*RelativePathOfUri("..a/b..bin"), "..a/b..bin");
  EXPECT_EQ(*RelativePathOfUri("50%.bin"), "50%.bin");
}

TEST(Uri, OutsideTheFolder_IsRefused) {
  for (const char* uri :
       {"../x", "a/../../x", "a/..", "%2e%2e/x", "..%2Fx", "/etc/passwd", "%2Fetc/passwd",
        "file:///etc/passwd", "http://x/y", "C:x", "a\\..\\x", "", "a%00b"}) {
    EXPECT_FALSE(RelativePathOfUri(uri).ok()) << uri;
  }
}

TEST(Uri, Base64_ComesBackForEveryLength) {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 20; ++i) {
    const auto data = DecodeDataUri("data:a/b;base64," + EncodeBase64(bytes), 100);
    ASSERT_TRUE(data.ok());
    EXPECT_EQ(data->bytes, bytes);
    EXPECT_EQ(data->mime_type, "a/b");
    bytes.push_back(static_cast<uint8_t>(255 - 37 * i));
  }
  EXPECT_EQ(EncodeBase64(std::vector<uint8_t>{'M', 'a'}), "TWE=");
}

TEST(Uri, BadDataUris_AreRefused) {
  for (const char* uri : {"data:", "data:a/b,xx", "data:;base64,*", "data:;base64,AAAAA", "x"}) {
    EXPECT_FALSE(DecodeDataUri(uri, 100).ok()) << uri;
  }
  EXPECT_EQ(DecodeDataUri("data:;base64,AAAAAAAAAAAA", 4).status().code(),
            StatusCode::kLimitExceeded);
}

}  // namespace
}  // namespace limber::test
