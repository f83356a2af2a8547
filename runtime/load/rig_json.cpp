#include "load/rig_json.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "load/json_text.h"
#include "rig/packed_numbers.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

// Reads members of one JSON object; the first failure is kept and later reads do nothing.
class ObjectReader {
 public:
  ObjectReader(const Json& object, std::string place) : object_(object), place_(std::move(place)) {
    if (!object.is_object()) Fail("", "it is not an object");
  }

  const Status& status() const { return status_; }

  int64_t Integer(const char* key, int64_t lowest, int64_t highest) {
    const Json* value = Find(key);
    if (value == nullptr) return lowest;
    const bool fits = value->is_number_integer() &&
                      !(value->is_number_unsigned() && value->get<uint64_t>() > uint64_t{1} << 62);
    if (!fits) {
      Fail(key, ShowJson(*value) + " is not an integer in range");
      return lowest;
    }
    const auto number = value->get<int64_t>();
    if (number < lowest || number > highest) {
      Fail(key,
           std::to_string(number) + " is not within " + std::to_string(lowest) + " to " +
               std::to_string(highest),
           number > highest ? StatusCode::kLimitExceeded : StatusCode::kMalformed);
      return lowest;
    }
    return number;
  }

  // Absent is `fallback`.
  int64_t OptionalInteger(const char* key, int64_t fallback, int64_t lowest, int64_t highest) {
    return object_.is_object() && object_.contains(key) ? Integer(key, lowest, highest) : fallback;
  }

  bool Boolean(const char* key, bool fallback) {
    if (!object_.is_object() || !object_.contains(key)) return fallback;
    const Json& value = object_[key];
    if (value.is_boolean()) return value.get<bool>();
    Fail(key, ShowJson(value) + " is neither true nor false");
    return fallback;
  }

  std::string String(const char* key) {
    const Json* value = Find(key);
    if (value == nullptr) return {};
    if (value->is_string()) return value->get<std::string>();
    Fail(key, "it is not a string");
    return {};
  }

  void Floats(const char* key, size_t count, float* numbers) {
    const Json* value = Find(key);
    if (value == nullptr) return;
    if (!value->is_array() || value->size() != count) {
      Fail(key, "it is not an array of " + std::to_string(count) + " numbers");
      return;
    }
    for (size_t i = 0; i < count; ++i) {
      if (!(*value)[i].is_number()) {
        Fail(key, "element " + std::to_string(i) + " is not a number");
        return;
      }
      numbers[i] = static_cast<float>((*value)[i].get<double>());
      if (!std::isfinite(numbers[i])) Fail(key, "element " + std::to_string(i) + " is too large");
    }
  }

  float Float(const char* key) {
    const Json* value = Find(key);
    if (value == nullptr) return 0;
    const float number = value->is_number() ? static_cast<float>(value->get<double>()) : NAN;
    if (!std::isfinite(number)) Fail(key, "it is not a finite number");
    return number;
  }

  // An array of at most `most` objects; null when it is not.
  const Json* Array(const char* key, uint64_t most) {
    const Json* value = Find(key);
    if (value == nullptr) return nullptr;
    if (!value->is_array()) {
      Fail(key, "it is not an array");
      return nullptr;
    }
    if (value->size() > most) {
      Fail(key, std::to_string(value->size()) + " elements, the limit is " + std::to_string(most),
           StatusCode::kLimitExceeded);
      return nullptr;
    }
    return value;
  }

  const Json* Object(const char* key) {
    const Json* value = Find(key);
    if (value != nullptr && value->is_object()) return value;
    if (value != nullptr) Fail(key, "it is not an object");
    return nullptr;
  }

  void Absorb(const ObjectReader& other) {
    if (status_.ok()) status_ = other.status();
  }

 private:
  const Json* Find(const char* key) {
    if (!status_.ok()) return nullptr;
    const auto it = object_.find(key);
    if (it != object_.end()) return &*it;
    Fail(key, "it is missing");
    return nullptr;
  }

  void Fail(const std::string& key, const std::string& reason,
            StatusCode code = StatusCode::kMalformed) {
    if (!status_.ok()) return;
    const std::string dot = place_.empty() || key.empty() ? "" : ".";
    status_ = Status(code, place_ + dot + key + ": " + reason);
  }

  const Json& object_;
  std::string place_;
  Status status_;
};

