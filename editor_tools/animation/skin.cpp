#include "animation/skin.h"

#include "clips/node_transforms.h"
#include "core/printable.h"
#include "core/vector.h"
#include "import/mesh_node.h"
#include "load/gltf_accessor.h"
#include "load/json_text.h"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Status Malformed(const std::string& place, const std::string& reason) {
  return Status(StatusCode::kMalformed, place + ": " + reason + "; export the skin again");
}

size_t Count(const Json& root, const char* section) {
  const auto it = root.find(section);
  return it != root.end() && it->is_array() ? it->size() : 0;
}

Status ReadJoints(const Json& root, const Json& json, const std::string& place, Skin* skin) {
  const size_t num_nodes = Count(root, "nodes");
  if (Count(json, "joints") == 0) return Malformed(place, "it has no joints");
  Vector<bool> seen(num_nodes, false);
  for (const Json& joint : json["joints"]) {
    if (!joint.is_number_unsigned() || joint.get<uint64_t>() >= num_nodes) {
      return Malformed(place + ".joints", "it holds " + ShowJson(joint) + ", the file has " +
                                              std::to_string(num_nodes) + " nodes");
    }
    const auto node = joint.get<size_t>();
    if (seen[node]) {
      return Malformed(place + ".joints", "node " + std::to_string(node) + " is there twice");
    }
    seen[node] = true;
    skin->joints.push_back(static_cast<int>(node));
  }
  return {};
}

Status ReadInverseBind(const GltfFile& file, const Json& json, const std::string& place,
                       Skin* skin) {
  const auto it = json.find("inverseBindMatrices");
  if (it == json.end()) {
    skin->inverse_bind.assign(skin->joints.size(), Eigen::Matrix4d::Identity());
    return {};
  }
  const std::string matrices_place = place + ".inverseBindMatrices";
  if (!it->is_number_unsigned() || it->get<uint64_t>() >= Count(file.json(), "accessors")) {
    return Malformed(matrices_place, "it is " + ShowJson(*it) + ", and no accessor of the file");
  }
  const Result<Vector<float>> numbers = ReadFloats(file, {it->get<int>(), 16, matrices_place});
  if (!numbers.ok()) return numbers.status();
  if (numbers->size() / 16 < skin->joints.size()) {
    return Malformed(matrices_place, std::to_string(numbers->size() / 16) + " matrices for " +
                                         std::to_string(skin->joints.size()) + " joints");
  }
  for (size_t j = 0; j < skin->joints.size(); ++j) {
    const Eigen::Map<const Eigen::Matrix4f> matrix(numbers->data() + 16 * j);
    skin->inverse_bind.emplace_back(matrix.cast<double>());
    if (matrix.row(3) != Eigen::RowVector4f(0, 0, 0, 1)) {
      return Malformed(matrices_place,
                       "the last row of matrix " + std::to_string(j) + " is not 0 0 0 1");
    }
  }
  return {};
}

// The place in the list of the first joint, or of the topmost joint above it.
size_t FindRoot(const GltfFile& file, const Vector<int>& joints) {
  const Vector<int> parent = ParentNodes(file);
  Vector<bool> is_joint(parent.size(), false);
  for (const int joint : joints)
    is_joint[static_cast<size_t>(joint)] = true;
  // Climbs from the first joint to the topmost one above it.
  int root = joints[0];
  for (int at = root; at >= 0; at = parent[static_cast<size_t>(at)]) {
    if (is_joint[static_cast<size_t>(at)]) root = at;
  }
  return static_cast<size_t>(std::find(joints.begin(), joints.end(), root) - joints.begin());
}

bool HasInverse(const Eigen::Matrix4d& matrix) {
  return matrix.allFinite() && matrix.topLeftCorner<3, 3>().determinant() != 0 &&
         matrix.inverse().allFinite();
}

}  // namespace

Result<Skin> ReadSkin(const GltfFile& file, int skin) {
  const size_t num_skins = Count(file.json(), "skins");
  const std::string place = "skins[" + std::to_string(skin) + "]";
  if (skin < 0 || static_cast<size_t>(skin) >= num_skins) {
    return Malformed(place, "the file has " + std::to_string(num_skins) + " skins");
  }
  const Json& json = file.json()["skins"][static_cast<size_t>(skin)];
  if (!json.is_object()) return Malformed(place, "not an object");
  Skin result;
  LIMBER_RETURN_IF_ERROR(ReadJoints(file.json(), json, place, &result));
  LIMBER_RETURN_IF_ERROR(ReadInverseBind(file, json, place, &result));
  result.root = FindRoot(file, result.joints);
  return result;
}

Result<Eigen::Matrix4d> WorldToMesh(const GltfFile& file, const Skin& skin,
                                    std::span<const Eigen::Matrix4d> rest_world) {
  const auto node = static_cast<size_t>(skin.joints[skin.root]);
  const Eigen::Matrix4d at_bind = rest_world[node] * skin.inverse_bind[skin.root];
  if (!HasInverse(at_bind)) {
    return Error(StatusCode::kMalformed,
                 "node %s: the root joint's transform or inverse bind matrix has no inverse, so "
                 "the way from the skeleton to the mesh is lost; give it a scale",
                 Quoted(NodeName(file, node)).c_str());
  }
  return Eigen::Matrix4d(at_bind.inverse());
}

Vector<Eigen::Matrix4d> JointMatrices(const Skin& skin, std::span<const Eigen::Matrix4d> world,
                                      const Eigen::Matrix4d& world_to_mesh) {
  Vector<Eigen::Matrix4d> matrices;
  for (size_t j = 0; j < skin.joints.size(); ++j) {
    const Eigen::Matrix4d& joint = world[static_cast<size_t>(skin.joints[j])];
    matrices.emplace_back(world_to_mesh * joint * skin.inverse_bind[j]);
  }
  return matrices;
}

}  // namespace limber::bake
