#include "viewer/gltf_bytes.h"

#include "core/vector.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

namespace limber::viewer {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 31;
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

Result<Vector<uint8_t>> ReadFile(const std::filesystem::path& path) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) {
    return Error(StatusCode::kNotFound, "%s: %s", path.string().c_str(), error.message().c_str());
  }
  if (size > kMaxFileBytes) {
    return Error(StatusCode::kLimitExceeded, "%s: larger than 2 GiB", path.string().c_str());
  }
  Vector<uint8_t> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    return Error(StatusCode::kIoError, "%s: cannot be read", path.string().c_str());
  }
  return bytes;
}

uint32_t Word(const Vector<uint8_t>& bytes, size_t offset) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, 4);
  return word;
}

// Non-negative integer, or -1.
int64_t Count(const Json& object, const char* key, int64_t otherwise) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_integer()) return -1;
  return std::max<int64_t>(-1, found->get<int64_t>());
}

int Base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

Vector<uint8_t> DecodeBase64(const char* text, size_t length) {
  Vector<uint8_t> bytes;
  uint32_t bits = 0;
  int num_bits = 0;
  for (size_t i = 0; i < length; ++i) {
    const int digit = Base64Digit(text[i]);
    if (digit < 0) continue;  // padding
    bits = bits << 6 | static_cast<uint32_t>(digit);
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> num_bits));
  }
  return bytes;
}

std::string DecodePercent(const std::string& uri) {
  std::string name;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(uri[i + 1]) != 0 &&
        std::isxdigit(uri[i + 2]) != 0) {
      name.push_back(static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)));
      i += 2;
    } else {
      name.push_back(uri[i]);
    }
  }
  return name;
}

// A file's place must lie inside the glTF's folder.
bool IsConfined(const std::filesystem::path& relative) {
  return !relative.empty() && relative.is_relative() &&
         std::none_of(relative.begin(), relative.end(),
                      [](const std::filesystem::path& part) { return part == ".."; });
}

}  // namespace

Result<GltfBytes> GltfBytes::Open(const std::filesystem::path& path) {
  Result<Vector<uint8_t>> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  GltfBytes file;
  file.path_ = path;
  size_t json_begin = 0, json_size = bytes->size();
  if (bytes->size() >= 20 && Word(*bytes, 0) == kGlbMagic) {
    json_begin = 20;
    json_size = Word(*bytes, 12);
    if (Word(*bytes, 16) != kJsonChunk || json_size > bytes->size() - json_begin) {
      return Error(StatusCode::kMalformed, "%s: GLB: the JSON chunk is cut off",
                   path.string().c_str());
    }
    const size_t next = json_begin + json_size;
    if (bytes->size() - next >= 8 && Word(*bytes, next + 4) == kBinaryChunk) {
      const size_t size = std::min<size_t>(Word(*bytes, next), bytes->size() - next - 8);
      const auto begin = bytes->begin() + static_cast<std::ptrdiff_t>(next + 8);
      file.binary_.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
    }
  }
  const char* text = reinterpret_cast<const char*>(bytes->data()) + json_begin;
  file.json_ = Json::parse(text, text + json_size, nullptr, false);
  if (!file.json_.is_object()) {
    return Error(StatusCode::kMalformed, "%s: is not a glTF: its JSON cannot be read",
                 path.string().c_str());
  }
  return file;
}

Result<Vector<uint8_t>> GltfBytes::ReadImageBytes(const Json& image) const {
  if (image.is_object()) {
    const auto view = image.find("bufferView");
    if (view != image.end()) return ReadBufferView(*view);
    const auto uri = image.find("uri");
    if (uri != image.end() && uri->is_string()) return ReadUri(uri->get_ref<const std::string&>());
  }
  return Error(StatusCode::kMalformed, "has neither a buffer view nor a file");
}

Result<Vector<uint8_t>> GltfBytes::ReadBufferView(const Json& index) const {
  const auto views = json_.find("bufferViews");
  if (views == json_.end() || !views->is_array() || !index.is_number_integer() ||
      index.get<int64_t>() < 0 || static_cast<size_t>(index.get<int64_t>()) >= views->size()) {
    return Error(StatusCode::kMalformed, "its buffer view does not exist");
  }
  const Json& view = (*views)[static_cast<size_t>(index.get<int64_t>())];
  if (!view.is_object()) return Error(StatusCode::kMalformed, "its buffer view is no object");
  Vector<uint8_t> external;
  const Vector<uint8_t>* buffer = &binary_;
  const auto buffers = json_.find("buffers");
  const int64_t buffer_index = Count(view, "buffer", -1);
  if (buffers == json_.end() || !buffers->is_array() || buffer_index < 0 ||
      static_cast<size_t>(buffer_index) >= buffers->size()) {
    return Error(StatusCode::kMalformed, "its buffer does not exist");
  }
  const Json& entry = (*buffers)[static_cast<size_t>(buffer_index)];
  if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string()) {
    Result<Vector<uint8_t>> bytes = ReadUri(entry["uri"].get_ref<const std::string&>());
    if (!bytes.ok()) return bytes.status();
    external = std::move(*bytes);
    buffer = &external;
  }
  const int64_t offset = Count(view, "byteOffset", 0), length = Count(view, "byteLength", -1);
  const auto size = static_cast<int64_t>(buffer->size());
  if (offset < 0 || length < 0 || offset > size || length > size - offset) {
    return Error(StatusCode::kMalformed, "its buffer view reaches past the buffer");
  }
  return Vector<uint8_t>(buffer->begin() + offset, buffer->begin() + offset + length);
}

Result<Vector<uint8_t>> GltfBytes::ReadUri(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos) {
      return Error(StatusCode::kUnsupported, "its data URI is not base64");
    }
    return DecodeBase64(uri.data() + comma + 1, uri.size() - comma - 1);
  }
  const std::filesystem::path relative = DecodePercent(uri);
  if (uri.find("://") != std::string::npos || !IsConfined(relative)) {
    return Error(StatusCode::kUnsupported, "its file lies outside the glTF's folder");
  }
  return ReadFile(path_.parent_path() / relative);
}

}  // namespace limber::viewer
