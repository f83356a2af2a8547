#include "bake/handle_nodes.h"

#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kMark[] = "limber_handle";
constexpr char kMadeByBake[] = "baked";

const Json* FindMark(const Json& node) {
  const auto extras = node.find("extras");
  if (extras == node.end() || !extras->is_object()) return nullptr;
  const auto mark = extras->find(kMark);
  return mark == extras->end() || *mark == false ? nullptr : &*mark;
}

bool WasMadeByBake(const Json& node) {
  const Json* mark = FindMark(node);
  return mark != nullptr && mark->is_object() && mark->value(kMadeByBake, Json(false)) == true;
}

void DescribeNode(const RigHandle& handle, double stiffness, Json* node) {
  const Vec3& p = handle.rest_position;
  (*node)["name"] = handle.name;
  (*node)["translation"] = {p.x, p.y, p.z};
  (*node)["extras"][kMark] = {{"pinned", handle.pinned}, {kMadeByBake, true}};
  if (stiffness != 1) (*node)["extras"][kMark]["stiffness"] = stiffness;
}

int FindMarkedNode(const Json& nodes, std::string_view name, const std::set<int>& taken) {
  for (size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].value("name", "") == name && FindMark(nodes[n]) != nullptr &&
        taken.count(static_cast<int>(n)) == 0) {
      return static_cast<int>(n);
    }
  }
  return -1;
}

// Whether a scene, a skin, an animation or another node than the mesh node refers to it, or it has
// grown children or contents of its own.
bool IsNeeded(const Json& root, size_t node, size_t mesh_node) {
  const auto lists = [node](const Json& item, const char* key) {
    const auto it = item.find(key);
    return it != item.end() && it->is_array() &&
           std::find(it->begin(), it->end(), node) != it->end();
  };
  const auto any = [&root](const char* section, const auto& test) {
    const auto it = root.find(section);
    return it != root.end() && it->is_array() && std::any_of(it->begin(), it->end(), test);
  };
  const Json& own = root["nodes"][node];
  for (const char* key : {"children", "mesh", "skin", "camera", "extensions"}) {
    if (own.contains(key)) return true;
  }
  for (size_t n = 0; n < root["nodes"].size(); ++n) {
    if (n != mesh_node && lists(root["nodes"][n], "children")) return true;
  }
  return any("scenes", [&](const Json& scene) { return lists(scene, "nodes"); }) ||
         any("skins",
             [&](const Json& skin) {
               return lists(skin, "joints") || skin.value("skeleton", Json()) == node;
             }) ||
         any("animations", [&](const Json& animation) {
           const auto channels = animation.find("channels");
           return channels != animation.end() &&
                  std::any_of(channels->begin(), channels->end(), [node](const Json& channel) {
                    return channel.contains("target") &&
                           channel["target"].value("node", Json()) == node;
                  });
         });
}

void RemoveChild(size_t child, Json* parent) {
  const auto children = parent->find("children");
  if (children == parent->end()) return;
  Json kept = Json::array();
  for (const Json& index : *children) {
    if (index != child) kept.push_back(index);
  }
  if (kept.empty()) {
    parent->erase("children");
  } else {
    *children = std::move(kept);
  }
}

void RetireNodes(const Json& old_rig, const std::set<int>& taken, size_t mesh_node, Json* root) {
  std::set<size_t> stale;
  const auto handles = old_rig.is_object() ? old_rig.find("handles") : old_rig.end();
  if (!old_rig.is_object() || handles == old_rig.end() || !handles->is_array()) return;
  Json& nodes = (*root)["nodes"];
  for (const Json& handle : *handles) {
    const Json node = handle.is_object() ? handle.value("node", Json()) : Json();
    if (!node.is_number_unsigned() || node.get<size_t>() >= nodes.size()) continue;
    const auto index = node.get<size_t>();
    if (WasMadeByBake(nodes[index]) && taken.count(static_cast<int>(index)) == 0) {
      stale.insert(index);
    }
  }
  for (auto it = stale.rbegin(); it != stale.rend(); ++it) {
    if (*it + 1 == nodes.size() && !IsNeeded(*root, *it, mesh_node)) {
      nodes.erase(*it);
      RemoveChild(*it, &nodes[mesh_node]);
    } else {
      nodes[*it]["extras"].erase(kMark);
    }
  }
}

}  // namespace

void PlaceHandleNodes(const Json& old_rig, int mesh_node, const Vector<double>& stiffness,
                      Vector<RigHandle>* handles, Json* root) {
  Json& nodes = (*root)["nodes"];
  std::set<int> taken;
  for (RigHandle& handle : *handles) {
    if (handle.node >= static_cast<int>(nodes.size())) handle.node = -1;
    if (handle.node >= 0) taken.insert(handle.node);
  }
  for (size_t h = 0; h < handles->size(); ++h) {
    RigHandle& handle = (*handles)[h];
    if (handle.node >= 0) continue;
    handle.node = FindMarkedNode(nodes, handle.name, taken);
    if (handle.node < 0) continue;
    taken.insert(handle.node);
    Json& node = nodes[static_cast<size_t>(handle.node)];
    if (WasMadeByBake(node)) DescribeNode(handle, stiffness[h], &node);
  }
  RetireNodes(old_rig, taken, static_cast<size_t>(mesh_node), root);
  for (size_t h = 0; h < handles->size(); ++h) {
    RigHandle& handle = (*handles)[h];
    if (handle.node >= 0) continue;
    Json node = Json::object();
    DescribeNode(handle, stiffness[h], &node);
    handle.node = static_cast<int>(nodes.size());
    nodes.push_back(std::move(node));
    nodes[static_cast<size_t>(mesh_node)]["children"].push_back(handle.node);
  }
}

}  // namespace limber::bake
