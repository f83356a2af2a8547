// Decodes accessors of a GltfFile into plain numbers: strides, sparse parts, normalised and
// quantised integers; every offset checked in 64 bits.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <cstdint>
#include <span>
#include <string>

namespace limber {

struct AccessorRequest {
  int accessor = -1;
  int components = 1;           // wanted: 1 (SCALAR) to 4 (VEC4), 16 (MAT4, by columns)
  std::string place;            // for messages: "meshes[0].primitives[1].POSITION"
  int64_t expected_count = -1;  // refuse another element count; -1: any
  // Whether elements may have no bytes in the file (no bufferView: zeros, then the sparse part).
  // Otherwise at most GltfLimits::max_implicit_zeros of them may, so that a small file cannot ask
  // for gigabytes.
  bool may_be_implicit = false;
};

// Number of elements; 0 for an index out of range.
int64_t AccessorCount(const GltfFile& file, int accessor);

// All elements, components interleaved. Integers that are not normalised come as their value.
// Errors, each beginning with the place and naming the accessor and the element: kMalformed (out of
// bounds, another type or count, not finite), kLimitExceeded, kOutOfMemory.
Result<Vector<float>> ReadFloats(const GltfFile& file, const AccessorRequest& request);

// Unsigned integer scalars, each below `bound`. Errors as above.
Result<Vector<uint32_t>> ReadIndices(const GltfFile& file, const AccessorRequest& request,
                                     uint32_t bound);

// Unsigned bytes, as they stand in the file: of an accessor that is neither sparse nor implicit,
// its elements one after the other. They live as long as `file`. Errors as above.
Result<std::span<const uint8_t>> ViewBytes(const GltfFile& file, const AccessorRequest& request);

}  // namespace limber