std::string Place(const char* array, size_t index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

void ReadHandles(const GltfLimits& limits, ObjectReader* reader, RigJson* rig) {
  const Json* handles = reader->Array("handles", limits.max_handles);
  for (size_t h = 0; handles != nullptr && h < handles->size(); ++h) {
    ObjectReader entry((*handles)[h], Place("handles", h));
    RigHandle handle;
    handle.name = entry.String("name");
    handle.pinned = entry.Boolean("pinned", true);
    handle.vertex =
        static_cast<uint32_t>(entry.Integer("vertex", 0, int64_t{rig->num_solve_vertices} - 1));
    handle.node = static_cast<int32_t>(entry.OptionalInteger("node", -1, 0, INT32_MAX));
    float position[3] = {};
    entry.Floats("position", 3, position);
    handle.rest_position = {position[0], position[1], position[2]};
    reader->Absorb(entry);
    rig->tables.handles.push_back(std::move(handle));
  }
}

void ReadShapes(const GltfLimits& limits, ObjectReader* reader, RigJson* rig) {
  const Json* shapes = reader->Array("shapes", limits.max_targets + 1);
  for (size_t s = 0; shapes != nullptr && s < shapes->size(); ++s) {
    ObjectReader entry((*shapes)[s], Place("shapes", s));
    rig->tables.shape_names.emplace_back(entry.String("name"));
    rig->shape_targets.push_back(static_cast<int>(
        entry.OptionalInteger("target", -1, 0, static_cast<int64_t>(limits.max_targets) - 1)));
    reader->Absorb(entry);
  }
}

void ReadTables(ObjectReader* reader, RigJson* rig) {
  constexpr size_t kMostDimensions = 8;
  const Json* tables = reader->Object("tables");
  if (tables == nullptr) return;
  for (const auto& [name, value] : tables->items()) {
    ObjectReader entry(value, "tables." + Printable(name));
    RigJson::Table table;
    table.accessor = static_cast<int>(entry.Integer("accessor", 0, INT32_MAX));
    const Json* shape = entry.Array("shape", kMostDimensions);
    for (size_t i = 0; shape != nullptr && i < shape->size(); ++i) {
      const Json& size = (*shape)[i];
      table.shape.push_back(size.is_number_unsigned() ? size.get<int64_t>() : -1);
    }
    if (value.contains("exponent")) {
      table.exponent =
          static_cast<int>(entry.Integer("exponent", kLeastPackingExponent, kMostPackingExponent));
    }
    reader->Absorb(entry);
    rig->table_accessors[name] = std::move(table);
  }
}

Result<RigJson> ReadRig(const Json& json, const GltfLimits& limits) {
  RigJson rig;
  ObjectReader reader(json, "");
  if (const Json* mesh = reader.Object("mesh")) {
    ObjectReader entry(*mesh, "mesh");
    const auto most = static_cast<int64_t>(limits.max_vertices);
    rig.num_vertices = static_cast<uint32_t>(entry.Integer("vertices", 1, most));
    rig.num_solve_vertices =
        static_cast<uint32_t>(entry.Integer("solveVertices", 1, rig.num_vertices));
    rig.mesh_hash = entry.String("hash");
    reader.Absorb(entry);
  }
  if (const Json* space = reader.Object("space")) {
    ObjectReader entry(*space, "space");
    entry.Floats("origin", 3, rig.tables.space.origin.data());
    rig.tables.space.scale = entry.Float("scale");
    entry.Floats("basis", 9, rig.tables.space.basis.data());
    reader.Absorb(entry);
  }
  ReadHandles(limits, &reader, &rig);
  ReadShapes(limits, &reader, &rig);
  RigTables& t = rig.tables;
  t.dimension = static_cast<int32_t>(reader.Integer("dimension", 2, 3));
  t.num_groups =
      static_cast<int32_t>(reader.Integer("groups", 1, static_cast<int64_t>(limits.max_groups)));
  // n = H * S * (k + 1) below 2^23: every product of a table's shape then fits 64 bits.
  const int64_t n = int64_t{t.num_handles()} * t.num_shapes() * (t.dimension + 1);
  const int64_t single = int64_t{t.num_handles()} * (t.dimension + 1);
  t.num_modes = static_cast<int32_t>(reader.Integer("modes", 0, n));
  t.num_single_modes = static_cast<int32_t>(reader.Integer("singleModes", 0, single));
  t.residual_rank = static_cast<int32_t>(
      reader.Integer("residualRank", 0, int64_t{t.num_groups} * t.num_shapes() * t.dimension));
  t.has_rotations = reader.Boolean("rotations", true);
  ReadTables(&reader, &rig);
  if (!reader.status().ok()) return reader.status();
  return rig;
}

}  // namespace

Result<RigJson> ReadRigJson(const Json& json, const GltfLimits& limits) {
  return CatchOutOfMemory("", [&] { return ReadRig(json, limits); });
}

Json WriteRigJson(const std::string& name, const RigJson& rig) {
  const RigTables& t = rig.tables;
  Json json = {
      {"name", name},
      {"mesh",
       {{"vertices", rig.num_vertices},
        {"solveVertices", rig.num_solve_vertices},
        {"hash", rig.mesh_hash}}},
      {"dimension", t.dimension},
      {"groups", t.num_groups},
      {"modes", t.num_modes},
      {"singleModes", t.num_single_modes},
      {"residualRank", t.residual_rank},
      {"rotations", t.has_rotations},
      {"space", {{"origin", t.space.origin}, {"scale", t.space.scale}, {"basis", t.space.basis}}}};
  Json& handles = json["handles"] = Json::array();
  for (const RigHandle& handle : t.handles) {
    const Vec3& p = handle.rest_position;
    Json entry = {{"name", handle.name}};
    if (handle.node >= 0) entry["node"] = handle.node;
    entry["pinned"] = handle.pinned;
    entry["vertex"] = handle.vertex;
    entry["position"] = {p.x, p.y, p.z};
    handles.push_back(std::move(entry));
  }
  Json& shapes = json["shapes"] = Json::array();
  for (size_t s = 0; s < t.shape_names.size(); ++s) {
    Json entry = {{"name", t.shape_names[s]}};
    if (rig.shape_targets[s] >= 0) entry["target"] = rig.shape_targets[s];
    shapes.push_back(std::move(entry));
  }
  Json& tables = json["tables"] = Json::object();
  for (const auto& [table_name, table] : rig.table_accessors) {
    Json& entry = tables[table_name] = {{"accessor", table.accessor}, {"shape", table.shape}};
    if (table.exponent) entry["exponent"] = *table.exponent;
  }
  return json;
}

}  // namespace limber
