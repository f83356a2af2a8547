#include "load/uri.h"

#include "core/out_of_memory.h"
#include "core/printable.h"

#include <array>

namespace limber {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Malformed escapes stay as they are: they are then a file name that does not exist.
std::string PercentDecode(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && HexDigit(text[i + 1]) >= 0 &&
        HexDigit(text[i + 2]) >= 0) {
      decoded += static_cast<char>(HexDigit(text[i + 1]) * 16 + HexDigit(text[i + 2]));
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

bool HasParentSegment(std::string_view path) {
  while (true) {
    const size_t slash = path.find('/');
    if (path.substr(0, slash) == "..") return true;
    if (slash == std::string_view::npos) return false;
    path.remove_prefix(slash + 1);
  }
}

Result<std::vector<uint8_t>> DecodeBase64(std::string_view text) {
  constexpr uint8_t kNoDigit = 64;
  std::array<uint8_t, 256> value;
  value.fill(kNoDigit);
  for (size_t i = 0; i < kAlphabet.size(); ++i) {
    value[static_cast<uint8_t>(kAlphabet[i])] = static_cast<uint8_t>(i);
  }
  for (int pad = 0; pad < 2 && !text.empty() && text.back() == '='; ++pad)
    text.remove_suffix(1);
  if (text.size() % 4 == 1) {
    return Error(StatusCode::kMalformed, "base64 of %zu digits cannot be whole bytes", text.size());
  }
  std::vector<uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0;
  int num_bits = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const uint8_t digit = value[static_cast<uint8_t>(text[i])];
    if (digit == kNoDigit) {
      return Error(StatusCode::kMalformed, "character %zu of the content is not base64", i);
    }
    bits = (bits << 6 | uint32_t{digit}) & 0xFFFFFF;
    num_bits += 6;
    if (num_bits >= 8) {
      num_bits -= 8;
      bytes.push_back(static_cast<uint8_t>(bits >> num_bits));
    }
  }
  return bytes;
}

}  // namespace

bool IsDataUri(std::string_view uri) {
  return uri.substr(0, 5) == "data:";
}

Result<std::string> RelativePathOfUri(std::string_view uri) {
  const std::string shown = Quoted(uri);
  const std::string path = PercentDecode(uri);
  if (path.empty() || path.find('\0') != std::string::npos) {
    return Error(StatusCode::kMalformed, "the URI %s names no file", shown.c_str());
  }
  // A colon before the first slash is a scheme or a drive letter.
  if (path.front() == '/' || path.find('\\') != std::string::npos ||
      path.substr(0, path.find('/')).find(':') != std::string::npos || HasParentSegment(path)) {
    return Error(StatusCode::kUnsupported,
                 "the URI %s leads out of the file's own folder; put the file beside the glTF "
                 "and name it there, or export as one .glb",
                 shown.c_str());
  }
  return path;
}

Result<DataUri> DecodeDataUri(std::string_view uri, uint64_t max_bytes) {
  const size_t comma = uri.find(',');
  if (!IsDataUri(uri) || comma == std::string_view::npos) {
    return Error(StatusCode::kMalformed, "not a data URI");
  }
  const std::string_view header = uri.substr(5, comma - 5);
  constexpr std::string_view kBase64 = ";base64";
  if (header.size() < kBase64.size() || header.substr(header.size() - kBase64.size()) != kBase64) {
    return Error(StatusCode::kUnsupported, "a data URI that is not base64");
  }
  const std::string_view content = uri.substr(comma + 1);
  if (content.size() / 4 * 3 > max_bytes + 3) {
    return Error(StatusCode::kLimitExceeded, "the data URI holds more than %llu bytes",
                 static_cast<unsigned long long>(max_bytes));
  }
  return CatchOutOfMemory("data URI", [&]() -> Result<DataUri> {
    Result<std::vector<uint8_t>> bytes = DecodeBase64(content);
    if (!bytes.ok()) return bytes.status().WithContext("data URI");
    DataUri result;
    result.mime_type = header.substr(0, header.find(';'));
    result.bytes = std::move(*bytes);
    return result;
  });
}

std::string EncodeBase64(std::span<const uint8_t> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t left = bytes.size() - i;
    const uint32_t bits = static_cast<uint32_t>(bytes[i]) << 16 |
                          (left > 1 ? static_cast<uint32_t>(bytes[i + 1]) << 8 : 0u) |
                          (left > 2 ? static_cast<uint32_t>(bytes[i + 2]) : 0u);
    text += kAlphabet[bits >> 18];
    text += kAlphabet[bits >> 12 & 63];
    text += left > 1 ? kAlphabet[bits >> 6 & 63] : '=';
    text += left > 2 ? kAlphabet[bits & 63] : '=';
  }
  return text;
}

}  // namespace limber
