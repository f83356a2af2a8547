#include "bake/rig_cost.h"

#include "core/vector.h"
#include "rig/rig_fields.h"

#include <algorithm>

namespace limber::bake {
namespace {

constexpr int64_t kAttributeFloats = 4;  // weights travel in fours (conventions of the extension)

// Numbers of all tables, padding not counted: VisitRigTables told for empty vectors.
uint64_t NumTableFloats(const RigTables& tables) {
  uint64_t count = 0;
  VisitRigTables(tables, [&count](const char*, const Vector<float>&, const Vector<int64_t>& shape) {
    count += static_cast<uint64_t>(NumElements(shape));
  });
  return count;
}

// Tables of that size without their numbers, every rank as large as it can be.
RigTables LargestTables(const RigSize& size) {
  RigTables tables;
  tables.dimension = size.dimension;
  tables.num_groups = size.num_groups;
  tables.has_rotations = size.rotations;
  tables.handles.resize(static_cast<size_t>(size.num_handles));
  tables.shape_names.resize(static_cast<size_t>(size.num_shapes));
  tables.num_modes = std::max(0, tables.num_transform_rows() - 1);
  tables.num_single_modes = std::max(0, size.num_handles * (size.dimension + 1) - 1);
  tables.residual_rank = size.num_groups * size.num_shapes * (size.rotations ? size.dimension : 1);
  return tables;
}

uint64_t Squared(uint64_t number) {
  return number * number;
}

// The tables of PoseModel (solve/pose_model.h), by their shapes; what is small is left out.
uint64_t ModelBytes(const RigTables& tables) {
  const auto k = static_cast<uint64_t>(tables.dimension);
  const auto shapes = static_cast<uint64_t>(tables.num_shapes());
  const uint64_t blocks = static_cast<uint64_t>(tables.num_groups) * shapes;
  const auto rows = static_cast<uint64_t>(tables.num_transform_rows());
  const auto single = static_cast<uint64_t>(tables.num_single_modes) + k;
  // F^T F in double, and once more in single precision where there are rotations; each group's own
  // part of H; the response of the transforms.
  uint64_t bytes = tables.has_rotations ? Squared(blocks * k) * (sizeof(double) + sizeof(float)) +
                                              blocks * shapes * k * k * sizeof(double)
                                        : Squared(blocks) * sizeof(double);
  bytes += blocks * rows * k * sizeof(float);
  // Edges both ways round, and the triangular factors, eight rows at a time.
  if (shapes > 1) bytes += blocks * (2 * k * single + single * (single + 8) / 2) * sizeof(float);
  return bytes;
}

// Fitted to the growth table of tests/benchmarks/README.md: each block costs its share of the
// handles' transforms, and of the sum over the others.
double AlternationSeconds(const RigSize& size) {
  const double handles = size.num_handles, groups = size.num_groups;
  const double blocks = groups * size.num_shapes;
  if (size.num_shapes == 1) return 0.16e-6 * groups;
  return blocks * (0.08 + 0.024 * handles + 0.0004 * blocks) * 1e-6;
}

// What a state with lent scratch memory keeps (solve/pose_workspaces.h): B, R and P of the blocks,
// each shape's own R and modes, matrices. Blocks and groups come in eights.
uint64_t CharacterBytes(const RigTables& tables) {
  const auto eights = [](uint64_t count) { return (count + 7) / 8 * 8; };
  const auto k = static_cast<uint64_t>(tables.dimension);
  const auto shapes = static_cast<uint64_t>(tables.num_shapes());
  const auto groups = static_cast<uint64_t>(tables.num_groups);
  const uint64_t blocks = eights(groups * shapes);
  const uint64_t modes = eights(static_cast<uint64_t>(tables.num_single_modes) + k);
  const uint64_t doubles = blocks * (2 + 2 * k * k) + shapes * k * (eights(groups) * k + modes);
  return doubles * sizeof(double) +
         static_cast<uint64_t>(tables.num_handles()) * shapes * 12 * sizeof(float);
}

// No more than what pack_tables.h makes of tables of that size: the residual is a trapezoid, and
// what follows from the groups' own factors is not there.
uint64_t MostTableBytes(const RigTables& tables) {
  const auto rank = static_cast<uint64_t>(tables.residual_rank);
  const uint64_t left_out =
      static_cast<uint64_t>(tables.num_groups) * static_cast<uint64_t>(tables.num_shapes()) *
          static_cast<uint64_t>(tables.dimension) * static_cast<uint64_t>(tables.num_single_modes) +
      rank * (rank - std::min<uint64_t>(rank, 1)) / 2;
  return (NumTableFloats(tables) - left_out) * sizeof(float);
}

RigCost Estimate(const RigSize& size, const RigTables& tables, uint64_t table_bytes) {
  RigCost cost;
  const auto vertices = static_cast<uint64_t>(size.num_vertices);
  const auto draw_vertices = static_cast<uint64_t>(size.num_draw_vertices);
  const auto handles = static_cast<uint64_t>(size.num_handles);
  const uint64_t attribute_floats =
      (handles + kAttributeFloats - 1) / kAttributeFloats * kAttributeFloats;
  // Of each draw vertex the weights, the weld and the edge group.
  cost.file_bytes = table_bytes + draw_vertices * (attribute_floats + 2) * sizeof(float);
  cost.model_bytes = NumTableFloats(tables) * sizeof(float) + ModelBytes(tables);
  cost.mesh_bytes =
      vertices * (handles + 3 * static_cast<uint64_t>(size.num_shapes)) * sizeof(float);
  cost.character_bytes = CharacterBytes(tables);
  cost.alternation_seconds = AlternationSeconds(size);
  return cost;
}

}  // namespace

RigSize SizeOf(const RigTables& tables, int64_t num_vertices, int64_t num_draw_vertices) {
  return {tables.dimension,     tables.num_handles(), tables.num_shapes(), tables.num_groups,
          tables.has_rotations, num_vertices,         num_draw_vertices};
}

RigCost EstimateCost(const RigSize& size) {
  const RigTables tables = LargestTables(size);
  return Estimate(size, tables, MostTableBytes(tables));
}

RigCost EstimateCost(const RigTables& tables, uint64_t table_bytes, int64_t num_vertices,
                     int64_t num_draw_vertices) {
  return Estimate(SizeOf(tables, num_vertices, num_draw_vertices), tables, table_bytes);
}

Status CheckRigSize(const RigSize& size) {
  const int64_t axes = size.rotations ? size.dimension : 1;
  const int64_t columns = int64_t{size.num_groups} * size.num_shapes * axes;
  if (columns <= kMostRigColumns) return {};
  const int64_t groups = kMostRigColumns / (size.num_shapes * axes);
  const char* also = size.rotations ? ", or --no-rotations" : "";
  if (groups < 1) {
    return Error(StatusCode::kLimitExceeded,
                 "rig: %d shapes are too many even with one edge group; leave some out%s",
                 size.num_shapes, also);
  }
  return Error(StatusCode::kLimitExceeded,
               "rig: %d edge groups times %d shapes%s are too many for the solver; use --groups "
               "%lld or fewer%s",
               size.num_groups, size.num_shapes, size.rotations ? " with rotations" : "",
               static_cast<long long>(groups), also);
}

}  // namespace limber::bake
