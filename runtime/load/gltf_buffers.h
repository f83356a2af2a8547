// The bytes of a glTF's buffers, from wherever its JSON says that they are.
#pragma once

#include "core/status.h"
#include "load/gltf_limits.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace limber {

struct BufferSources {
  std::span<const uint8_t> bin;                   // the binary chunk of a GLB, or empty
  const std::filesystem::path* folder = nullptr;  // of the glTF; null when it came from memory
};

// All buffers of a checked root (CheckGltfStructure), each of exactly its declared byteLength. What
// they declare is counted against max_buffer_bytes before anything is read; of another file only
// the declared bytes are read, and once for all buffers of one URI. Errors, beginning with the
// buffer: kMalformed (shorter than declared), kNotFound, kIoError, kUnsupported (a URI or a link
// that leads out of the folder), kLimitExceeded.
Result<std::vector<std::vector<uint8_t>>> ReadGltfBuffers(const nlohmann::ordered_json& root,
                                                          const BufferSources& sources,
                                                          const GltfLimits& limits);

// The bytes that one URI of an image stands for: a data URI, or a file under the folder of at most
// max_bytes. Errors as above, without a place.
Result<std::vector<uint8_t>> ReadUri(const std::string& uri, const std::filesystem::path* folder,
                                     uint64_t max_bytes);

}  // namespace limber
