#include "load/gltf_file.h"

#include "load/glb_container.h"
#include "load/gltf_guard.h"
#include "load/uri.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <fstream>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

// tinygltf is handed the buffers under these names and can open no file at all.
constexpr char kBufferName[] = "limber-buffer-";

struct BufferStore {
  std::vector<std::vector<uint8_t>>* buffers = nullptr;

  std::vector<uint8_t>* Find(const std::string& name) const {
    const std::string prefix = kBufferName;
    if (name.compare(0, prefix.size(), prefix) != 0) return nullptr;
    const size_t index = std::strtoull(name.c_str() + prefix.size(), nullptr, 10);
    return index < buffers->size() ? &(*buffers)[index] : nullptr;
  }
};

bool StoreHas(const std::string& name, void* store) {
  return static_cast<BufferStore*>(store)->Find(name) != nullptr;
}

std::string SameName(const std::string& name, void* /*store*/) {
  return name;
}

bool TakeFromStore(std::vector<unsigned char>* out, std::string* /*error*/, const std::string& name,
                   void* store) {
  std::vector<uint8_t>* bytes = static_cast<BufferStore*>(store)->Find(name);
  if (bytes == nullptr) return false;
  *out = std::move(*bytes);
  return true;
}

bool RefuseToWrite(std::string* /*error*/, const std::string& /*name*/,
                   const std::vector<unsigned char>& /*bytes*/, void* /*store*/) {
  return false;
}

bool IgnoreImage(tinygltf::Image* /*image*/, const int /*index*/, std::string* /*error*/,
                 std::string* /*warning*/, int /*width*/, int /*height*/,
                 const unsigned char* /*bytes*/, int /*size*/, void* /*user*/) {
  return true;
}

// The part of the JSON that Limber has tinygltf read, without whatever it reads lossily or trusts.
Json ReducedJson(const Json& root) {
  Json reduced = Json::object();
  reduced["asset"] = {{"version", "2.0"}};
  for (const char* section : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes"}) {
    const auto it = root.find(section);
    if (it == root.end()) continue;
    Json& items = reduced[section] = Json::array();
    for (const Json& item : *it) {
      Json copy = Json::object();
      for (const auto& [key, value] : item.items()) {
        if (key != "extras" && key != "extensions" && key != "uri") copy[key] = value;
      }
      items.push_back(std::move(copy));
    }
  }
  if (reduced.contains("buffers")) {
    for (size_t b = 0; b < reduced["buffers"].size(); ++b) {
      reduced["buffers"][b]["uri"] = kBufferName + std::to_string(b);
    }
  }
  return reduced;
}

std::string FirstLine(const std::string& text) {
  const size_t end = text.find('\n');
  return text.substr(0, end);
}

}  // namespace

Result<std::vector<uint8_t>> ReadFileBytes(const std::filesystem::path& path, uint64_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return Error(StatusCode::kNotFound, "no such file");
  if (!std::filesystem::is_regular_file(status)) {
    return Error(StatusCode::kIoError, "not a regular file");
  }
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) return Status(StatusCode::kIoError, error.message());
  if (size > max_bytes) {
    return Error(StatusCode::kLimitExceeded, "%llu bytes, the limit is %llu",
                 static_cast<unsigned long long>(size), static_cast<unsigned long long>(max_bytes));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Error(StatusCode::kIoError, "cannot be opened; check its permissions");
  std::vector<uint8_t> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<uint64_t>(stream.gcount()) != size) {
    return Error(StatusCode::kIoError, "reading stopped after %lld of %llu bytes",
                 static_cast<long long>(stream.gcount()), static_cast<unsigned long long>(size));
  }
  return bytes;
}

GltfFile::GltfFile() = default;
GltfFile::GltfFile(GltfFile&&) noexcept = default;
GltfFile& GltfFile::operator=(GltfFile&&) noexcept = default;
GltfFile::~GltfFile() = default;

Result<GltfFile> GltfFile::Open(const std::filesystem::path& path, const GltfLimits& limits) {
  Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, limits.max_file_bytes);
  if (!bytes.ok()) return bytes.status().WithContext(path.string());
  GltfFile file;
  file.name_ = path.string();
  file.folder_ = path.parent_path();
  file.has_folder_ = true;
  file.limits_ = limits;
  LIMBER_RETURN_IF_ERROR(file.Load(*bytes).WithContext(file.name_));
  return file;
}

