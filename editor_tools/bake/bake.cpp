#include "bake/bake.h"

#include "bake/edge_groups.h"
#include "bake/handle_reach.h"
#include "bake/reduce.h"
#include "bake/resolve_handles.h"
#include "bake/rig_space.h"
#include "bake/skinning_weights.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "rig/rest_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace limber::bake {
namespace {

// Draw vertices closer than this fraction of the diagonal in every shape are one point: above the
// rounding of 16-bit quantised positions, below any detail that is drawn on purpose.
constexpr double kWeldTolerance = 1e-6;

// Names the stage that runs, measures it, and asks whether to go on.
class StageClock {
 public:
  StageClock(const ProgressCallback& progress, std::vector<BakeTiming>* timings)
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
  std::vector<BakeTiming>* timings_;
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

void FillHandles(const geometry::SolveMesh& mesh, const std::vector<ResolvedHandle>& resolved,
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

bool HasStiffness(const std::vector<ResolvedHandle>& handles) {
  return std::any_of(handles.begin(), handles.end(),
                     [](const ResolvedHandle& handle) { return handle.spec.stiffness != 1; });
}

// The handles' stiffnesses, mixed as the skin mixes their transforms but in proportions: a vertex
// half way between 1 and 100 gets 10.
Eigen::VectorXd VertexStiffness(const std::vector<ResolvedHandle>& handles,
                                const Eigen::MatrixXd& weights) {
  Eigen::VectorXd logarithms(weights.cols());
  for (Eigen::Index h = 0; h < weights.cols(); ++h)
    logarithms[h] = std::log(handles[static_cast<size_t>(h)].spec.stiffness);
  return (weights * logarithms).array().exp();
}

}  // namespace

Result<BakedCharacter> Bake(const RawCharacter& raw, std::span<const HandleSpec> handles,
                            const BakeOptions& options, const ProgressCallback& progress) {
  const Status cancelled(StatusCode::kInvalidArgument, "cancelled");
  if (Status status = CheckRaw(raw); !status.ok()) return status.WithContext(raw.file);
  BakedCharacter baked;
  RigTables& tables = baked.tables;
  StageClock clock(progress, &baked.timings);

  if (!clock.Begin("weld", 0, 0.02)) return cancelled;
  geometry::SolveMesh mesh =
      geometry::WeldMesh(raw.shapes, raw.triangles, kWeldTolerance * Diagonal(raw.shapes[0]));
  if (mesh.triangles.empty()) {
    return Error(StatusCode::kDegenerate, "%s: mesh '%s' has no triangle with three corners",
                 raw.file.c_str(), raw.name.c_str());
  }
  geometry::ConnectComponents(&mesh);
  Result<std::vector<ResolvedHandle>> resolved = ResolveHandles(raw, mesh, handles);
  if (!resolved.ok()) return resolved.status();
  tables.space = FitRigSpace(mesh.shapes, &tables.dimension);
  tables.shape_names = raw.shape_names;
  tables.has_rotations = options.rotations;
  FillHandles(mesh, *resolved, &tables);

  if (!clock.Begin("weights", 0.02, 0.6)) return cancelled;
  std::vector<int> handle_vertices;
  for (const ResolvedHandle& handle : *resolved)
    handle_vertices.push_back(handle.vertex);
  WeightsReport weights_report;
  Result<Eigen::MatrixXd> weights = BoundedBiharmonicWeights(
      mesh, handle_vertices, options.num_threads, clock.Inner(), &weights_report);
  if (!weights.ok()) return weights.status().WithContext(raw.file);
  // The runtime skins with single-precision weights: the tensors are summed over the same ones.
  *weights = weights->cast<float>().cast<double>();

  if (!clock.Begin("reach", 0.6, 0.65)) return cancelled;
  tables.handle_reach = HandleReach(mesh, handle_vertices, static_cast<double>(tables.space.scale),
                                    options.num_threads);

  if (!clock.Begin("edge groups", 0.65, 0.7)) return cancelled;
  const int wanted =
      options.num_groups > 0 ? options.num_groups : 2 * static_cast<int>(handle_vertices.size());
  ReduceInput input;
  const std::vector<int> groups = ClusterVertices(*weights, wanted, &input.num_groups);
  std::vector<geometry::GroupEdge> edges = BuildGroupEdges(mesh, groups);
  if (HasStiffness(*resolved)) ScaleEdges(VertexStiffness(*resolved, *weights), &edges);
  input.mesh = &mesh;
  input.weights = &*weights;
  input.edges = &edges;
  input.handle_vertices = handle_vertices;

  if (!clock.Begin("tensors", 0.7, 1)) return cancelled;
  if (Status status = Reduce(input, clock.Inner(), &tables); !status.ok()) {
    return status.WithContext(raw.file);
  }
  FillSkinMesh(raw, mesh, *weights, tables.space, &baked.mesh);
  clock.End();
  return baked;
}

}  // namespace limber::bake
