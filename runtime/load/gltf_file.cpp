#include "load/gltf_file.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "load/file_bytes.h"
#include "load/glb_container.h"
#include "load/gltf_buffers.h"
#include "load/gltf_guard.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <new>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

// tinygltf is handed the buffers under these names and can open no file at all.
constexpr char kBufferName[] = "limber-buffer-";
constexpr size_t kLongestReason = 200;  // of tinygltf's own words in a message

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

// NOLINTNEXTLINE(readability-function-size): tinygltf's signature
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

}  // namespace

GltfFile::GltfFile() = default;
GltfFile::GltfFile(GltfFile&&) noexcept = default;
GltfFile& GltfFile::operator=(GltfFile&&) noexcept = default;
GltfFile::~GltfFile() = default;

Result<GltfFile> GltfFile::Open(const std::filesystem::path& path, const GltfLimits& limits) {
  const std::string name = path.string();
  return CatchOutOfMemory(name, [&]() -> Result<GltfFile> {
    Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, limits.max_file_bytes);
    if (!bytes.ok()) return bytes.status().WithContext(name);
    GltfFile file;
    file.name_ = name;
    file.folder_ = path.parent_path();
    file.has_folder_ = true;
    file.limits_ = limits;
    LIMBER_RETURN_IF_ERROR(file.Load(*bytes).WithContext(name));
    return file;
  });
}

Result<GltfFile> GltfFile::Parse(std::span<const uint8_t> bytes, const std::string& name,
                                 const GltfLimits& limits) {
  if (bytes.size() > limits.max_file_bytes) {
    return Error(StatusCode::kLimitExceeded, "%s: %zu bytes, the limit is %llu", name.c_str(),
                 bytes.size(), static_cast<unsigned long long>(limits.max_file_bytes));
  }
  return CatchOutOfMemory(name, [&]() -> Result<GltfFile> {
    GltfFile file;
    file.name_ = name;
    file.limits_ = limits;
    LIMBER_RETURN_IF_ERROR(file.Load(bytes).WithContext(name));
    return file;
  });
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
  const BufferSources sources{chunks.bin, has_folder_ ? &folder_ : nullptr};
  Result<std::vector<std::vector<uint8_t>>> buffers = ReadGltfBuffers(*json_, sources, limits_);
  if (!buffers.ok()) return buffers.status();
  return ParseModel(std::move(*buffers));
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
      return Status(StatusCode::kMalformed,
                    "glTF: " + Printable(error.substr(0, error.find('\n')), kLongestReason));
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
  } catch (const std::bad_alloc&) {
    throw;  // no fault of the file; Open and Parse turn it into a Status
  } catch (const std::exception& error) {
    return Status(StatusCode::kMalformed, "glTF: " + Printable(error.what(), kLongestReason));
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
  return CatchOutOfMemory(name_, [&]() -> Result<std::vector<uint8_t>> {
    const std::string place = name_ + ": images[" + std::to_string(image) + "]";
    const auto images = json_->find("images");
    if (images == json_->end() || !images->is_array() || image < 0 ||
        image >= static_cast<int64_t>(images->size())) {
      return Status(StatusCode::kInvalidArgument, place + ": there is no such image");
    }
    Result<std::vector<uint8_t>> bytes = ReadImage((*images)[static_cast<size_t>(image)]);
    if (!bytes.ok()) return bytes.status().WithContext(place);
    return bytes;
  });
}

Result<std::vector<uint8_t>> GltfFile::ReadImage(const Json& image) const {
  if (!image.is_object()) return Error(StatusCode::kMalformed, "it is not an object");
  const auto view = image.find("bufferView");
  if (view != image.end() && view->is_number_unsigned()) {
    const std::span<const uint8_t> bytes = BufferViewBytes(view->get<int64_t>());
    if (bytes.empty()) return Error(StatusCode::kMalformed, "no such bufferView");
    return std::vector<uint8_t>(bytes.begin(), bytes.end());
  }
  const auto uri = image.find("uri");
  if (uri == image.end() || !uri->is_string()) {
    return Error(StatusCode::kMalformed, "it has neither a bufferView nor a URI");
  }
  return ReadUri(uri->get_ref<const std::string&>(), has_folder_ ? &folder_ : nullptr,
                 limits_.max_file_bytes);
}

}  // namespace limber
