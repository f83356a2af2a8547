#include "gltf_edit/gltf_patch.h"

#include "core/vector.h"
#include "import/file_output.h"
#include "load/uri.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <vector>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kArrayBuffer = 34962;  // GL's number for vertex data
constexpr int kUnsignedByte = 5121, kFloat = 5126;
constexpr size_t kNoSize = 0;

size_t Size(const Json& json, const char* section) {
  const auto it = json.find(section);
  return it == json.end() || !it->is_array() ? kNoSize : it->size();
}

void PadToFour(Vector<uint8_t>* bytes) {
  bytes->resize((bytes->size() + 3) / 4 * 4, 0);
}

// Empty for contents that are no image glTF knows.
std::string SniffImageType(std::span<const uint8_t> bytes) {
  const auto starts_with = [&](std::initializer_list<uint8_t> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with({0x89, 'P', 'N', 'G'})) return "image/png";
  if (starts_with({0xFF, 0xD8, 0xFF})) return "image/jpeg";
  if (starts_with({'R', 'I', 'F', 'F'})) return "image/webp";
  if (starts_with({0xAB, 'K', 'T', 'X', ' ', '2', '0'})) return "image/ktx2";
  return {};
}

std::span<const uint8_t> BytesOf(std::span<const float> numbers) {
  static_assert(sizeof(float) == 4, "glTF's floats");
  return {reinterpret_cast<const uint8_t*>(numbers.data()), numbers.size_bytes()};
}

bool HasMember(const Json& object, const char* key, size_t value) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number_unsigned() && it->get<size_t>() == value;
}

// Whether any value of an object is that number: attributes and morph targets.
bool HasValue(const Json& object, size_t value) {
  return std::any_of(object.begin(), object.end(), [value](const Json& item) {
    return item.is_number_unsigned() && item.get<size_t>() == value;
  });
}

bool AnyOf(const Json& parent, const char* section, const std::function<bool(const Json&)>& test) {
  const auto it = parent.find(section);
  if (it == parent.end() || !it->is_array()) return false;
  return std::any_of(it->begin(), it->end(),
                     [&](const Json& item) { return item.is_object() && test(item); });
}

}  // namespace

GltfPatch::GltfPatch() : json_(std::make_unique<Json>()) {}

GltfPatch::GltfPatch(GltfPatch&&) noexcept = default;
GltfPatch& GltfPatch::operator=(GltfPatch&&) noexcept = default;
GltfPatch::~GltfPatch() = default;

Result<GltfPatch> GltfPatch::Begin(const GltfFile& file) {
  GltfPatch patch;
  *patch.json_ = file.json();
  LIMBER_RETURN_IF_ERROR(patch.GatherBuffers(file).WithContext(file.name()));
  LIMBER_RETURN_IF_ERROR(patch.EmbedImages(file));
  return patch;
}

Status GltfPatch::GatherBuffers(const GltfFile& file) {
  Vector<size_t> offsets;
  for (size_t b = 0; b < Size(*json_, "buffers"); ++b) {
    PadToFour(&bin_);
    offsets.push_back(bin_.size());
    const std::span<const uint8_t> bytes = file.BufferBytes(static_cast<int64_t>(b));
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
  }
  for (size_t v = 0; v < Size(*json_, "bufferViews"); ++v) {
    Json& view = (*json_)["bufferViews"][v];
    if (view.contains("extensions") && !view["extensions"].empty()) {
      return Error(StatusCode::kUnsupported,
                   "bufferViews[%zu]: it is compressed; remove the compression with: npx "
                   "@gltf-transform/cli copy IN.glb OUT.glb",
                   v);
    }
    const size_t offset = offsets[view["buffer"].get<size_t>()];
    if (offset > 0) view["byteOffset"] = view.value("byteOffset", size_t{0}) + offset;
    view["buffer"] = 0;
  }
  Json buffer = offsets.empty() ? Json::object() : (*json_)["buffers"][0];
  buffer.erase("uri");
  (*json_)["buffers"] = Json::array({std::move(buffer)});
  PadToFour(&bin_);
  return {};
}

Status GltfPatch::EmbedImages(const GltfFile& file) {
  for (size_t i = 0; i < Size(*json_, "images"); ++i) {
    Json& image = (*json_)["images"][i];
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (!image.is_object() || uri == image.end() || !uri->is_string()) continue;
    Result<std::vector<uint8_t>> bytes = file.ImageBytes(static_cast<int64_t>(i));
    if (!bytes.ok()) return bytes.status();
    const std::string type = SniffImageType(*bytes);
    if (type.empty()) {
      return Error(StatusCode::kUnsupported,
                   "%s: images[%zu]: it is neither PNG, JPEG, WebP nor KTX2; convert it",
                   file.name().c_str(), i);
    }
    image.erase("uri");
    image["mimeType"] = type;
    image["bufferView"] = AddBufferView(*bytes, 0);
  }
  return {};
}

