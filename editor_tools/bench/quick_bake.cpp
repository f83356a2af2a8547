#include "bench/quick_bake.h"

#include "bake/edge_groups.h"
#include "bake/reduce.h"
#include "bake/resolve_handles.h"
#include "bake/rig_space.h"
#include "bench/smooth_weights.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "rig/rest_frames.h"

namespace limber::bench {
namespace {

using bake::PointMatrix;
using bake::RawCharacter;

geometry::SolveMesh Weld(const RawCharacter& raw) {
  const PointMatrix& rest = raw.shapes[0];
  const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 1e-6 * diagonal);
  geometry::ConnectComponents(&mesh);
  return mesh;
}

void FillHandles(const geometry::SolveMesh& mesh, const Vector<bake::ResolvedHandle>& resolved,
                 RigTables* tables) {
  for (const bake::ResolvedHandle& wish : resolved) {
    RigHandle handle;
    handle.name = wish.spec.name;
    handle.pinned = wish.spec.pinned;
    handle.vertex = static_cast<uint32_t>(wish.vertex);
    for (int axis = 0; axis < 3; ++axis)
      handle.rest_position[axis] = static_cast<float>(mesh.shapes[0](wish.vertex, axis));
    tables->handles.push_back(handle);
  }
}

SkinMesh MakeSkinMesh(const RawCharacter& raw, const geometry::SolveMesh& mesh,
                      const Eigen::MatrixXd& weights, const RigSpace& space) {
  SkinMesh skin;
  skin.num_solve_vertices = static_cast<uint32_t>(mesh.num_vertices());
  skin.num_draw_vertices = static_cast<uint32_t>(raw.num_draw_vertices());
  skin.num_handles = static_cast<int32_t>(weights.cols());
  skin.num_shapes = mesh.num_shapes();
  for (const auto& row : weights.rowwise()) {
    for (const double weight : row)
      skin.weights.push_back(static_cast<float>(weight));
  }
  const Eigen::Map<const Eigen::Matrix3f> basis(space.basis.data());
  const Eigen::Map<const Eigen::Vector3f> origin(space.origin.data());
  for (const PointMatrix& shape : mesh.shapes) {
    for (const auto& row : shape.rowwise()) {
      const Eigen::Vector3f point =
          basis.transpose() * (row.transpose().cast<float>() - origin) / space.scale;
      skin.shape_positions.push_back({point.x(), point.y(), point.z()});
    }
  }
  skin.solve_vertex = mesh.solve_vertex;
  skin.triangles = raw.triangles;
  skin.primitives = raw.primitives;
  skin.source_vertex = raw.source_vertex;
  skin.num_source_vertices = raw.num_source_vertices;
  CompleteRestFrames(space.basis, &skin);
  return skin;
}

}  // namespace

Result<bake::BakedCharacter> BakeQuickly(const RawCharacter& raw,
                                         std::span<const bake::HandleSpec> handles,
                                         const bake::BakeOptions& options,
                                         const bake::ProgressCallback& progress) {
  const geometry::SolveMesh mesh = Weld(raw);
  const auto resolved = bake::ResolveHandles(raw, mesh, handles);
  if (!resolved.ok()) return resolved.status();
  bake::BakedCharacter baked;
  RigTables& tables = baked.tables;
  tables.space = bake::FitRigSpace(mesh.shapes, &tables.dimension);
  tables.shape_names.assign(raw.shape_names.begin(), raw.shape_names.end());
  tables.has_rotations = options.rotations;
  FillHandles(mesh, *resolved, &tables);
  bake::ReduceInput input;
  for (const bake::ResolvedHandle& handle : *resolved)
    input.handle_vertices.push_back(handle.vertex);
  // The runtime skins with single-precision weights: the tensors are summed over the same ones.
  const Eigen::MatrixXd weights =
      SmoothWeights(mesh.shapes[0], input.handle_vertices).cast<float>().cast<double>();
  const int wanted = options.num_groups > 0 ? options.num_groups : 2 * tables.num_handles();
  const Vector<int> groups = bake::ClusterVertices(weights, wanted, &input.num_groups);
  const Vector<geometry::GroupEdge> edges = bake::BuildGroupEdges(mesh, groups);
  input.mesh = &mesh;
  input.weights = &weights;
  input.edges = &edges;
  LIMBER_RETURN_IF_ERROR(bake::Reduce(input, progress, &tables, &baked.local_factors));
  baked.mesh = MakeSkinMesh(raw, mesh, weights, tables.space);
  return baked;
}

}  // namespace limber::bench
