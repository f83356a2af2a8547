#include "cli/cost_text.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace limber::cli {

std::string CostText(const bake::RigCost& cost) {
  const auto megabytes = [](uint64_t bytes) { return static_cast<double>(bytes) / 1e6; };
  char text[256];
  std::snprintf(text, sizeof text,
                "%.2f MB more in the file; in memory %.2f MB of model, %.2f MB of mesh, %.0f kB a "
                "character; about %.3g us an alternation",
                megabytes(cost.file_bytes), megabytes(cost.model_bytes), megabytes(cost.mesh_bytes),
                1e3 * megabytes(cost.character_bytes), cost.alternation_seconds * 1e6);
  return text;
}

nlohmann::ordered_json CostJson(const bake::RigCost& cost) {
  return {{"file_bytes", cost.file_bytes},
          {"model_bytes", cost.model_bytes},
          {"mesh_bytes", cost.mesh_bytes},
          {"character_bytes", cost.character_bytes},
          {"alternation_seconds", cost.alternation_seconds}};
}

}  // namespace limber::cli