bool GltfPatch::IsAccessorUsed(size_t accessor) const {
  const auto in_primitive = [accessor](const Json& primitive) {
    const auto attributes = primitive.find("attributes");
    const auto targets = primitive.find("targets");
    return HasMember(primitive, "indices", accessor) ||
           (attributes != primitive.end() && HasValue(*attributes, accessor)) ||
           (targets != primitive.end() &&
            std::any_of(targets->begin(), targets->end(),
                        [accessor](const Json& target) { return HasValue(target, accessor); }));
  };
  const auto in_rig = [accessor](const Json& rig) {
    const auto tables = rig.find("tables");
    return tables != rig.end() && tables->is_object() &&
           std::any_of(tables->begin(), tables->end(), [accessor](const Json& table) {
             return table.is_object() && HasMember(table, "accessor", accessor);
           });
  };
  const auto extensions = json_->find("extensions");
  const auto own = extensions == json_->end() ? json_->end() : extensions->find(kRigExtensionName);
  const bool in_rigs = extensions != json_->end() && own != extensions->end() && own->is_object() &&
                       AnyOf(*own, "rigs", in_rig);
  return in_rigs ||
         AnyOf(*json_, "meshes",
               [&](const Json& mesh) { return AnyOf(mesh, "primitives", in_primitive); }) ||
         AnyOf(
             *json_, "skins",
             [&](const Json& skin) { return HasMember(skin, "inverseBindMatrices", accessor); }) ||
         AnyOf(*json_, "animations", [&](const Json& animation) {
           return AnyOf(animation, "samplers", [&](const Json& sampler) {
             return HasMember(sampler, "input", accessor) || HasMember(sampler, "output", accessor);
           });
         });
}

bool GltfPatch::IsBufferViewUsed(size_t view) const {
  const auto refers = [view](const Json& item) { return HasMember(item, "bufferView", view); };
  return AnyOf(*json_, "images", refers) || AnyOf(*json_, "accessors", [&](const Json& accessor) {
           const auto sparse = accessor.find("sparse");
           const bool in_sparse = sparse != accessor.end() && sparse->is_object() &&
                                  (refers((*sparse)["indices"]) || refers((*sparse)["values"]));
           return refers(accessor) || in_sparse;
         });
}

void GltfPatch::RemoveAccessors(const Vector<size_t>& accessors) {
  Vector<size_t> views;
  for (const size_t accessor : accessors) {
    if (accessor >= Size(*json_, "accessors") || IsAccessorUsed(accessor)) continue;
    if (std::count(free_accessors_.begin(), free_accessors_.end(), accessor) > 0) continue;
    Json& entry = (*json_)["accessors"][accessor];
    const auto view = entry.find("bufferView");
    if (view != entry.end()) views.push_back(view->get<size_t>());
    // A valid accessor for as long as the number is free: one zero.
    entry = {{"componentType", kFloat}, {"count", 1}, {"type", "SCALAR"}};
    free_accessors_.push_back(accessor);
  }
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  std::erase_if(views, [this](size_t view) { return IsBufferViewUsed(view); });
  RemoveBytes(views);
  free_views_.insert(free_views_.end(), views.begin(), views.end());
  std::sort(free_accessors_.rbegin(), free_accessors_.rend());
  std::sort(free_views_.rbegin(), free_views_.rend());
}

// Cuts the views' bytes out of the binary data, unless another view overlaps them.
void GltfPatch::RemoveBytes(const Vector<size_t>& views) {
  struct Range {
    size_t begin, end;
  };

  Json& all = (*json_)["bufferViews"];
  const auto range_of = [&](size_t view) {
    const size_t begin = all[view].value("byteOffset", size_t{0});
    return Range{begin, begin + all[view]["byteLength"].get<size_t>()};
  };
  Vector<Range> cuts;
  for (const size_t view : views) {
    Range cut = range_of(view);
    // Only whole words, so that what follows stays aligned; padding goes with its view.
    cut.end = std::min((cut.end + 3) / 4 * 4, bin_.size());
    bool shared = cut.begin % 4 != 0;
    for (size_t other = 0; other < all.size() && !shared; ++other) {
      const Range range = range_of(other);
      shared = std::find(views.begin(), views.end(), other) == views.end() &&
               range.begin < cut.end && cut.begin < range.end;
    }
    if (!shared) cuts.push_back(cut);
  }
  std::sort(cuts.begin(), cuts.end(),
            [](const Range& a, const Range& b) { return a.begin > b.begin; });
  size_t last_begin = bin_.size();
  for (Range cut : cuts) {  // from the back, so that earlier offsets stay valid
    cut.end = std::min(cut.end, last_begin);
    last_begin = cut.begin;
    if (cut.end <= cut.begin) continue;
    bin_.erase(bin_.begin() + static_cast<ptrdiff_t>(cut.begin),
               bin_.begin() + static_cast<ptrdiff_t>(cut.end));
    for (Json& view : all) {
      const size_t begin = view.value("byteOffset", size_t{0});
      if (begin >= cut.end) view["byteOffset"] = begin - (cut.end - cut.begin);
    }
  }
  for (const size_t view : views)
    all[view] = Json::object();
}

