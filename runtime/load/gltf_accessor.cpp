#include "load/gltf_accessor.h"

#include "core/out_of_memory.h"
#include "core/vector.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace limber {
namespace {

// Where the elements of an accessor or of its sparse part lie; `bytes` covers all of them.
struct ElementView {
  std::span<const uint8_t> bytes;
  int64_t stride = 0;
};

int64_t ComponentBytes(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T Load(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// glTF 2.0, section 3.11: a signed normalised integer c stands for max(c / largest, -1).
template <class T>
float Normalised(const uint8_t* bytes) {
  return std::max(
      static_cast<float>(Load<T>(bytes)) / static_cast<float>(std::numeric_limits<T>::max()),
      -1.0f);
}

float LoadComponent(const uint8_t* bytes, int type, bool normalised) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalised ? Normalised<int8_t>(bytes) : static_cast<float>(Load<int8_t>(bytes));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return normalised ? Normalised<uint8_t>(bytes) : static_cast<float>(Load<uint8_t>(bytes));
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalised ? Normalised<int16_t>(bytes) : static_cast<float>(Load<int16_t>(bytes));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return normalised ? Normalised<uint16_t>(bytes) : static_cast<float>(Load<uint16_t>(bytes));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(Load<uint32_t>(bytes));
    default:
      return Load<float>(bytes);
  }
}

uint32_t LoadIndex(const uint8_t* bytes, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *bytes;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return Load<uint16_t>(bytes);
    default:
      return Load<uint32_t>(bytes);
  }
}

bool IsIndexType(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

int NumComponents(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;  // its columns are whole words for every component type: no padding
    default:
      return 0;  // smaller matrices: nothing that Limber reads
  }
}

// `count` elements of element_bytes each, beginning at `offset` within a bufferView.
Result<ElementView> ViewElements(const GltfFile& file, int buffer_view, int64_t offset,
                                 int64_t count, int64_t element_bytes) {
  const std::span<const uint8_t> bytes = file.BufferViewBytes(buffer_view);
  ElementView view;
  const auto& views = file.model().bufferViews;
  if (buffer_view < 0 || static_cast<size_t>(buffer_view) >= views.size() || bytes.empty()) {
    return Error(StatusCode::kMalformed, "bufferView %d is not in the file", buffer_view);
  }
  const auto declared = static_cast<int64_t>(views[static_cast<size_t>(buffer_view)].byteStride);
  view.stride = declared > 0 ? declared : element_bytes;
  // count, stride and offset are below 2^31 each (gltf_guard.h), so that nothing overflows.
  const int64_t end = offset + (count - 1) * view.stride + element_bytes;
  if (offset < 0 || count < 1 || view.stride < element_bytes ||
      end > static_cast<int64_t>(bytes.size())) {
    return Error(StatusCode::kMalformed,
                 "%lld elements of stride %lld end at byte %lld of bufferView %d, which has %zu",
                 static_cast<long long>(count), static_cast<long long>(view.stride),
                 static_cast<long long>(end), buffer_view, bytes.size());
  }
  view.bytes = bytes.subspan(static_cast<size_t>(offset), static_cast<size_t>(end - offset));
  return view;
}

std::string Place(const AccessorRequest& request) {
  return request.place + " (accessor " + std::to_string(request.accessor) + ")";
}

Result<const tinygltf::Accessor*> FindAccessor(const GltfFile& file,
                                               const AccessorRequest& request) {
  const auto& accessors = file.model().accessors;
  if (request.accessor < 0 || static_cast<size_t>(request.accessor) >= accessors.size()) {
    return Error(StatusCode::kMalformed, "the file has %zu accessors", accessors.size());
  }
  const tinygltf::Accessor& accessor = accessors[static_cast<size_t>(request.accessor)];
  if (NumComponents(accessor.type) != request.components ||
      ComponentBytes(accessor.componentType) == 0) {
    return Error(StatusCode::kMalformed, "%d numbers an element are wanted, it has %d",
                 request.components, NumComponents(accessor.type));
  }
  const auto count = static_cast<int64_t>(accessor.count);
  if (request.expected_count >= 0 && count != request.expected_count) {
    return Error(StatusCode::kMalformed, "it has %lld elements, expected are %lld",
                 static_cast<long long>(count), static_cast<long long>(request.expected_count));
  }
  if (accessor.bufferView < 0 && !request.may_be_implicit &&
      static_cast<uint64_t>(count) > file.limits().max_implicit_zeros) {
    return Error(StatusCode::kLimitExceeded,
                 "%lld elements without bytes in the file, the limit is %llu",
                 static_cast<long long>(count),
                 static_cast<unsigned long long>(file.limits().max_implicit_zeros));
  }
  return &accessor;
}

// Calls store(element, bytes) for each element that has bytes: first the dense ones, then those
// that the sparse part replaces.
template <class Store>
Status ForEachElement(const GltfFile& file, const tinygltf::Accessor& accessor,
                      int64_t element_bytes, Store&& store) {
  const auto count = static_cast<int64_t>(accessor.count);
  if (accessor.bufferView >= 0) {
    Result<ElementView> view = ViewElements(
        file, accessor.bufferView, static_cast<int64_t>(accessor.byteOffset), count, element_bytes);
    if (!view.ok()) return view.status();
    for (int64_t i = 0; i < count; ++i)
      store(i, view->bytes.data() + i * view->stride);
  }
  if (!accessor.sparse.isSparse) return {};
  const auto& sparse = accessor.sparse;
  if (!IsIndexType(sparse.indices.componentType)) {
    return Error(StatusCode::kMalformed, "sparse indices of component type %d",
                 sparse.indices.componentType);
  }
  if (sparse.count > count) {
    return Error(StatusCode::kMalformed, "%d sparse elements of %lld", sparse.count,
                 static_cast<long long>(count));
  }
  Result<ElementView> indices =
      ViewElements(file, sparse.indices.bufferView, sparse.indices.byteOffset, sparse.count,
                   ComponentBytes(sparse.indices.componentType));
  if (!indices.ok()) return indices.status().WithContext("sparse indices");
  Result<ElementView> values = ViewElements(file, sparse.values.bufferView,
                                            sparse.values.byteOffset, sparse.count, element_bytes);
  if (!values.ok()) return values.status().WithContext("sparse values");
  for (int64_t i = 0; i < sparse.count; ++i) {
    const uint32_t at =
        LoadIndex(indices->bytes.data() + i * indices->stride, sparse.indices.componentType);
    if (at >= count) {
      return Error(StatusCode::kMalformed,
                   "sparse index %lld is %u, the accessor has %lld elements",
                   static_cast<long long>(i), at, static_cast<long long>(count));
    }
    store(at, values->bytes.data() + i * values->stride);
  }
  return {};
}