Result<GltfFile> GltfFile::Parse(std::span<const uint8_t> bytes, const std::string& name,
                                 const GltfLimits& limits) {
  GltfFile file;
  file.name_ = name;
  file.limits_ = limits;
  if (bytes.size() > limits.max_file_bytes) {
    return Error(StatusCode::kLimitExceeded, "%s: %zu bytes, the limit is %llu", name.c_str(),
                 bytes.size(), static_cast<unsigned long long>(limits.max_file_bytes));
  }
  LIMBER_RETURN_IF_ERROR(file.Load(bytes).WithContext(file.name_));
  return file;
}

Status GltfFile::Load(std::span<const uint8_t> bytes) {
  GlbChunks chunks;
  is_glb_ = IsGlb(bytes);
  if (is_glb_) {
    Result<GlbChunks> split = SplitGlb(bytes);
    if (!split.ok()) return split.status();
    chunks = *split;
  } else {
    chunks.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  Result<Json> json = ParseJson(chunks.json, limits_);
  if (!json.ok()) {
    const bool looks_like_json = chunks.json.find('{') != std::string_view::npos;
    return looks_like_json ? json.status()
                           : Error(StatusCode::kMalformed, "neither a GLB nor a glTF's JSON");
  }
  LIMBER_RETURN_IF_ERROR(CheckGltfStructure(*json));
  json_ = std::make_unique<Json>(std::move(*json));
  std::vector<std::vector<uint8_t>> buffers;
  LIMBER_RETURN_IF_ERROR(ReadBuffers(chunks.bin, &buffers));
  return ParseModel(std::move(buffers));
}

Status GltfFile::ReadBuffers(std::span<const uint8_t> bin,
                             std::vector<std::vector<uint8_t>>* buffers) const {
  if (!json_->contains("buffers")) return {};
  uint64_t left = limits_.max_buffer_bytes;
  for (size_t b = 0; b < (*json_)["buffers"].size(); ++b) {
    const Json& buffer = (*json_)["buffers"][b];
    const std::string place = "buffers[" + std::to_string(b) + "]";
    const auto size = buffer["byteLength"].get<uint64_t>();
    if (size > left) {
      return Error(StatusCode::kLimitExceeded, "%s: the buffers exceed %llu bytes together",
                   place.c_str(), static_cast<unsigned long long>(limits_.max_buffer_bytes));
    }
    left -= size;
    std::vector<uint8_t> bytes;
    const std::string uri = buffer.value("uri", "");
    if (uri.empty() && b == 0 && !bin.empty()) {
      bytes.assign(bin.begin(), bin.begin() + static_cast<ptrdiff_t>(std::min(size, bin.size())));
    } else if (uri.empty()) {
      return Error(StatusCode::kMalformed, "%s: it has neither a URI nor a binary chunk",
                   place.c_str());
    } else if (IsDataUri(uri)) {
      Result<DataUri> data = DecodeDataUri(uri, limits_.max_buffer_bytes);
      if (!data.ok()) return data.status().WithContext(place);
      bytes = std::move(data->bytes);
    } else {
      Result<std::string> path = RelativePathOfUri(uri);
      if (!path.ok()) return path.status().WithContext(place);
      if (!has_folder_) {
        return Error(StatusCode::kUnsupported,
                     "%s: \"%s\" is another file, and this one came from memory; use a .glb",
                     place.c_str(), path->c_str());
      }
      Result<std::vector<uint8_t>> read = ReadFileBytes(folder_ / *path, limits_.max_buffer_bytes);
      if (!read.ok()) return read.status().WithContext(place + ": " + *path);
      bytes = std::move(*read);
    }
    if (bytes.size() < size) {
      return Error(StatusCode::kMalformed,
                   "%s: %llu bytes are declared and %zu are there; the file is truncated",
                   place.c_str(), static_cast<unsigned long long>(size), bytes.size());
    }
    bytes.resize(size);
    buffers->push_back(std::move(bytes));
  }
  return {};
}

Status GltfFile::ParseModel(std::vector<std::vector<uint8_t>> buffers) {
  try {
    const std::string text = ReducedJson(*json_).dump();
    BufferStore store{&buffers};
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks({StoreHas, SameName, TakeFromStore, RefuseToWrite, &store});
    reader.SetImageLoader(IgnoreImage, nullptr);
    auto model = std::make_unique<tinygltf::Model>();
    std::string error, warning;
    const bool good = reader.LoadASCIIFromString(model.get(), &error, &warning, text.c_str(),
                                                 static_cast<unsigned int>(text.size()), "");
    if (!good || !error.empty()) {
      return Status(StatusCode::kMalformed, "glTF: " + FirstLine(error));
    }
    const auto same_count = [this](const char* section, size_t count) {
      return (json_->contains(section) ? (*json_)[section].size() : 0) == count;
    };
    if (!same_count("buffers", model->buffers.size()) ||
        !same_count("accessors", model->accessors.size()) ||
        !same_count("meshes", model->meshes.size()) || !same_count("nodes", model->nodes.size())) {
      return Error(StatusCode::kMalformed, "glTF: items that cannot be read");
    }
    model_ = std::move(model);
  } catch (const std::exception& error) {
    return Status(StatusCode::kMalformed, std::string("glTF: ") + error.what());
  }
  return {};
}

std::span<const uint8_t> GltfFile::BufferBytes(int64_t buffer) const {
  if (buffer < 0 || buffer >= static_cast<int64_t>(model_->buffers.size())) return {};
  return model_->buffers[static_cast<size_t>(buffer)].data;
}

std::span<const uint8_t> GltfFile::BufferViewBytes(int64_t buffer_view) const {
  if (buffer_view < 0 || buffer_view >= static_cast<int64_t>(model_->bufferViews.size())) return {};
  const tinygltf::BufferView& view = model_->bufferViews[static_cast<size_t>(buffer_view)];
  const std::span<const uint8_t> bytes = BufferBytes(view.buffer);
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) return {};
  return bytes.subspan(view.byteOffset, view.byteLength);
}

