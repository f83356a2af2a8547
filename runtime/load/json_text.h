// JSON values of a file as they stand in messages.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace limber {

// One line of bounded length: numbers and literals as they are, strings quoted, "an array of 3",
// "an object of 2 members".
std::string ShowJson(const nlohmann::ordered_json& value);

}  // namespace limber
