#include "animation/skinned_mesh.h"

#include "core/vector.h"
#include "load/gltf_accessor.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kPerSet = 4;  // joints and weights come in attributes of four

int FindAccessor(const Json& attributes, const std::string& name) {
  const auto it = attributes.find(name);
  return it == attributes.end() ? -1 : it->get<int>();
}

size_t NumTargets(const Json& primitive) {
  const auto targets = primitive.find("targets");
  return targets == primitive.end() ? 0 : targets->size();
}

class SkinnedMeshReader {
 public:
  SkinnedMeshReader(const GltfFile& file, int mesh, size_t num_joints, size_t root_joint)
      : file_(file),
        primitives_(file.json()["meshes"][static_cast<size_t>(mesh)]["primitives"]),
        mesh_place_("meshes[" + std::to_string(mesh) + "]"),
        num_joints_(num_joints),
        root_joint_(root_joint) {}

  Result<SkinnedMesh> Read() {
    LIMBER_RETURN_IF_ERROR(CountTargets());
    LIMBER_RETURN_IF_ERROR(CheckSize());
    for (size_t p = 0; p < primitives_.size(); ++p) {
      SkinnedPrimitive primitive;
      const Json& json = primitives_[p];
      place_ = Place(p);
      LIMBER_RETURN_IF_ERROR(ReadSurface(json["attributes"], &primitive));
      LIMBER_RETURN_IF_ERROR(ReadTargets(json, &primitive));
      if (num_joints_ > 0) LIMBER_RETURN_IF_ERROR(ReadInfluences(json["attributes"], &primitive));
      mesh_.primitives.push_back(std::move(primitive));
    }
    if (num_unweighted_ > 0) {
      mesh_.warnings.push_back(std::to_string(num_unweighted_) +
                               " vertices have no skinning weight and follow the root joint; the "
                               "first is " +
                               first_unweighted_);
    }
    return std::move(mesh_);
  }

 private:
  std::string Place(size_t p) const {
    return mesh_place_ + ".primitives[" + std::to_string(p) + "]";
  }

  Status CountTargets() {
    for (size_t p = 0; p < primitives_.size(); ++p) {
      const size_t here = NumTargets(primitives_[p]);
      if (here == 0) continue;
      if (mesh_.num_targets == 0) mesh_.num_targets = here;
      if (here != mesh_.num_targets) {
        return Error(StatusCode::kMalformed,
                     "%s: %zu morph targets, and others have %zu; all primitives of a mesh need "
                     "the same targets, export it again",
                     Place(p).c_str(), here, mesh_.num_targets);
      }
    }
    return {};
  }

  Status CheckSize() const {
    uint64_t total = 0;
    for (size_t p = 0; p < primitives_.size(); ++p) {
      const int position = FindAccessor(primitives_[p]["attributes"], "POSITION");
      if (position < 0) {
        return Error(StatusCode::kMalformed, "%s: it has no POSITION", Place(p).c_str());
      }
      total += static_cast<uint64_t>(AccessorCount(file_, position));
    }
    const GltfLimits& limits = file_.limits();
    if (total > limits.max_vertices || total * mesh_.num_targets > limits.max_morph_positions) {
      return Error(StatusCode::kLimitExceeded,
                   "%s: %llu vertices with %zu morph targets are more than the limits allow",
                   mesh_place_.c_str(), static_cast<unsigned long long>(total), mesh_.num_targets);
    }
    return {};
  }

  // V x 3; without rows where there is no accessor.
  Result<PointMatrix> ReadPoints(int accessor, const std::string& name, int64_t expected) const {
    if (accessor < 0) return PointMatrix(0, 3);
    AccessorRequest request{accessor, 3, place_ + name};
    request.expected_count = expected;
    request.may_be_implicit = expected >= 0;
    const Result<Vector<float>> numbers = ReadFloats(file_, request);
    if (!numbers.ok()) return numbers.status();
    using FloatPoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    return PointMatrix(Eigen::Map<const FloatPoints>(
                           numbers->data(), static_cast<Eigen::Index>(numbers->size() / 3), 3)
                           .cast<double>());
  }

  Status ReadSurface(const Json& attributes, SkinnedPrimitive* primitive) const {
    Result<PointMatrix> positions =
        ReadPoints(FindAccessor(attributes, "POSITION"), ".POSITION", -1);
    if (!positions.ok()) return positions.status();
    primitive->positions = std::move(*positions);
    Result<PointMatrix> normals =
        ReadPoints(FindAccessor(attributes, "NORMAL"), ".NORMAL", primitive->positions.rows());
    if (!normals.ok()) return normals.status();
    primitive->normals = std::move(*normals);
    return {};
  }

  Status ReadTargets(const Json& json, SkinnedPrimitive* primitive) const {
    for (size_t t = 0; t < NumTargets(json); ++t) {
      const Json& target = json["targets"][t];
      const std::string name = ".targets[" + std::to_string(t) + "]";
      const Eigen::Index count = primitive->positions.rows();
      Result<PointMatrix> positions =
          ReadPoints(FindAccessor(target, "POSITION"), name + ".POSITION", count);
      if (!positions.ok()) return positions.status();
      Result<PointMatrix> normals =
          ReadPoints(FindAccessor(target, "NORMAL"), name + ".NORMAL", count);
      if (!normals.ok()) return normals.status();
      primitive->targets.push_back({std::move(*positions), std::move(*normals)});
    }
    return {};
  }

