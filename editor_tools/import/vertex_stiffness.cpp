#include "import/vertex_stiffness.h"

#include "core/vector.h"
#include "import/handle_spec.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

constexpr char kColorPrefix[] = "COLOR_";
constexpr float kColorRange = 100;  // white against mid-grey, and mid-grey against black

Result<Vector<float>> FromColor(const GltfFile& file, const GltfMorphMesh& mesh,
                                const std::string& attribute) {
  int components = 3;
  Result<Vector<float>> colors = ReadMeshAttribute(file, mesh, attribute, components);
  if (!colors.ok() && colors.status().code() != StatusCode::kNotFound) {
    components = 4;
    colors = ReadMeshAttribute(file, mesh, attribute, components);
  }
  if (!colors.ok()) return colors.status();
  Vector<float> factors;
  for (size_t at = 0; at < colors->size(); at += static_cast<size_t>(components))
    factors.push_back(std::pow(kColorRange, 2 * std::clamp((*colors)[at], 0.0f, 1.0f) - 1));
  return factors;
}

}  // namespace

Result<Vector<float>> ReadVertexStiffness(const GltfFile& file, const GltfMorphMesh& mesh,
                                          const std::string& attribute) {
  if (attribute.rfind(kColorPrefix, 0) == 0) return FromColor(file, mesh, attribute);
  const std::string name = attribute.empty() ? kStiffnessAttribute : attribute;
  Result<Vector<float>> factors = ReadMeshAttribute(file, mesh, name, 1);
  if (!factors.ok()) {
    const bool is_optional = attribute.empty();
    if (is_optional && factors.status().code() == StatusCode::kNotFound) return Vector<float>();
    return factors;
  }
  for (size_t v = 0; v < factors->size(); ++v) {
    const auto factor = static_cast<double>((*factors)[v]);
    if (IsRegionStiffness(factor)) continue;
    return Error(StatusCode::kMalformed,
                 "mesh \"%s\": %s: vertex %zu has %g; expected a factor from %g to %g",
                 mesh.name.c_str(), name.c_str(), v, factor, kSoftestRegion, kStiffestRegion);
  }
  return factors;
}

}  // namespace limber::bake
