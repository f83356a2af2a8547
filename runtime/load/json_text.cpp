#include "load/json_text.h"

#include "core/printable.h"

#include <nlohmann/json.hpp>

namespace limber {

std::string ShowJson(const nlohmann::ordered_json& value) {
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return "an object of " + std::to_string(value.size()) + " members";
  if (value.is_string()) return Quoted(value.get_ref<const std::string&>());
  return value.dump();
}

}  // namespace limber
