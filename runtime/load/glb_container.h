// The GLB container: a 12-byte header, a JSON chunk and an optional binary chunk.
#pragma once

#include "core/status.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace limber {

inline constexpr uint32_t kGlbMagic = 0x46546C67;      // "glTF"
inline constexpr uint32_t kGlbJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr uint32_t kGlbBinChunk = 0x004E4942;   // "BIN\0"

// Views into the caller's bytes.
struct GlbChunks {
  std::string_view json;
  std::span<const uint8_t> bin;  // empty where the file has no binary chunk
};

// Whether the bytes begin with GLB's magic number.
bool IsGlb(std::span<const uint8_t> bytes);

// Splits a GLB of version 2. Later chunks of unknown types are skipped, as the specification asks.
// Errors: kMalformed (truncated, overlong, chunks missing or in the wrong order), kUnsupported
// (another version of the container).
Result<GlbChunks> SplitGlb(std::span<const uint8_t> bytes);

}  // namespace limber
