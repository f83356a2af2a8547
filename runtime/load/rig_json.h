// The JSON half of LIMBER_mesh_ik: everything of a rig but its tables' numbers.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_limits.h"
#include "rig/rig_tables.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace limber {

struct RigJson {
  RigTables tables;                 // counts, space, handles, shape names; no numbers
  Vector<int> shape_targets;        // [S] morph target of each example shape, -1 for the base mesh
  uint32_t num_vertices = 0;        // D at the time of the bake
  uint32_t num_solve_vertices = 0;  // V
  std::string mesh_hash;            // HashMesh at the time of the bake

  struct Table {
    int accessor = -1;
    Vector<int64_t> shape;
    std::optional<int> exponent;  // of packed numbers (packed_numbers.h); without: plain floats
  };

  std::map<std::string, Table> table_accessors;
};

// Reads one entry of the extension's "rigs"; unknown members are ignored. Counts are checked
// against the limits, so that the product of any table's shape fits 64 bits. Errors: kMalformed,
// kLimitExceeded, kOutOfMemory; messages begin with the member.
Result<RigJson> ReadRigJson(const nlohmann::ordered_json& rig, const GltfLimits& limits);

// The inverse, for the writer.
nlohmann::ordered_json WriteRigJson(const std::string& name, const RigJson& rig);

}  // namespace limber
