// What a rig costs, as `bake` and `info` tell it.
#pragma once

#include "bake/rig_cost.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace limber::cli {

// "1.2 MB more in the file; in memory 2.1 MB of model, 0.4 MB of mesh, 0.6 MB a character; about
// 24 us an alternation"
std::string CostText(const bake::RigCost& cost);

nlohmann::ordered_json CostJson(const bake::RigCost& cost);

}  // namespace limber::cli
