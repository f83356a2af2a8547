#include "look.h"

#include <OgreDataStream.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace {

struct Glb {
  nlohmann::json json;
  std::string binary;
};

std::string ReadFile(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

// A header of 12 bytes, then chunks: length, kind, content. The first is JSON, the second binary.
Glb ReadGlb(const std::string& file) {
  const std::string bytes = ReadFile(file);
  std::string chunks[2];
  size_t at = 12;
  for (std::string& chunk : chunks) {
    uint32_t length = 0;
    if (at + 8 > bytes.size()) throw std::runtime_error(file + ": not a .glb of two chunks");
    std::memcpy(&length, &bytes[at], sizeof length);
    chunk = bytes.substr(at + 8, length);
    at += 8 + size_t{length};
  }
  return {nlohmann::json::parse(chunks[0]), chunks[1]};
}

Ogre::Image DecodeImage(const Glb& glb, const nlohmann::json& image) {
  const nlohmann::json& view = glb.json.at("bufferViews").at(image.at("bufferView").get<size_t>());
  std::string bytes =
      glb.binary.substr(view.value("byteOffset", size_t{0}), view.at("byteLength").get<size_t>());
  const Ogre::DataStreamPtr stream(
      new Ogre::MemoryDataStream(bytes.data(), bytes.size(), false, true));
  Ogre::Image decoded;
  decoded.load(stream, image.at("mimeType") == "image/png" ? "png" : "jpg");
  return decoded;
}

}  // namespace

Look ReadLook(const std::string& glb_file) {
  const Glb glb = ReadGlb(glb_file);
  Look look;
  look.colours = DecodeImage(glb, glb.json.at("images").at(0));
  for (const nlohmann::json& material : glb.json.at("materials")) {
    look.roughness.push_back(material.at("pbrMetallicRoughness").value("roughnessFactor", 1.0f));
  }
  return look;
}
