// The JSON of a glTF and the bytes of its images. Nothing in the file is trusted.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>

namespace limber::viewer {

// NOLINTNEXTLINE(bugprone-exception-escape): looks into json's own move, which is noexcept
class GltfBytes {
 public:
  // Errors: kNotFound, kMalformed, kLimitExceeded (over 2 GiB).
  static Result<GltfBytes> Open(const std::filesystem::path& path);

  const nlohmann::json& json() const { return json_; }

  // The encoded bytes of one element of "images": from a buffer view of the binary chunk or of the
  // first buffer's file, a data URI, or a file inside the glTF's own folder.
  Result<Vector<uint8_t>> ReadImageBytes(const nlohmann::json& image) const;

 private:
  Result<Vector<uint8_t>> ReadBufferView(const nlohmann::json& index) const;
  Result<Vector<uint8_t>> ReadUri(const std::string& uri) const;

  std::filesystem::path path_;
  nlohmann::json json_;
  Vector<uint8_t> binary_;
};

}  // namespace limber::viewer
