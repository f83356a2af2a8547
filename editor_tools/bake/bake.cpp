#include "bake/bake.h"

#include "bake/edge_groups.h"
#include "bake/example_review.h"
#include "bake/group_repair.h"
#include "bake/handle_reach.h"
#include "bake/heat_weights.h"
#include "bake/pack_tables.h"
#include "bake/reduce.h"
#include "bake/resolve_handles.h"
#include "bake/rig_space.h"
#include "bake/small_parts.h"
#include "bake/weight_rows.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "rig/rest_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace limber::bake {
namespace {

// Draw vertices closer than this fraction of the diagonal in every shape are one point: above the
// rounding of 16-bit quantised positions, below any detail that is drawn on purpose.
constexpr double kWeldTolerance = 1e-6;

// Names the stage that runs, measures it, and asks whether to go on.
class StageClock {
 public:
  StageClock(const ProgressCallback& progress, Vector<BakeTiming>* timings)
      : progress_(progress),
        timings_(timings) {}

  // False: cancelled.
  bool Begin(const char* stage, double from, double to) {
    End();
    stage_ = stage;
    from_ = from;
    to_ = to;
    begin_ = std::chrono::steady_clock::now();
    return !progress_ || progress_(stage, from);
  }

  void End() {
    if (stage_ == nullptr) return;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
    timings_->push_back({stage_, spent.count()});
    stage_ = nullptr;
  }

  // Progress within the stage that runs, mapped to its share of the whole.
  ProgressCallback Inner() const {
    if (!progress_) return {};
    return [progress = progress_, from = from_, to = to_](const char* stage, double fraction) {
      return progress(stage, from + (to - from) * fraction);
    };
  }

 private:
  const ProgressCallback& progress_;
  Vector<BakeTiming>* timings_;
  const char* stage_ = nullptr;
  double from_ = 0, to_ = 0;
  std::chrono::steady_clock::time_point begin_;
};

double Diagonal(const PointMatrix& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

Status CheckRaw(const RawCharacter& raw) {
  if (raw.shapes.empty() || raw.num_draw_vertices() == 0) {
    return Error(StatusCode::kNoExamples, "mesh '%s' has no vertices", raw.name.c_str());
  }
  for (size_t s = 0; s < raw.shapes.size(); ++s) {
    if (!raw.shapes[s].allFinite()) {
      return Error(StatusCode::kMalformed, "shape '%s': a position is not a finite number",
                   raw.shape_names[s].c_str());
    }
  }
  const auto num_vertices = static_cast<size_t>(raw.num_draw_vertices());
  if (!raw.stiffness.empty() && raw.stiffness.size() != num_vertices) {
    return Error(StatusCode::kInvalidArgument, "stiffness: %zu factors for %zu vertices",
                 raw.stiffness.size(), num_vertices);
  }
  const double diagonal = Diagonal(raw.shapes[0]);
  if (!(diagonal > 1e-30) || !std::isfinite(diagonal)) {
    return Error(StatusCode::kDegenerate, "mesh '%s' has no extent", raw.name.c_str());
  }
  return {};
}

Vec3 PointOf(const geometry::PointMatrix& points, int vertex) {
  return {static_cast<float>(points(vertex, 0)), static_cast<float>(points(vertex, 1)),
          static_cast<float>(points(vertex, 2))};
}

void FillHandles(const geometry::SolveMesh& mesh, const Vector<ResolvedHandle>& resolved,
                 RigTables* tables) {
  for (const ResolvedHandle& handle : resolved) {
    RigHandle out;
    out.name = handle.spec.name;
    out.pinned = handle.spec.pinned;
    out.vertex = static_cast<uint32_t>(handle.vertex);
    out.node = handle.spec.node;
    out.rest_position = PointOf(mesh.shapes[0], handle.vertex);
    tables->handles.push_back(out);
  }
}

// What the loader would make of the baked file, straight from memory.
void FillSkinMesh(const RawCharacter& raw, const geometry::SolveMesh& mesh,
                  const Eigen::MatrixXd& weights, const RigSpace& space, SkinMesh* skin) {
  skin->num_solve_vertices = static_cast<uint32_t>(mesh.num_vertices());
  skin->num_draw_vertices = static_cast<uint32_t>(raw.num_draw_vertices());
  skin->num_handles = static_cast<int32_t>(weights.cols());
  skin->num_shapes = mesh.num_shapes();
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    for (Eigen::Index h = 0; h < weights.cols(); ++h) {
      skin->weights.push_back(static_cast<float>(weights(v, h)));
    }
  }
  const Eigen::Map<const Eigen::Matrix3f> basis(space.basis.data());
  const Eigen::Map<const Eigen::RowVector3f> origin(space.origin.data());
  for (const geometry::PointMatrix& shape : mesh.shapes) {
    const geometry::PointMatrix local = (shape.rowwise() - origin.cast<double>()) *
                                        basis.cast<double>() / static_cast<double>(space.scale);
    for (int v = 0; v < mesh.num_vertices(); ++v)
      skin->shape_positions.push_back(PointOf(local, v));
  }
  skin->solve_vertex = mesh.solve_vertex;
  skin->triangles = raw.triangles;
  skin->primitives = raw.primitives;
  skin->rest_normals = raw.normals;
  skin->rest_tangents = raw.tangents;
  skin->texcoords = raw.texcoords;
  skin->source_vertex = raw.source_vertex;
  skin->num_source_vertices = raw.num_source_vertices;
  CompleteRestFrames(space.basis, skin);
}

bool HasStiffness(const RawCharacter& raw, const Vector<ResolvedHandle>& handles) {
  return !raw.stiffness.empty() ||
         std::any_of(handles.begin(), handles.end(),
                     [](const ResolvedHandle& handle) { return handle.spec.stiffness != 1; });
}

// What was painted, times the handles' stiffnesses, mixed as the skin mixes their transforms but in
// proportions: a vertex half way between 1 and 100 gets 10. Draw vertices that were welded count
// alike. V, in logarithms until the end.
Eigen::VectorXd VertexStiffness(const RawCharacter& raw, const geometry::SolveMesh& mesh,
                                const Vector<ResolvedHandle>& handles,
                                const Eigen::MatrixXd& weights) {
  Eigen::VectorXd of_handles(weights.cols());
  for (Eigen::Index h = 0; h < weights.cols(); ++h)
    of_handles[h] = std::log(handles[static_cast<size_t>(h)].spec.stiffness);
  Eigen::VectorXd painted = Eigen::VectorXd::Zero(weights.rows());
  Eigen::VectorXd counts = painted;
  for (size_t d = 0; d < raw.stiffness.size(); ++d) {
    painted[mesh.solve_vertex[d]] += std::log(static_cast<double>(raw.stiffness[d]));
    counts[mesh.solve_vertex[d]] += 1;
  }
  return (weights * of_handles + painted.cwiseQuotient(counts.cwiseMax(1))).array().exp();
}

// One bake, stage by stage; each leaves what the later ones need.
class BakeRun {
 public:
  BakeRun(const RawCharacter& raw, const BakeOptions& options, const ProgressCallback& progress)
      : raw_(raw),
        options_(options),
        clock_(progress, &baked_.timings) {}

