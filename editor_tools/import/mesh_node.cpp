#include "import/mesh_node.h"

#include "core/printable.h"
#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <charconv>
#include <optional>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

size_t NumNodes(const GltfFile& file) {
  const auto nodes = file.json().find("nodes");
  return nodes == file.json().end() ? 0 : nodes->size();
}

std::optional<size_t> ParseNumber(const std::string& text) {
  size_t number = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, number);
  return error == std::errc() && end == text_end ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string NodeName(const GltfFile& file, size_t node) {
  const std::string name = file.json()["nodes"][node].value("name", "");
  return name.empty() ? "node_" + std::to_string(node) : name;
}

Vector<size_t> MeshNodes(const GltfFile& file) {
  Vector<size_t> with_mesh;
  for (size_t n = 0; n < NumNodes(file); ++n) {
    if (file.json()["nodes"][n].contains("mesh")) with_mesh.push_back(n);
  }
  return with_mesh;
}

std::string ListNodes(const GltfFile& file, const Vector<size_t>& which) {
  constexpr size_t kMostListed = 12;
  std::string list;
  for (size_t i = 0; i < which.size() && i < kMostListed; ++i) {
    list += (i == 0 ? "" : ", ") + Quoted(NodeName(file, which[i])) + " (" +
            std::to_string(which[i]) + ")";
  }
  return which.size() > kMostListed ? list + ", ..." : list;
}

Result<int> FindNamedMeshNode(const GltfFile& file, const std::string& wanted) {
  const Vector<size_t> with_mesh = MeshNodes(file);
  Vector<size_t> matching;
  for (const size_t n : with_mesh) {
    if (file.json()["nodes"][n].value("name", "") == wanted) matching.push_back(n);
  }
  if (matching.size() > 1) {
    return Error(StatusCode::kInvalidArgument, "node %s: several have that name; give a number: %s",
                 Quoted(wanted).c_str(), ListNodes(file, matching).c_str());
  }
  if (matching.size() == 1) return static_cast<int>(matching[0]);
  const std::optional<size_t> number = ParseNumber(wanted);
  for (const size_t n : with_mesh) {
    if (number == n) return static_cast<int>(n);
  }
  return Error(StatusCode::kNotFound,
               "node %s: there is no mesh node of that name or number; mesh nodes are %s",
               Quoted(wanted).c_str(), ListNodes(file, with_mesh).c_str());
}

}  // namespace limber::bake
