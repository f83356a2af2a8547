// A .gltf or .glb read with a guard in front of tinygltf: sizes, nesting, indices and URIs are
// checked before anything is trusted, buffers come only from the file's own folder, and images are
// not touched.
#pragma once

#include "core/status.h"
#include "load/gltf_limits.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace limber {

class GltfFile {
 public:
  // Reads a file and the buffers beside it. Errors, each beginning with the path: kNotFound,
  // kIoError, kMalformed, kUnsupported (a required extension by name; a URI, or a symbolic link
  // that it names, that leads out of the folder), kLimitExceeded, kOutOfMemory.
  static Result<GltfFile> Open(const std::filesystem::path& path, const GltfLimits& limits = {});
  // The same from memory. `name` is for messages; there is no folder, so every buffer must be
  // inside the bytes. The bytes are copied.
  static Result<GltfFile> Parse(std::span<const uint8_t> bytes, const std::string& name,
                                const GltfLimits& limits = {});

  GltfFile(GltfFile&&) noexcept;
  GltfFile& operator=(GltfFile&&) noexcept;
  ~GltfFile();

  const std::string& name() const { return name_; }  // as given, for messages

  const GltfLimits& limits() const { return limits_; }

  bool is_glb() const { return is_glb_; }

  // The file's own JSON, complete and structurally checked (gltf_guard.h).
  const nlohmann::ordered_json& json() const { return *json_; }

  // Decoded buffers, accessors, meshes, nodes and scenes. Materials, images, animations and skins
  // are not in it: they are in json().
  const tinygltf::Model& model() const { return *model_; }

  // The bytes of a buffer, of a bufferView (both indices checked; empty when out of range).
  std::span<const uint8_t> BufferBytes(int64_t buffer) const;
  std::span<const uint8_t> BufferViewBytes(int64_t buffer_view) const;

  // The encoded bytes (PNG, JPEG) of an image, from wherever the file keeps them. Errors:
  // kInvalidArgument (no such image), and those of Open.
  Result<std::vector<uint8_t>> ImageBytes(int64_t image) const;

 private:
  GltfFile();
  Status Load(std::span<const uint8_t> bytes);
  Result<std::vector<uint8_t>> ReadImage(const nlohmann::ordered_json& image) const;
  Status ParseModel(std::vector<std::vector<uint8_t>> buffers);

  std::string name_;
  std::filesystem::path folder_;
  bool has_folder_ = false;
  bool is_glb_ = false;
  GltfLimits limits_;
  std::unique_ptr<nlohmann::ordered_json> json_;
  std::unique_ptr<tinygltf::Model> model_;
};

}  // namespace limber