  Status ReadInfluences(const Json& attributes, SkinnedPrimitive* primitive) {
    size_t num_sets = 0;
    while (attributes.contains("JOINTS_" + std::to_string(num_sets)))
      ++num_sets;
    if (num_sets == 0) {
      return Error(StatusCode::kMalformed,
                   "%s: its node has a skin, and it has no JOINTS_0; export the skin again",
                   place_.c_str());
    }
    const size_t num_vertices = primitive->num_vertices();
    if (kPerSet * num_sets * num_vertices > file_.limits().max_weights) {
      return Error(StatusCode::kLimitExceeded, "%s: %zu vertices with %zu sets of joints each",
                   place_.c_str(), num_vertices, num_sets);
    }
    primitive->num_influences = kPerSet * num_sets;
    primitive->joints.resize(num_vertices * primitive->num_influences);
    primitive->joint_weights.resize(num_vertices * primitive->num_influences);
    for (size_t set = 0; set < num_sets; ++set)
      LIMBER_RETURN_IF_ERROR(ReadInfluenceSet(attributes, set, primitive));
    NormaliseWeights(primitive);
    return {};
  }

  Result<Vector<float>> ReadSet(const Json& attributes, const char* kind, size_t set,
                                size_t num_vertices) const {
    const std::string name = kind + std::to_string(set);
    AccessorRequest request{FindAccessor(attributes, name), 4, place_ + "." + name};
    request.expected_count = static_cast<int64_t>(num_vertices);
    if (request.accessor < 0) {
      return Error(StatusCode::kMalformed,
                   "%s: it is missing beside JOINTS_%zu; export the skin again",
                   request.place.c_str(), set);
    }
    return ReadFloats(file_, request);
  }

  Status ReadInfluenceSet(const Json& attributes, size_t set, SkinnedPrimitive* primitive) const {
    const size_t num_vertices = primitive->num_vertices();
    const Result<Vector<float>> joints = ReadSet(attributes, "JOINTS_", set, num_vertices);
    if (!joints.ok()) return joints.status();
    const Result<Vector<float>> weights = ReadSet(attributes, "WEIGHTS_", set, num_vertices);
    if (!weights.ok()) return weights.status();
    for (size_t i = 0; i < kPerSet * num_vertices; ++i) {
      const size_t vertex = i / kPerSet;
      const float joint = (*joints)[i], weight = (*weights)[i];
      LIMBER_RETURN_IF_ERROR(CheckInfluence(joint, weight, vertex, set));
      const size_t at = primitive->num_influences * vertex + kPerSet * set + i % kPerSet;
      primitive->joints[at] = static_cast<uint32_t>(joint);
      primitive->joint_weights[at] = double{weight};
    }
    return {};
  }

  Status CheckInfluence(float joint, float weight, size_t vertex, size_t set) const {
    if (!(joint >= 0) || joint >= static_cast<float>(num_joints_) || joint != std::floor(joint)) {
      return Error(StatusCode::kMalformed,
                   "%s.JOINTS_%zu: vertex %zu: %g is no joint of the skin, which has %zu; export "
                   "the skin again",
                   place_.c_str(), set, vertex, static_cast<double>(joint), num_joints_);
    }
    if (weight < 0) {
      return Error(StatusCode::kMalformed,
                   "%s.WEIGHTS_%zu: vertex %zu: the weight %g is negative; export the skin again",
                   place_.c_str(), set, vertex, static_cast<double>(weight));
    }
    return {};
  }

  void NormaliseWeights(SkinnedPrimitive* primitive) {
    const size_t width = primitive->num_influences;
    for (size_t v = 0; v < primitive->num_vertices(); ++v) {
      double* const weights = primitive->joint_weights.data() + width * v;
      double sum = 0;
      for (size_t i = 0; i < width; ++i)
        sum += weights[i];
      if (sum > 0) {
        std::for_each(weights, weights + width, [sum](double& weight) { weight /= sum; });
        continue;
      }
      if (num_unweighted_++ == 0) first_unweighted_ = place_ + ", vertex " + std::to_string(v);
      weights[0] = 1;
      primitive->joints[width * v] = static_cast<uint32_t>(root_joint_);
    }
  }

  const GltfFile& file_;
  const Json& primitives_;
  const std::string mesh_place_;
  const size_t num_joints_, root_joint_;
  std::string place_;  // of the primitive that is being read
  size_t num_unweighted_ = 0;
  std::string first_unweighted_;
  SkinnedMesh mesh_;
};

}  // namespace

size_t SkinnedMesh::num_vertices() const {
  size_t sum = 0;
  for (const SkinnedPrimitive& primitive : primitives)
    sum += primitive.num_vertices();
  return sum;
}

Result<SkinnedMesh> ReadSkinnedMesh(const GltfFile& file, int mesh, size_t num_joints,
                                    size_t root_joint) {
  return SkinnedMeshReader(file, mesh, num_joints, root_joint).Read();
}

}  // namespace limber::bake