size_t GltfPatch::AddBufferView(std::span<const uint8_t> bytes, int target) {
  PadToFour(&bin_);
  Json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
  if (target != 0) view["target"] = target;
  bin_.insert(bin_.end(), bytes.begin(), bytes.end());
  if (!json_->contains("bufferViews")) (*json_)["bufferViews"] = Json::array();
  if (free_views_.empty()) {
    (*json_)["bufferViews"].push_back(std::move(view));
    return (*json_)["bufferViews"].size() - 1;
  }
  const size_t index = free_views_.back();
  free_views_.pop_back();
  (*json_)["bufferViews"][index] = std::move(view);
  return index;
}

size_t GltfPatch::AddAccessor(Json accessor) {
  if (!json_->contains("accessors")) (*json_)["accessors"] = Json::array();
  if (free_accessors_.empty()) {
    (*json_)["accessors"].push_back(std::move(accessor));
    return (*json_)["accessors"].size() - 1;
  }
  const size_t index = free_accessors_.back();
  free_accessors_.pop_back();
  (*json_)["accessors"][index] = std::move(accessor);
  return index;
}

size_t GltfPatch::AddFloats(const std::string& name, std::span<const float> numbers, int components,
                            bool vertex_attribute) {
  const int target = vertex_attribute ? kArrayBuffer : 0;
  return AddAccessor({{"name", name},
                      {"bufferView", AddBufferView(BytesOf(numbers), target)},
                      {"componentType", kFloat},
                      {"count", numbers.size() / static_cast<size_t>(components)},
                      {"type", components == 4 ? "VEC4" : "SCALAR"}});
}

size_t GltfPatch::AddBytes(const std::string& name, std::span<const uint8_t> bytes) {
  return AddAccessor({{"name", name},
                      {"bufferView", AddBufferView(bytes, 0)},
                      {"componentType", kUnsignedByte},
                      {"count", bytes.size()},
                      {"type", "SCALAR"}});
}

size_t GltfPatch::AddVectors(const std::string& name, std::span<const float> numbers,
                             bool with_bounds) {
  Json accessor = {{"name", name},
                   {"bufferView", AddBufferView(BytesOf(numbers), kArrayBuffer)},
                   {"componentType", kFloat},
                   {"count", numbers.size() / 3},
                   {"type", "VEC3"}};
  if (with_bounds && numbers.size() >= 3) {
    std::array<float, 3> low = {numbers[0], numbers[1], numbers[2]}, high = low;
    for (size_t i = 0; i < numbers.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], numbers[i]);
      high[i % 3] = std::max(high[i % 3], numbers[i]);
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }
  return AddAccessor(std::move(accessor));
}

size_t GltfPatch::AddZeroVectors(const std::string& name, size_t count) {
  return AddAccessor({{"name", name},
                      {"componentType", kFloat},
                      {"count", count},
                      {"type", "VEC3"},
                      {"min", {0.0, 0.0, 0.0}},
                      {"max", {0.0, 0.0, 0.0}}});
}

// Numbers that were freed and not needed again: dropped at the end of their list; in its middle a
// placeholder keeps the later numbers what they are.
void GltfPatch::FillGaps() {
  for (const size_t accessor : free_accessors_) {  // descending
    if (accessor + 1 == (*json_)["accessors"].size()) (*json_)["accessors"].erase(accessor);
  }
  for (const size_t view : free_views_) {
    Json& views = (*json_)["bufferViews"];
    if (view + 1 == views.size()) {
      views.erase(view);
    } else {
      views[view] = {{"buffer", 0}, {"byteLength", 1}};
    }
  }
  free_accessors_.clear();
  free_views_.clear();
}

Result<Vector<uint8_t>> GltfPatch::Finish(bool as_glb) {
  FillGaps();
  PadToFour(&bin_);
  const uint64_t most = GltfLimits().max_buffer_bytes;
  if (bin_.size() > most) {
    return Error(StatusCode::kLimitExceeded,
                 "%zu bytes of data, the limit is %llu; bake with fewer handles or shapes",
                 bin_.size(), static_cast<unsigned long long>(most));
  }
  (*json_)["buffers"][0]["byteLength"] = bin_.size();
  try {
    if (as_glb) return AssembleGlb(json_->dump(), bin_);
    (*json_)["buffers"][0]["uri"] = "data:application/octet-stream;base64," + EncodeBase64(bin_);
    const std::string text = json_->dump(2) + "\n";
    return Vector<uint8_t>(text.begin(), text.end());
  } catch (const std::exception& error) {
    return Status(StatusCode::kInternal, std::string("JSON: ") + error.what());
  }
}

}  // namespace limber::bake