Result<std::vector<uint8_t>> GltfFile::ImageBytes(int64_t image) const {
  const auto images = json_->find("images");
  if (images == json_->end() || !images->is_array() || image < 0 ||
      image >= static_cast<int64_t>(images->size())) {
    return Error(StatusCode::kInvalidArgument, "%s: images[%lld]: there is no such image",
                 name_.c_str(), static_cast<long long>(image));
  }
  const Json& entry = (*images)[static_cast<size_t>(image)];
  const std::string context = name_ + ": images[" + std::to_string(image) + "]";
  const auto view = entry.is_object() ? entry.find("bufferView") : entry.end();
  if (entry.is_object() && view != entry.end() && view->is_number_unsigned()) {
    const std::span<const uint8_t> bytes = BufferViewBytes(view->get<int64_t>());
    if (bytes.empty())
      return Error(StatusCode::kMalformed, "%s: no such bufferView", context.c_str());
    return std::vector<uint8_t>(bytes.begin(), bytes.end());
  }
  const auto uri = entry.is_object() ? entry.find("uri") : entry.end();
  if (!entry.is_object() || uri == entry.end() || !uri->is_string()) {
    return Error(StatusCode::kMalformed, "%s: it has neither a bufferView nor a URI",
                 context.c_str());
  }
  const auto& text = uri->get_ref<const std::string&>();
  if (IsDataUri(text)) {
    Result<DataUri> data = DecodeDataUri(text, limits_.max_file_bytes);
    if (!data.ok()) return data.status().WithContext(context);
    return std::move(data->bytes);
  }
  Result<std::string> path = RelativePathOfUri(text);
  if (!path.ok()) return path.status().WithContext(context);
  if (!has_folder_) {
    return Error(StatusCode::kUnsupported, "%s: \"%s\" is another file", context.c_str(),
                 path->c_str());
  }
  Result<std::vector<uint8_t>> bytes = ReadFileBytes(folder_ / *path, limits_.max_file_bytes);
  if (!bytes.ok()) return bytes.status().WithContext(context + ": " + *path);
  return bytes;
}

}  // namespace limber
