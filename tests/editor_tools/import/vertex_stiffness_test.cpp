// Painted stiffness: where it is read from, and what is refused.
#include "import/vertex_stiffness.h"

#include "core/vector.h"
#include "import/import_gltf.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

// A triangle of zeros. Accessor 0: positions; 1: the floats 1, 10, 0.5; 2: a black colour.
Json Triangle(const Json& more_attributes) {
  Json attributes = {{"POSITION", 0}};
  attributes.update(more_attributes);
  const Json primitive = {{"attributes", attributes}, {"targets", {{{"POSITION", 0}}}}};
  return {
      {"asset", {{"version", "2.0"}}},
      {"nodes", {{{"mesh", 0}}}},
      {"buffers",
       {{{"byteLength", 12}, {"uri", "data:application/octet-stream;base64,AACAPwAAIEEAAAA/"}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", 12}}}},
      {"accessors",
       {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
        {{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "SCALAR"}},
        {{"componentType", 5126}, {"count", 3}, {"type", "VEC4"}},
        {{"componentType", 5126}, {"count", 3}, {"type", "SCALAR"}}}},
      {"meshes", {{{"primitives", {primitive}}}}}};
}

Result<bake::RawCharacter> Import(const Json& attributes, const std::string& asked) {
  const std::string text = Triangle(attributes).dump();
  const auto file =
      GltfFile::Parse({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "t.gltf");
  if (!file.ok()) return file.status();
  bake::ImportOptions options;
  options.stiffness = asked;
  return bake::ImportGltf(*file, options);
}

using Factors = Vector<float>;

TEST(VertexStiffness, ComesFromTheAttributeOfThatName_OrTheOneAskedFor) {
  const Factors painted = {1, 10, 0.5f};
  EXPECT_EQ(Import({{"_LIMBER_STIFFNESS", 1}}, "")->stiffness, painted);
  EXPECT_EQ(Import({{"_MINE", 1}}, "_MINE")->stiffness, painted);
  EXPECT_EQ(Import({{"_MINE", 1}}, "")->stiffness, Factors());
  EXPECT_EQ(Import(Json::object(), "")->stiffness, Factors());
}

TEST(VertexStiffness, OfAColour_IsAPowerOfAHundred) {
  const auto black = Import({{"COLOR_0", 2}}, "COLOR_0");
  ASSERT_TRUE(black.ok()) << black.status().message();
  ASSERT_EQ(black->stiffness.size(), 3u);
  for (const float factor : black->stiffness)
    EXPECT_NEAR(factor, 0.01, 1e-8);
  EXPECT_EQ(Import({{"COLOR_0", 2}}, "")->stiffness, Factors()) << "colours only where asked for";
  const auto ramp = Import({{"COLOR_0", 0}}, "COLOR_0");  // three channels do as well
  ASSERT_TRUE(ramp.ok()) << ramp.status().message();
  EXPECT_EQ(ramp->stiffness.size(), 3u);
}

void ExpectRefused(const Json& attributes, const std::string& asked, StatusCode code,
                   const Vector<const char*>& words) {
  const auto raw = Import(attributes, asked);
  ASSERT_FALSE(raw.ok());
  EXPECT_EQ(raw.status().code(), code) << raw.status().message();
  for (const char* word : words)
    EXPECT_NE(raw.status().message().find(word), std::string::npos) << raw.status().message();
}

TEST(VertexStiffness, WhatIsMissingOrOutOfRange_IsNamed) {
  ExpectRefused(Json::object(), "_MINE", StatusCode::kNotFound, {"t.gltf", "_MINE"});
  ExpectRefused(Json::object(), "COLOR_0", StatusCode::kNotFound, {"COLOR_0"});
  ExpectRefused({{"_MINE", 3}}, "_MINE", StatusCode::kMalformed,
                {"t.gltf", "_MINE", "vertex 0", "0.001 to 1000"});
  ExpectRefused({{"_LIMBER_STIFFNESS", 2}}, "", StatusCode::kMalformed, {"_LIMBER_STIFFNESS"});
}

}  // namespace
}  // namespace limber::test
