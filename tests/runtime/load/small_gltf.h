// Small glTFs put together in code, good and bad.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <initializer_list>
#include <string>

namespace limber::test {

// A triangle with one morph target, all data in one buffer; parts are then bent at will.
class SmallGltf {
 public:
  SmallGltf();

  nlohmann::ordered_json json;
  Vector<uint8_t> bin;

  // Appends bytes as a bufferView, an accessor over one; each returns its index.
  template <class T>
  size_t AddView(std::initializer_list<T> items, size_t stride = 0) {
    const Vector<T> copy(items);
    return AddBytes(copy.data(), copy.size() * sizeof(T), stride);
  }

  size_t AddAccessor(const nlohmann::ordered_json& accessor);

  std::string Text() const;  // a .gltf with its data inside
  Vector<uint8_t> Glb() const;
  Result<GltfFile> Parse() const;  // of the text

 private:
  size_t AddBytes(const void* data, size_t size, size_t stride);
};

Result<GltfFile> ParseText(const std::string& text);

}  // namespace limber::test
