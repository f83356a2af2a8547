// Changes a glTF's JSON and binary data without touching the rest of the file: nulls, empty
// objects, unknown extensions and extras survive (tinygltf would lose them).
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace limber::bake {

class GltfPatch {
 public:
  // Starts from a copy of `file`. All buffers become one, and images that lie beside the file or in
  // data URIs move into it, so that the result needs no other file; indices of accessors,
  // bufferViews and images stay. Errors, beginning with the file's name: kUnsupported (compressed
  // bufferViews), and those of GltfFile::ImageBytes.
  static Result<GltfPatch> Begin(const GltfFile& file);
  GltfPatch(GltfPatch&&) noexcept;
  GltfPatch& operator=(GltfPatch&&) noexcept;
  ~GltfPatch();

  nlohmann::ordered_json& json() { return *json_; }

  // Takes accessors out of the file with the data that only they use. Those that something else
  // still refers to stay, so unlink them first. Their numbers are given to new accessors.
  void RemoveAccessors(const Vector<size_t>& accessors);

  // Appends numbers as an accessor of `components` floats an element (1: SCALAR, 4: VEC4); returns
  // its index. `vertex_attribute` says what the bufferView is for.
  size_t AddFloats(const std::string& name, std::span<const float> numbers, int components,
                   bool vertex_attribute);

  // Appends bytes as a SCALAR accessor of unsigned bytes that is no vertex attribute; returns its
  // index.
  size_t AddBytes(const std::string& name, std::span<const uint8_t> bytes);

  // Appends vectors, three numbers each, as a VEC3 accessor of vertex data; returns its index. For
  // POSITION glTF demands the least and the largest number of each axis: `with_bounds`.
  size_t AddVectors(const std::string& name, std::span<const float> numbers, bool with_bounds);

  // The same of `count` zero vectors, with bounds, which take no bytes in the file.
  size_t AddZeroVectors(const std::string& name, size_t count);

  // Closes gaps and returns the whole file as a GLB, or as a .gltf with its data inside. Errors:
  // kLimitExceeded; without a file's name.
  Result<Vector<uint8_t>> Finish(bool as_glb);

 private:
  GltfPatch();
  Status GatherBuffers(const GltfFile& file);
  Status EmbedImages(const GltfFile& file);
  size_t AddBufferView(std::span<const uint8_t> bytes, int target);
  size_t AddAccessor(nlohmann::ordered_json accessor);
  bool IsAccessorUsed(size_t accessor) const;
  bool IsBufferViewUsed(size_t view) const;
  void RemoveBytes(const Vector<size_t>& views);
  void FillGaps();

  std::unique_ptr<nlohmann::ordered_json> json_;
  Vector<uint8_t> bin_;
  Vector<size_t> free_accessors_, free_views_;  // descending, so that the lowest goes first
};

}  // namespace limber::bake