Result<Vector<float>> DecodeFloats(const GltfFile& file, const AccessorRequest& request) {
  const Result<const tinygltf::Accessor*> found = FindAccessor(file, request);
  if (!found.ok()) return found.status();
  const tinygltf::Accessor& accessor = **found;
  const int64_t component_bytes = ComponentBytes(accessor.componentType);
  const int64_t components = request.components;
  // The bytes are there, or the zeros were allowed, before the numbers are given room.
  LIMBER_RETURN_IF_ERROR(
      ForEachElement(file, accessor, component_bytes * components, [](int64_t, const uint8_t*) {}));
  Vector<float> numbers(static_cast<size_t>(static_cast<int64_t>(accessor.count) * components));
  LIMBER_RETURN_IF_ERROR(ForEachElement(
      file, accessor, component_bytes * components, [&](int64_t element, const uint8_t* bytes) {
        for (int64_t c = 0; c < components; ++c) {
          numbers[static_cast<size_t>(element * components + c)] = LoadComponent(
              bytes + c * component_bytes, accessor.componentType, accessor.normalized);
        }
      }));
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i])) {
      return Error(StatusCode::kMalformed, "element %zu is not a finite number",
                   i / static_cast<size_t>(components));
    }
  }
  return numbers;
}

Result<Vector<uint32_t>> DecodeIndices(const GltfFile& file, const AccessorRequest& request,
                                       uint32_t bound) {
  const Result<const tinygltf::Accessor*> found = FindAccessor(file, request);
  if (!found.ok()) return found.status();
  const tinygltf::Accessor& accessor = **found;
  if (!IsIndexType(accessor.componentType)) {
    return Error(StatusCode::kMalformed, "component type %d is not an unsigned integer",
                 accessor.componentType);
  }
  const int64_t bytes_each = ComponentBytes(accessor.componentType);
  LIMBER_RETURN_IF_ERROR(
      ForEachElement(file, accessor, bytes_each, [](int64_t, const uint8_t*) {}));
  Vector<uint32_t> indices(accessor.count);
  LIMBER_RETURN_IF_ERROR(
      ForEachElement(file, accessor, bytes_each, [&](int64_t element, const uint8_t* bytes) {
        indices[static_cast<size_t>(element)] = LoadIndex(bytes, accessor.componentType);
      }));
  for (size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= bound) {
      return Error(StatusCode::kMalformed, "element %zu is %u, allowed is below %u", i, indices[i],
                   bound);
    }
  }
  return indices;
}

Result<std::span<const uint8_t>> FindBytes(const GltfFile& file, const AccessorRequest& request) {
  const Result<const tinygltf::Accessor*> found = FindAccessor(file, request);
  if (!found.ok()) return found.status();
  const tinygltf::Accessor& accessor = **found;
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || accessor.bufferView < 0 ||
      accessor.sparse.isSparse) {
    return Error(StatusCode::kMalformed, "it is not made of unsigned bytes alone");
  }
  Result<ElementView> view =
      ViewElements(file, accessor.bufferView, static_cast<int64_t>(accessor.byteOffset),
                   static_cast<int64_t>(accessor.count), 1);
  if (!view.ok()) return view.status();
  if (view->stride != 1) {
    return Error(StatusCode::kMalformed, "its bytes are %lld bytes apart",
                 static_cast<long long>(view->stride));
  }
  return view->bytes;
}

}  // namespace

int64_t AccessorCount(const GltfFile& file, int accessor) {
  const auto& accessors = file.model().accessors;
  if (accessor < 0 || static_cast<size_t>(accessor) >= accessors.size()) return 0;
  return static_cast<int64_t>(accessors[static_cast<size_t>(accessor)].count);
}

Result<Vector<float>> ReadFloats(const GltfFile& file, const AccessorRequest& request) {
  return CatchOutOfMemory(request.place, [&]() -> Result<Vector<float>> {
    Result<Vector<float>> numbers = DecodeFloats(file, request);
    if (!numbers.ok()) return numbers.status().WithContext(Place(request));
    return numbers;
  });
}

Result<Vector<uint32_t>> ReadIndices(const GltfFile& file, const AccessorRequest& request,
                                     uint32_t bound) {
  return CatchOutOfMemory(request.place, [&]() -> Result<Vector<uint32_t>> {
    Result<Vector<uint32_t>> indices = DecodeIndices(file, request, bound);
    if (!indices.ok()) return indices.status().WithContext(Place(request));
    return indices;
  });
}

Result<std::span<const uint8_t>> ViewBytes(const GltfFile& file, const AccessorRequest& request) {
  Result<std::span<const uint8_t>> bytes = FindBytes(file, request);
  if (!bytes.ok()) return bytes.status().WithContext(Place(request));
  return bytes;
}

}  // namespace limber
