// Reads the shipped characters back, just far enough to look at them.
#pragma once

#include "generate/character.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace limber::content {

inline std::vector<uint8_t> ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::filesystem::path Shipped(const std::string& file) {
  return std::filesystem::path(LIMBER_SOURCE_DIR) / "content/characters" / file;
}

// A binary glTF taken apart. Files from this repository only: a bad one throws.
struct Glb {
  nlohmann::json json;
  std::vector<uint8_t> binary;

  explicit Glb(const std::vector<uint8_t>& bytes) {
    const uint32_t length = Word(bytes, 12);
    json = nlohmann::json::parse(bytes.begin() + 20, bytes.begin() + 20 + length);
    const uint32_t body = Word(bytes, 20 + length);
    binary.assign(bytes.begin() + 28 + length, bytes.begin() + 28 + length + body);
  }

  static uint32_t Word(const std::vector<uint8_t>& bytes, size_t at) {
    uint32_t word = 0;
    if (at + 4 > bytes.size()) throw std::runtime_error("truncated");
    std::memcpy(&word, &bytes[at], 4);
    return word;
  }

  const uint8_t* AccessorData(int accessor) const {
    const auto& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<size_t>()];
    return &binary.at(view.at("byteOffset").get<size_t>());
  }

  std::vector<Vector3d> Vectors(int accessor) const {
    const size_t count = json["accessors"][accessor]["count"];
    std::vector<float> floats(3 * count);
    std::memcpy(floats.data(), AccessorData(accessor), 12 * count);
    std::vector<Vector3d> vectors;
    for (size_t i = 0; i < count; ++i) {
      vectors.emplace_back(floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]);
    }
    return vectors;
  }

  std::vector<uint32_t> Indices(int accessor) const {
    std::vector<uint16_t> narrow(json["accessors"][accessor]["count"].get<size_t>());
    std::memcpy(narrow.data(), AccessorData(accessor), 2 * narrow.size());
    return {narrow.begin(), narrow.end()};
  }
};

// The geometry of a shipped file: shapes, primitives and handles (named, at a vertex).
inline Character ReadShipped(const std::string& name) {
  const Glb glb(ReadBytes(Shipped(name + ".glb")));
  const auto& mesh = glb.json.at("meshes")[0];
  Character character;
  character.name = mesh.at("name");
  character.shapes = {{"rest", {}}};
  for (const auto& target : mesh.at("extras").at("targetNames")) {
    character.shapes.push_back({target, {}});
  }
  for (const auto& json : mesh.at("primitives")) {
    const std::vector<Vector3d> rest = glb.Vectors(json["attributes"]["POSITION"]);
    Primitive primitive;
    primitive.first_vertex = static_cast<uint32_t>(character.shapes[0].positions.size());
    primitive.num_vertices = static_cast<uint32_t>(rest.size());
    primitive.triangles = glb.Indices(json["indices"]);
    character.primitives.push_back(primitive);
    for (size_t s = 0; s < character.shapes.size(); ++s) {
      std::vector<Vector3d> shape = rest;
      if (s > 0) {
        const std::vector<Vector3d> offset = glb.Vectors(json["targets"][s - 1]["POSITION"]);
        for (size_t v = 0; v < shape.size(); ++v)
          shape[v] += offset.at(v);
      }
      auto& all = character.shapes[s].positions;
      all.insert(all.end(), shape.begin(), shape.end());
    }
  }
  return character;
}

}  // namespace limber::content
