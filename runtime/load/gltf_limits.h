// How large a file may be before it is refused; checked before anything of that size is allocated.
#pragma once

#include <cstdint>

namespace limber {

// Published defaults. Raise them for files of your own that are larger; none may exceed 2^31 - 1
// but max_morph_positions and max_weights.
struct GltfLimits {
  uint64_t max_file_bytes = 1ull << 30;    // the .glb or .gltf itself
  uint64_t max_buffer_bytes = 1ull << 30;  // all buffers together, decoded
  int max_json_depth = 64;                 // nested arrays and objects
  uint64_t max_json_values = 4'000'000;
  // Pairs of members within one object, summed over all objects: JSON that keeps its order looks a
  // member up by walking along its object, so that n members cost n^2 / 2 steps.
  uint64_t max_json_member_pairs = 50'000'000;
  uint64_t max_vertices = 1ull << 24;         // draw vertices of one mesh: ids must fit a float
  uint64_t max_triangles = 1ull << 25;        // of one mesh
  uint64_t max_targets = 1024;                // morph targets of one mesh
  uint64_t max_morph_positions = 1ull << 26;  // targets times vertices
  uint64_t max_handles = 1024;
  uint64_t max_groups = 4096;
  uint64_t max_weights = 1ull << 28;         // vertices times handles
  uint64_t max_table_numbers = 1ull << 28;   // of one table of a rig, unpacked
  uint64_t max_implicit_zeros = 1ull << 16;  // elements of an accessor that no bytes stand for
};

}  // namespace limber
