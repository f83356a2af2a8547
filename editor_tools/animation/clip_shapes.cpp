#include "animation/clip_shapes.h"

#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

// The node's own weights, else the mesh's, else none (glTF 2.0, section 3.7.2.2).
Result<Vector<double>> RestWeights(const GltfFile& file, size_t node, size_t num_targets) {
  const Json& node_json = file.json()["nodes"][node];
  const auto mesh = node_json["mesh"].get<size_t>();
  const Json& mesh_json = file.json()["meshes"][mesh];
  const bool of_node = node_json.contains("weights");
  const Json& owner = of_node ? node_json : mesh_json;
  Vector<double> weights(num_targets, 0.0);
  const auto it = owner.find("weights");
  if (it == owner.end()) return weights;
  bool good = it->is_array() && it->size() == num_targets;
  for (size_t t = 0; good && t < num_targets; ++t) {
    good = (*it)[t].is_number();
    if (good) weights[t] = (*it)[t].get<double>();
  }
  if (good) return weights;
  return Error(StatusCode::kMalformed,
               "%s[%zu].weights: it is no list of %zu numbers, one for each morph target; export "
               "the mesh again",
               of_node ? "nodes" : "meshes", of_node ? node : mesh, num_targets);
}

Result<Skin> ReadNodeSkin(const GltfFile& file, const Json& node) {
  constexpr int64_t kLargest = std::numeric_limits<int32_t>::max();
  const Json& index = node["skin"];
  const int64_t number = index.is_number_integer() ? index.get<int64_t>() : -1;
  return ReadSkin(file, static_cast<int>(std::clamp<int64_t>(number, -1, kLargest)));
}

// Marks the joints and every node above one.
Vector<bool> NodesThatMove(const GltfFile& file, const Skin& skin) {
  const Vector<int> parent = ParentNodes(file);
  Vector<bool> moves(parent.size(), false);
  for (const int joint : skin.joints) {
    for (int at = joint; at >= 0 && !moves[static_cast<size_t>(at)];
         at = parent[static_cast<size_t>(at)]) {
      moves[static_cast<size_t>(at)] = true;
    }
  }
  return moves;
}

}  // namespace

bool ClipDeforms(const GltfFile& file, const AnimationClip& clip, int node) {
  const Json& json = file.json()["nodes"][static_cast<size_t>(node)];
  Vector<bool> moves(file.json()["nodes"].size(), false);
  if (json.contains("skin")) {
    const Result<Skin> skin = ReadNodeSkin(file, json);
    if (!skin.ok()) return true;
    moves = NodesThatMove(file, *skin);
  }
  return std::any_of(clip.channels.begin(), clip.channels.end(), [&](const ClipChannel& channel) {
    if (channel.path != ClipPath::kWeights) return bool{moves[static_cast<size_t>(channel.node)]};
    const Vector<double>& weights = channel.track.values;
    return channel.node == node &&
           std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0; });
  });
}

Result<ClipShapes> ClipShapes::Create(const GltfFile& file, int node) {
  ClipShapes shapes;
  shapes.file_ = &file;
  shapes.node_ = node;
  shapes.rest_local_ = LocalTransforms(file);
  const Json& json = file.json()["nodes"][static_cast<size_t>(node)];
  if (json.contains("skin")) {
    Result<Skin> skin = ReadNodeSkin(file, json);
    if (!skin.ok()) return skin.status();
    const Vector<Eigen::Matrix4d> world = WorldTransforms(file, shapes.rest_local_);
    const Result<Eigen::Matrix4d> back = WorldToMesh(file, *skin, world);
    if (!back.ok()) return back.status();
    shapes.world_to_mesh_ = *back;
    shapes.rest_root_ = world[static_cast<size_t>(skin->joints[skin->root])].topRightCorner<3, 1>();
    shapes.skin_ = std::move(*skin);
  }
  const size_t num_joints = shapes.has_skin() ? shapes.skin_->joints.size() : 0;
  const size_t root = shapes.has_skin() ? shapes.skin_->root : 0;
  Result<SkinnedMesh> mesh = ReadSkinnedMesh(file, json["mesh"].get<int>(), num_joints, root);
  if (!mesh.ok()) return mesh.status();
  shapes.mesh_ = std::move(*mesh);
  Result<Vector<double>> weights =
      RestWeights(file, static_cast<size_t>(node), shapes.mesh_.num_targets);
  if (!weights.ok()) return weights.status();
  shapes.rest_weights_ = std::move(*weights);
  return shapes;
}

Vector<Eigen::Matrix4d> ClipShapes::JointMatricesAt(const AnimationClip& clip, double time,
                                                    bool in_place) const {
  if (!has_skin()) return {};
  Vector<NodeTransform> local = rest_local_;
  ApplyClip(clip, time, &local);
  const Vector<Eigen::Matrix4d> world = WorldTransforms(*file_, local);
  Eigen::Matrix4d to_mesh = world_to_mesh_;
  if (in_place) {
    const Eigen::Matrix4d& root = world[static_cast<size_t>(skin_->joints[skin_->root])];
    Eigen::Matrix4d held = Eigen::Matrix4d::Identity();
    held.topRightCorner<3, 1>() = rest_root_ - root.topRightCorner<3, 1>();
    held(1, 3) = 0;  // glTF's y is up: what hops still hops
    to_mesh = world_to_mesh_ * held;
  }
  return JointMatrices(*skin_, world, to_mesh);
}

Vector<PosedPrimitive> ClipShapes::ShapeAt(const AnimationClip& clip, double time,
                                           bool in_place) const {
  Vector<double> weights = rest_weights_;
  ApplyClipWeights(clip, time, node_, &weights);
  const Vector<Eigen::Matrix4d> matrices = JointMatricesAt(clip, time, in_place);
  Vector<PosedPrimitive> shape;
  for (const SkinnedPrimitive& primitive : mesh_.primitives)
    shape.push_back(PosePrimitive(primitive, weights, matrices));
  return shape;
}

}  // namespace limber::bake
