// The shipped files are what the generator makes, to the last bit of geometry and of each pixel.
#include "editor_tools/content/shipped_glb.h"
#include "generate/dragonlet.h"
#include "generate/fox.h"
#include "generate/square.h"
#include "generate/write_glb.h"

#include <gtest/gtest.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STB_IMAGE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace limber::content {
namespace {

// A file apart from how its picture happens to be compressed, which is up to the PNG library.
struct Content {
  nlohmann::json json;
  std::vector<uint8_t> geometry, pixels;
};

Content Take(const std::vector<uint8_t>& bytes) {
  const Glb glb(bytes);
  Content content{glb.json, {}, {}};
  const size_t picture = glb.json["images"][0]["bufferView"];
  auto& view = content.json["bufferViews"][picture];
  const size_t start = view["byteOffset"], size = view["byteLength"];
  content.geometry.assign(glb.binary.begin(), glb.binary.begin() + start);
  view.erase("byteLength");
  content.json["buffers"][0].erase("byteLength");
  int width = 0, height = 0, channels = 0;
  uint8_t* pixels = stbi_load_from_memory(&glb.binary[start], static_cast<int>(size), &width,
                                          &height, &channels, 4);
  if (pixels == nullptr) throw std::runtime_error("the picture cannot be decoded");
  content.pixels.assign(pixels, pixels + 4 * static_cast<size_t>(width) * height);
  stbi_image_free(pixels);
  return content;
}

void ExpectShipped(const Character& character, const std::string& drag) {
  const Content made = Take(WriteGlb(character));
  const Content shipped = Take(ReadBytes(Shipped(character.name + ".glb")));
  EXPECT_EQ(made.json, shipped.json);
  EXPECT_TRUE(made.geometry == shipped.geometry);
  EXPECT_TRUE(made.pixels == shipped.pixels);
  EXPECT_FALSE(made.pixels.empty());
  const std::vector<uint8_t> text = ReadBytes(Shipped(character.name + "_drag.json"));
  EXPECT_TRUE(drag == std::string(text.begin(), text.end()));
}

TEST(Content, Dragonlet_IsWhatTheGeneratorMakes) {
  const Character dragonlet = MakeDragonlet();
  ExpectShipped(dragonlet, MakeDragonletDrag(dragonlet));
}

TEST(Content, Fox_IsWhatTheGeneratorMakes) {
  const Character fox = MakeFox();
  ExpectShipped(fox, MakeFoxDrag(fox));
}

TEST(Content, Square_IsWhatTheGeneratorMakes) {
  const Character square = MakeSquare();
  ExpectShipped(square, MakeSquareDrag(square));
}

}  // namespace
}  // namespace limber::content
