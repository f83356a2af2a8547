#include "animation/painted_weights.h"

#include "animation/skin.h"
#include "animation/skinned_mesh.h"
#include "core/vector.h"
#include "load/gltf_mesh.h"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <set>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastWeight = 0.1;  // of the vertex that follows a joint most
constexpr double kNearlyMost = 0.9;   // of that: among such vertices the place decides
constexpr size_t kChannels = 4;

int SkinOf(const GltfFile& file, int node) {
  const Json& json = file.json()["nodes"][static_cast<size_t>(node)];
  const auto skin = json.find("skin");
  return skin == json.end() ? -1 : skin->get<int>();
}

// D x J. The character's primitives are some of the mesh's.
Eigen::MatrixXd JointWeights(const RawCharacter& raw, const SkinnedMesh& mesh, size_t num_joints) {
  Eigen::MatrixXd weights =
      Eigen::MatrixXd::Zero(raw.num_draw_vertices(), static_cast<Eigen::Index>(num_joints));
  for (const SkinPrimitive& part : raw.primitives) {
    const SkinnedPrimitive& primitive = mesh.primitives[static_cast<size_t>(part.gltf_primitive)];
    const size_t per_vertex = primitive.num_influences;
    for (size_t i = 0; i < per_vertex * part.num_vertices; ++i) {
      weights(part.first_vertex + static_cast<Eigen::Index>(i / per_vertex), primitive.joints[i]) +=
          primitive.joint_weights[i];
    }
  }
  return weights;
}

// Chooses a vertex for each joint; none twice, seen as points: copies of a seam are one.
class JointPlacer {
 public:
  explicit JointPlacer(const RawCharacter& raw) : raw_(raw) {}

  // The draw vertex; -1 where none follows the joint by a tenth, or all that do are taken.
  int Place(const Eigen::VectorXd& weights, const Eigen::RowVector3d& joint) {
    const double most = weights.maxCoeff();
    if (!(most >= kLeastWeight)) return -1;
    int nearest = -1;
    double smallest = std::numeric_limits<double>::infinity();
    for (int v = 0; v < weights.size(); ++v) {
      if (weights[v] < kNearlyMost * most || taken_.count(Point(v)) > 0) continue;
      const double distance = (raw_.shapes[0].row(v) - joint).squaredNorm();
      if (distance >= smallest) continue;
      smallest = distance;
      nearest = v;
    }
    if (nearest >= 0) taken_.insert(Point(nearest));
    return nearest;
  }

 private:
  std::array<double, 3> Point(int vertex) const {
    const auto row = raw_.shapes[0].row(vertex);
    return {row[0], row[1], row[2]};
  }

  const RawCharacter& raw_;
  std::set<std::array<double, 3>> taken_;
};

std::string JointName(const GltfFile& file, int node) {
  const std::string name = file.json()["nodes"][static_cast<size_t>(node)].value("name", "");
  return name.empty() ? "joint_" + std::to_string(node) : name;
}

std::string IdleJoints(const Vector<std::string>& names) {
  constexpr size_t kMostNamed = 8;
  std::string line =
      std::to_string(names.size()) +
      (names.size() == 1 ? " joint that hardly any vertex follows becomes no handle: "
                         : " joints that hardly any vertex follows become no handles: ");
  for (size_t i = 0; i < std::min(names.size(), kMostNamed); ++i)
    line += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMostNamed ? line + ", ..." : line;
}

}  // namespace

Result<PaintedWeights> WeightsOfSkin(const GltfFile& file, const RawCharacter& raw) {
  const int skin_index = SkinOf(file, raw.node);
  if (skin_index < 0) {
    return Error(StatusCode::kNotFound,
                 "node \"%s\": it has no skin, so there are no painted weights; leave --weights "
                 "out and they are computed",
                 raw.name.c_str());
  }
  const Result<Skin> skin = ReadSkin(file, skin_index);
  if (!skin.ok()) return skin.status();
  Result<SkinnedMesh> mesh = ReadSkinnedMesh(file, raw.mesh, skin->joints.size(), skin->root);
  if (!mesh.ok()) return mesh.status();
  const Eigen::MatrixXd of_joints = JointWeights(raw, *mesh, skin->joints.size());

  PaintedWeights painted;
  painted.warnings = std::move(mesh->warnings);
  Vector<Eigen::Index> columns;
  Vector<std::string> idle;
  JointPlacer placer(raw);
  for (size_t j = 0; j < skin->joints.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const Eigen::Matrix4d at_bind = skin->inverse_bind[j].inverse();
    const std::string name = JointName(file, skin->joints[j]);
    const int vertex =
        placer.Place(of_joints.col(column), at_bind.topRightCorner<3, 1>().transpose());
    if (vertex < 0) {
      idle.push_back(name);
      continue;
    }
    HandleSpec handle;
    handle.name = name;
    handle.node = skin->joints[j];
    handle.source_vertex = raw.source_vertex[static_cast<size_t>(vertex)];
    painted.handles.push_back(std::move(handle));
    columns.push_back(column);
  }
  if (!idle.empty()) painted.warnings.push_back(IdleJoints(idle));
  if (columns.empty()) {
    return Error(StatusCode::kNoHandles, "skins[%d]: no vertex follows any of its joints",
                 skin_index);
  }
  painted.weights = of_joints(Eigen::all, columns);
  return painted;
}

Result<PaintedWeights> WeightsOfColors(const GltfFile& file, const RawCharacter& raw,
                                       std::span<const HandleSpec> handles) {
  const Result<GltfMorphMesh> mesh = ReadMorphMesh(file, raw.mesh);
  if (!mesh.ok()) return mesh.status();
  PaintedWeights painted;
  painted.handles.assign(handles.begin(), handles.end());
  painted.weights.resize(raw.num_draw_vertices(), static_cast<Eigen::Index>(handles.size()));
  for (size_t first = 0; first < handles.size(); first += kChannels) {
    const std::string attribute = "COLOR_" + std::to_string(first / kChannels);
    size_t channels = kChannels;
    Result<Vector<float>> colors =
        ReadMeshAttribute(file, *mesh, attribute, static_cast<int>(channels));
    if (!colors.ok() && colors.status().code() != StatusCode::kNotFound &&
        handles.size() < first + kChannels) {
      channels = kChannels - 1;  // no alpha, and none is needed
      colors = ReadMeshAttribute(file, *mesh, attribute, static_cast<int>(channels));
    }
    if (!colors.ok()) {
      return colors.status().WithContext("handle '" + handles[first].name + "': weights of " +
                                         attribute);
    }
    for (size_t h = first; h < std::min(handles.size(), first + channels); ++h) {
      for (int v = 0; v < raw.num_draw_vertices(); ++v) {
        const size_t at = static_cast<size_t>(v) * channels + h - first;
        painted.weights(v, static_cast<Eigen::Index>(h)) = static_cast<double>((*colors)[at]);
      }
    }
  }
  return painted;
}

}  // namespace limber::bake
