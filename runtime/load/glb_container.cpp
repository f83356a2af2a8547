#include "load/glb_container.h"

namespace limber {
namespace {

constexpr uint64_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

uint32_t ReadU32(std::span<const uint8_t> bytes, uint64_t offset) {
  return static_cast<uint32_t>(bytes[offset]) | static_cast<uint32_t>(bytes[offset + 1]) << 8 |
         static_cast<uint32_t>(bytes[offset + 2]) << 16 |
         static_cast<uint32_t>(bytes[offset + 3]) << 24;
}

}  // namespace

bool IsGlb(std::span<const uint8_t> bytes) {
  return bytes.size() >= 4 && ReadU32(bytes, 0) == kGlbMagic;
}

Result<GlbChunks> SplitGlb(std::span<const uint8_t> bytes) {
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
    return Error(StatusCode::kMalformed,
                 "GLB header: the file ends after %zu bytes; it is truncated, copy it again",
                 bytes.size());
  }
  if (!IsGlb(bytes)) {
    return Error(StatusCode::kMalformed, "GLB header: no magic number; this is not a GLB file");
  }
  if (const uint32_t version = ReadU32(bytes, 4); version != 2) {
    return Error(StatusCode::kUnsupported,
                 "GLB header: container version %u; export it as glTF 2.0", version);
  }
  const uint64_t length = ReadU32(bytes, 8);
  if (length > bytes.size()) {
    return Error(StatusCode::kMalformed,
                 "GLB header: %llu bytes are declared and %zu are there; the file is truncated, "
                 "copy it again",
                 static_cast<unsigned long long>(length), bytes.size());
  }
  GlbChunks chunks;
  uint64_t offset = kHeaderBytes;
  for (int index = 0; offset < length; ++index) {
    if (length - offset < kChunkHeaderBytes) {
      return Error(StatusCode::kMalformed, "GLB chunk %d: its header is truncated", index);
    }
    const uint64_t chunk_bytes = ReadU32(bytes, offset);
    const uint32_t type = ReadU32(bytes, offset + 4);
    offset += kChunkHeaderBytes;
    if (chunk_bytes > length - offset) {
      return Error(StatusCode::kMalformed,
                   "GLB chunk %d: %llu bytes are declared and %llu are left; the file is damaged",
                   index, static_cast<unsigned long long>(chunk_bytes),
                   static_cast<unsigned long long>(length - offset));
    }
    const auto content = bytes.subspan(offset, chunk_bytes);
    if (index == 0) {
      if (type != kGlbJsonChunk || chunk_bytes == 0) {
        return Error(StatusCode::kMalformed, "GLB chunk 0: it is not a JSON chunk with content");
      }
      chunks.json = {reinterpret_cast<const char*>(content.data()), content.size()};
    } else if (index == 1 && type == kGlbBinChunk) {
      chunks.bin = content;
    } else if (type == kGlbJsonChunk || type == kGlbBinChunk) {
      return Error(StatusCode::kMalformed, "GLB chunk %d: a second or misplaced %s chunk", index,
                   type == kGlbJsonChunk ? "JSON" : "BIN");
    }
    offset += chunk_bytes;
  }
  if (chunks.json.empty()) return Error(StatusCode::kMalformed, "GLB: no JSON chunk");
  return chunks;
}

}  // namespace limber