  Result<BakedCharacter> Run(std::span<const HandleSpec> handles) {
    LIMBER_RETURN_IF_ERROR(Prepare(handles));
    LIMBER_RETURN_IF_ERROR(FindWeights());
    LIMBER_RETURN_IF_ERROR(Begin("reach", 0.6, 0.65));
    tables().handle_reach = HandleReach(
        mesh_, handle_vertices_, static_cast<double>(tables().space.scale), options_.num_threads);
    LIMBER_RETURN_IF_ERROR(FindGroups());
    LIMBER_RETURN_IF_ERROR(Begin("tensors", 0.7, 1));
    const ReduceInput input{&mesh_,      &weights_,        &edges_,
                            num_groups_, handle_vertices_, options_.num_threads};
    LIMBER_RETURN_IF_ERROR(Reduce(input, clock_.Inner(), &tables(), &baked_.local_factors));
    FillSkinMesh(raw_, mesh_, weights_, tables().space, &baked_.mesh);
    const auto packed = PackRigTables(tables(), baked_.local_factors);
    if (!packed.ok()) return packed.status().WithContext(raw_.name);
    baked_.cost =
        EstimateCost(tables(), NumBytes(*packed), mesh_.num_vertices(), raw_.num_draw_vertices());
    clock_.End();
    return std::move(baked_);
  }

 private:
  RigTables& tables() { return baked_.tables; }

  Status Begin(const char* stage, double from, double to) {
    if (clock_.Begin(stage, from, to)) return {};
    return Error(StatusCode::kInvalidArgument, "cancelled");
  }

