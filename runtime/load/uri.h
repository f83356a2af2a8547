// URIs inside a glTF file, which is hostile until checked: where they may point, and data URIs.
#pragma once

#include "core/status.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limber {

bool IsDataUri(std::string_view uri);

// The path, relative to the glTF's own folder, that a URI stands for, percent-decoded. Refused with
// kUnsupported: absolute paths, other schemes (http:, file:), backslashes, and every ".." segment,
// so that a file can name nothing outside its own folder (links: file_bytes.h).
Result<std::string> RelativePathOfUri(std::string_view uri);

struct DataUri {
  std::string mime_type;
  std::vector<uint8_t> bytes;
};

// Decodes "data:<type>;base64,<content>". Errors: kMalformed, kUnsupported (not base64),
// kLimitExceeded (the content is longer than max_bytes), kOutOfMemory.
Result<DataUri> DecodeDataUri(std::string_view uri, uint64_t max_bytes);

// Base64 with padding (RFC 4648).
std::string EncodeBase64(std::span<const uint8_t> bytes);

}  // namespace limber
