#include "load/gltf_buffers.h"

#include "core/printable.h"
#include "load/file_bytes.h"
#include "load/uri.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <unordered_map>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<uint8_t>;

std::string Place(size_t buffer) {
  return "buffers[" + std::to_string(buffer) + "]";
}

// Where a URI that is no data URI leads; refused where there is no folder or it leads out of it.
Result<std::filesystem::path> FindFile(const std::string& uri,
                                       const std::filesystem::path* folder) {
  Result<std::string> path = RelativePathOfUri(uri);
  if (!path.ok()) return path.status();
  if (folder == nullptr) {
    return Error(StatusCode::kUnsupported,
                 "%s is another file, and this one came from memory; use a .glb",
                 Quoted(*path).c_str());
  }
  Result<std::filesystem::path> found = ResolveInFolder(*folder, *path);
  if (!found.ok()) return found.status().WithContext(Quoted(*path));
  return found;
}

class BufferReader {
 public:
  BufferReader(const Json& buffers, const BufferSources& sources, const GltfLimits& limits)
      : buffers_(buffers),
        sources_(sources),
        limits_(limits) {}

  Status CheckTotal() const {
    uint64_t left = limits_.max_buffer_bytes;
    for (size_t b = 0; b < buffers_.size(); ++b) {
      if (Size(b) > left) {
        return Error(StatusCode::kLimitExceeded, "%s: the buffers exceed %llu bytes together",
                     Place(b).c_str(), static_cast<unsigned long long>(limits_.max_buffer_bytes));
      }
      left -= Size(b);
    }
    return {};
  }

  Result<std::vector<Bytes>> Read() {
    FindLongest();
    read_.resize(buffers_.size());
    for (size_t b = 0; b < buffers_.size(); ++b) {
      LIMBER_RETURN_IF_ERROR(ReadOne(b).WithContext(Place(b)));
    }
    return std::move(read_);
  }

 private:
  uint64_t Size(size_t b) const { return buffers_[b]["byteLength"].get<uint64_t>(); }

  std::string Uri(size_t b) const { return buffers_[b].value("uri", ""); }

  // Of the buffers that name one file the one that declares most: it is read, the others are its
  // beginning.
  void FindLongest() {
    for (size_t b = 0; b < buffers_.size(); ++b) {
      const std::string uri = Uri(b);
      if (uri.empty() || IsDataUri(uri)) continue;
      const auto [it, is_new] = longest_.emplace(uri, b);
      if (!is_new && Size(b) > Size(it->second)) it->second = b;
    }
  }

  Status ReadOne(size_t b) {
    const std::string uri = Uri(b);
    const uint64_t size = Size(b);
    if (uri.empty()) return b == 0 ? TakeChunk(size) : Missing();
    if (IsDataUri(uri)) {
      Result<DataUri> data = DecodeDataUri(uri, limits_.max_buffer_bytes);
      if (!data.ok()) return data.status();
      if (data->bytes.size() < size) return Truncated(size, data->bytes.size());
      data->bytes.resize(size);
      read_[b] = std::move(data->bytes);
      return {};
    }
    const size_t longest = longest_.at(uri);
    if (read_[longest].empty()) {
      Result<std::filesystem::path> path = FindFile(uri, sources_.folder);
      if (!path.ok()) return path.status();
      Result<Bytes> bytes = ReadFileStart(*path, Size(longest));
      if (!bytes.ok()) return bytes.status().WithContext(Quoted(uri));
      read_[longest] = std::move(*bytes);
    }
    if (longest != b) {
      const Bytes& whole = read_[longest];
      read_[b].assign(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size));
    }
    return {};
  }

  Status TakeChunk(uint64_t size) {
    const std::span<const uint8_t> bin = sources_.bin;
    if (bin.empty()) return Missing();
    if (bin.size() < size) return Truncated(size, bin.size());
    read_[0].assign(bin.begin(), bin.begin() + static_cast<ptrdiff_t>(size));
    return {};
  }

  static Status Missing() {
    return Error(StatusCode::kMalformed, "it has neither a URI nor a binary chunk");
  }

  static Status Truncated(uint64_t declared, size_t found) {
    return Error(StatusCode::kMalformed,
                 "%llu bytes are declared and %zu are there; the file is truncated",
                 static_cast<unsigned long long>(declared), found);
  }

  const Json& buffers_;
  const BufferSources& sources_;
  const GltfLimits& limits_;
  std::unordered_map<std::string, size_t> longest_;
  std::vector<Bytes> read_;
};

}  // namespace

Result<std::vector<Bytes>> ReadGltfBuffers(const Json& root, const BufferSources& sources,
                                           const GltfLimits& limits) {
  const auto buffers = root.find("buffers");
  if (buffers == root.end()) return std::vector<Bytes>();
  BufferReader reader(*buffers, sources, limits);
  LIMBER_RETURN_IF_ERROR(reader.CheckTotal());
  return reader.Read();
}

Result<Bytes> ReadUri(const std::string& uri, const std::filesystem::path* folder,
                      uint64_t max_bytes) {
  if (IsDataUri(uri)) {
    Result<DataUri> data = DecodeDataUri(uri, max_bytes);
    if (!data.ok()) return data.status();
    return std::move(data->bytes);
  }
  Result<std::filesystem::path> path = FindFile(uri, folder);
  if (!path.ok()) return path.status();
  Result<Bytes> bytes = ReadFileBytes(*path, max_bytes);
  if (!bytes.ok()) return bytes.status().WithContext(Quoted(uri));
  return bytes;
}

}  // namespace limber