  // Everything that can be refused is refused here, before the minutes of work.
  Status Prepare(std::span<const HandleSpec> handles) {
    LIMBER_RETURN_IF_ERROR(CheckRaw(raw_));
    LIMBER_RETURN_IF_ERROR(Begin("weld", 0, 0.02));
    mesh_ =
        geometry::WeldMesh(raw_.shapes, raw_.triangles, kWeldTolerance * Diagonal(raw_.shapes[0]));
    if (mesh_.triangles.empty()) {
      return Error(StatusCode::kDegenerate, "mesh '%s' has no triangle with three corners",
                   raw_.name.c_str());
    }
    geometry::ConnectComponents(&mesh_);
    Result<Vector<ResolvedHandle>> resolved = ResolveHandles(raw_, mesh_, handles);
    if (!resolved.ok()) return resolved.status();
    resolved_ = std::move(resolved).value();
    for (const ResolvedHandle& handle : resolved_)
      handle_vertices_.push_back(handle.vertex);
    tables().space = FitRigSpace(mesh_.shapes, &tables().dimension);
    tables().shape_names.assign(raw_.shape_names.begin(), raw_.shape_names.end());
    tables().has_rotations = options_.rotations;
    FillHandles(mesh_, resolved_, &tables());
    for (const ResolvedHandle& handle : resolved_)
      baked_.handle_stiffness.push_back(handle.spec.stiffness);
    tables().num_groups =
        options_.num_groups > 0 ? options_.num_groups : kGroupsPerHandle * tables().num_handles();
    LIMBER_RETURN_IF_ERROR(
        CheckRigSize(SizeOf(tables(), mesh_.num_vertices(), raw_.num_draw_vertices())));
    baked_.warnings = ReviewExamples(mesh_.shapes, raw_.shape_names, options_.rotations);
    return {};
  }

  Result<Eigen::MatrixXd> ComputeWeights() {
    if (raw_.painted_weights.rows() > 0)
      return CompletePaintedWeights(mesh_, tables().num_handles(), raw_.painted_weights);
    if (options_.weights == WeightKind::kHeat)
      return HeatWeights(mesh_, handle_vertices_, options_.num_threads, clock_.Inner());
    return BoundedBiharmonicWeights(mesh_, handle_vertices_, options_.num_threads, clock_.Inner(),
                                    &baked_.weights);
  }

  Status FindWeights() {
    LIMBER_RETURN_IF_ERROR(Begin("weights", 0.02, 0.6));
    Result<Eigen::MatrixXd> weights = ComputeWeights();
    if (!weights.ok()) return weights.status();
    weights_ = std::move(weights).value();
    WarnOfWeights();
    if (raw_.painted_weights.rows() == 0) HoldSmallParts(mesh_, handle_vertices_, &weights_);
    baked_.influences = PruneInfluences(options_.influences, &weights_);
    // The runtime skins with single-precision weights: the tensors are summed over the same ones.
    weights_ = weights_.cast<float>().cast<double>();
    return {};
  }

  void WarnOfWeights() {
    for (size_t h = 0; h < baked_.weights.handles.size(); ++h) {
      const HandleOptimality& optimality = baked_.weights.handles[h];
      if (optimality.converged) continue;
      char text[256];
      std::snprintf(
          text, sizeof text,
          "handle '%s': rounding stopped its weights short of their optimum (residual %.1g); "
          "the mesh has triangles too badly shaped for more",
          tables().handles[h].name.c_str(), optimality.stationarity);
      baked_.warnings.emplace_back(text);
    }
  }

  Status FindGroups() {
    LIMBER_RETURN_IF_ERROR(Begin("edge groups", 0.65, 0.7));
    Vector<int>& groups = baked_.vertex_groups;
    groups = ClusterVertices(weights_, tables().num_groups, &num_groups_, options_.num_threads);
    ConnectGroups(mesh_, weights_, num_groups_, &groups);
    edges_ = BuildGroupEdges(mesh_, groups);
    if (HasStiffness(raw_, resolved_))
      ScaleEdges(VertexStiffness(raw_, mesh_, resolved_, weights_), &edges_);
    return {};
  }

  const RawCharacter& raw_;
  const BakeOptions& options_;
  BakedCharacter baked_;
  StageClock clock_;
  geometry::SolveMesh mesh_;
  Vector<ResolvedHandle> resolved_;
  Vector<int> handle_vertices_;  // [H] solve vertices
  Eigen::MatrixXd weights_;      // V x H
  Vector<geometry::GroupEdge> edges_;
  int num_groups_ = 0;
};

}  // namespace

Result<BakedCharacter> Bake(const RawCharacter& raw, std::span<const HandleSpec> handles,
                            const BakeOptions& options, const ProgressCallback& progress) {
  Result<BakedCharacter> baked = BakeRun(raw, options, progress).Run(handles);
  if (baked.ok() || raw.file.empty()) return baked;
  return baked.status().WithContext(raw.file);
}

}  // namespace limber::bake
