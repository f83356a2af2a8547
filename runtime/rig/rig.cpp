#include "rig/rig.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "core/vector.h"
#include "rig/rig_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace limber {
namespace {

// Published limits: a rig beyond them is a mistake or an attack, not a character.
constexpr int kMaxHandles = 1024;
constexpr int kMaxShapes = 1024;
constexpr int kMaxGroups = 4096;
constexpr int kMaxModes = 16384;
// A row of weights that sums to 1 + e moves its vertex by e rig units with every translation of the
// whole: a visible dent from about 1e-3. The bake's own rows, of weights rounded to floats, are
// within 1e-7 of one for each handle that counts.
constexpr double kWeightSumTolerance = 1e-4;

Status Expect(const char* what, int64_t found, int64_t low, int64_t high) {
  if (found >= low && found <= high) return {};
  return Error(found > high ? StatusCode::kLimitExceeded : StatusCode::kMalformed,
               "%s is %lld; expected %lld to %lld", what, static_cast<long long>(found),
               static_cast<long long>(low), static_cast<long long>(high));
}

Status CheckSize(const char* table, size_t found, size_t expected) {
  if (found == expected) return {};
  return Error(StatusCode::kMalformed, "%s: has %zu elements; expected %zu", table, found,
               expected);
}

Status CheckFinite(const char* table, const float* values, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    if (!std::isfinite(values[i])) {
      return Error(StatusCode::kMalformed, "%s: element %zu is not a finite number", table, i);
    }
  }
  return {};
}

// The same for what has a place on the mesh: `count` vertices of `width` values each.
Status CheckVertices(const char* what, const float* values, size_t count, size_t width) {
  for (size_t i = 0; i < count * width; ++i) {
    if (!std::isfinite(values[i])) {
      return Error(StatusCode::kMalformed, "%s: vertex %zu, component %zu is not a finite number",
                   what, i / width, i % width);
    }
  }
  return {};
}

Status CheckIndices(const char* table, const Vector<uint32_t>& indices, uint32_t limit) {
  const auto bad = std::find_if(indices.begin(), indices.end(),
                                [limit](uint32_t index) { return index >= limit; });
  if (bad == indices.end()) return {};
  return Error(StatusCode::kMalformed, "%s: element %lld is %u; expected below %u", table,
               static_cast<long long>(bad - indices.begin()), *bad, limit);
}

Status CheckSpace(const RigSpace& space) {
  LIMBER_RETURN_IF_ERROR(CheckFinite("space origin", space.origin.data(), 3));
  LIMBER_RETURN_IF_ERROR(CheckFinite("space basis", space.basis.data(), 9));
  if (!std::isfinite(space.scale) || space.scale <= 0) {
    return Error(StatusCode::kMalformed, "space: scale is %g; expected a positive number",
                 static_cast<double>(space.scale));
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      float dot = 0;
      for (int a = 0; a < 3; ++a)
        dot += space.basis[3 * i + a] * space.basis[3 * j + a];
      if (std::abs(dot - (i == j ? 1.0f : 0.0f)) > 1e-3f) {
        return Error(StatusCode::kMalformed, "space: basis columns %d and %d are not orthonormal",
                     j, i);
      }
    }
  }
  return {};
}

Status CheckHandles(const RigTables& tables, const SkinMesh& mesh) {
  std::set<std::string_view> names;
  bool any_pinned = false;
  for (const RigHandle& handle : tables.handles) {
    any_pinned |= handle.pinned;
    if (!names.insert(handle.name).second) {
      return Error(StatusCode::kMalformed, "handle %s: the name is used twice",
                   Quoted(handle.name).c_str());
    }
    if (handle.vertex >= mesh.num_solve_vertices) {
      return Error(StatusCode::kMalformed, "handle %s: vertex %u; expected below %u",
                   Quoted(handle.name).c_str(), handle.vertex, mesh.num_solve_vertices);
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isfinite(handle.rest_position[axis])) continue;
      return Error(StatusCode::kMalformed, "handle %s: its rest position is not finite",
                   Quoted(handle.name).c_str());
    }
  }
  if (any_pinned) return {};
  return Error(StatusCode::kNoHandles,
               "no handle is pinned, so nothing holds the character in place; pin at least one");
}

Status CheckReach(const Vector<float>& reach) {
  const auto bad = std::find_if(reach.begin(), reach.end(), [](float x) { return x < 0; });
  if (bad == reach.end()) return {};
  return Error(StatusCode::kMalformed, "handleReach: element %td is %g; expected zero or more",
               bad - reach.begin(), static_cast<double>(*bad));
}

Status CheckTables(const RigTables& tables) {
  LIMBER_RETURN_IF_ERROR(Expect("dimension", tables.dimension, 2, 3));
  LIMBER_RETURN_IF_ERROR(Expect("number of handles", tables.num_handles(), 1, kMaxHandles));
  LIMBER_RETURN_IF_ERROR(Expect("number of shapes", tables.num_shapes(), 1, kMaxShapes));
  LIMBER_RETURN_IF_ERROR(Expect("number of groups", tables.num_groups, 1, kMaxGroups));
  const int n = tables.num_transform_rows();
  const int num_columns = tables.num_groups * tables.num_shapes() * tables.dimension;
  LIMBER_RETURN_IF_ERROR(Expect("number of modes", tables.num_modes, 0, std::min(n, kMaxModes)));
  LIMBER_RETURN_IF_ERROR(Expect("residual rank", tables.residual_rank, 0, num_columns));
  LIMBER_RETURN_IF_ERROR(Expect("number of single modes", tables.num_single_modes, 0,
                                int64_t{tables.num_handles()} * (tables.dimension + 1)));
  LIMBER_RETURN_IF_ERROR(CheckSpace(tables.space));
  Status status;
  VisitRigTables(tables, [&status](const char* name, const Vector<float>& table,
                                   const Vector<int64_t>& shape) {
    if (!status.ok()) return;
    if (table.empty() && FirstVersionOfTable(name) > kOldestRigFormatVersion) return;
    status = CheckSize(name, table.size(), static_cast<size_t>(NumElements(shape)));
    if (status.ok()) status = CheckFinite(name, table.data(), table.size());
  });
  if (!status.ok()) return status;
  return CheckReach(tables.handle_reach);
}

// Finite, and every row a partition of one: the character then moves with its handles as a whole.
Status CheckWeights(const SkinMesh& mesh) {
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  const size_t num_solve = mesh.num_solve_vertices;
  LIMBER_RETURN_IF_ERROR(
      CheckVertices("skinning weights", mesh.weights.data(), num_solve, num_handles));
  for (size_t v = 0; v < num_solve; ++v) {
    double sum = 0;
    for (size_t h = 0; h < num_handles; ++h)
      sum += double{mesh.weights[v * num_handles + h]};
    if (!(std::abs(sum - 1) <= kWeightSumTolerance)) {
      return Error(StatusCode::kMalformed,
                   "skinning weights: vertex %zu: they sum to %.9g; expected 1 to within %g, bake "
                   "the character again",
                   v, sum, kWeightSumTolerance);
    }
  }
  return {};
}

// What lies on the surface is finite. (Positions: MeasureShapes.)
Status CheckSurface(const SkinMesh& mesh) {
  const size_t num_draw = mesh.num_draw_vertices;
  for (size_t d = 0; d < num_draw; ++d) {
    const Vec3& n = mesh.rest_normals[d];
    if (!std::isfinite(n.x) || !std::isfinite(n.y) || !std::isfinite(n.z)) {
      return Error(StatusCode::kMalformed, "normals: vertex %zu is not finite", d);
    }
  }
  if (!mesh.rest_tangents.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckVertices("tangents", mesh.rest_tangents.data(), num_draw, 4));
  }
  if (mesh.texcoords.empty()) return {};
  return CheckVertices("texture coordinates", mesh.texcoords.data(), num_draw, 2);
}

Status CheckMesh(const SkinMesh& mesh) {
  const size_t num_solve = mesh.num_solve_vertices, num_draw = mesh.num_draw_vertices;
  const auto num_shapes = static_cast<size_t>(mesh.num_shapes);
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  LIMBER_RETURN_IF_ERROR(
      CheckSize("skinning weights", mesh.weights.size(), num_solve * num_handles));
  LIMBER_RETURN_IF_ERROR(
      CheckSize("shape positions", mesh.shape_positions.size(), num_solve * num_shapes));
  LIMBER_RETURN_IF_ERROR(CheckSize("weld", mesh.solve_vertex.size(), num_draw));
  LIMBER_RETURN_IF_ERROR(CheckSize("source vertices", mesh.source_vertex.size(), num_draw));
  LIMBER_RETURN_IF_ERROR(CheckSize("normals", mesh.rest_normals.size(), num_draw));
  if (!mesh.rest_tangents.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckSize("tangents", mesh.rest_tangents.size(), 4 * num_draw));
  }
  if (!mesh.texcoords.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckSize("texture coordinates", mesh.texcoords.size(), 2 * num_draw));
  }
  if (mesh.triangles.size() % 3 != 0) {
    return Error(StatusCode::kMalformed, "triangles: %zu indices; expected a multiple of three",
                 mesh.triangles.size());
  }
  LIMBER_RETURN_IF_ERROR(CheckIndices("weld", mesh.solve_vertex, mesh.num_solve_vertices));
  LIMBER_RETURN_IF_ERROR(CheckIndices("triangles", mesh.triangles, mesh.num_draw_vertices));
  LIMBER_RETURN_IF_ERROR(
      CheckIndices("source vertices", mesh.source_vertex, mesh.num_source_vertices));
  LIMBER_RETURN_IF_ERROR(CheckWeights(mesh));
  LIMBER_RETURN_IF_ERROR(CheckSurface(mesh));
  for (const SkinPrimitive& primitive : mesh.primitives) {
    if (uint64_t{primitive.first_vertex} + primitive.num_vertices > num_draw ||
        uint64_t{primitive.first_triangle} + primitive.num_triangles > mesh.num_triangles()) {
      return Error(StatusCode::kMalformed, "primitive %d: its range ends behind the mesh",
                   primitive.gltf_primitive);
    }
  }
  return {};
}

// Finite positions, and the diagonal of the first shape's box, in rig units.
Result<float> MeasureShapes(const SkinMesh& mesh) {
  Vec3 low = {1e30f, 1e30f, 1e30f}, high = {-1e30f, -1e30f, -1e30f};
  const size_t vertices = std::max(mesh.num_solve_vertices, 1u);
  for (size_t i = 0; i < mesh.shape_positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float x = mesh.shape_positions[i][axis];
      if (!std::isfinite(x)) {
        return Error(StatusCode::kMalformed, "shape %zu, vertex %zu: position is not finite",
                     i / vertices, i % vertices);
      }
      if (i < vertices) {
        low[axis] = std::min(low[axis], x);
        high[axis] = std::max(high[axis], x);
      }
    }
  }
  const float dx = high.x - low.x, dy = high.y - low.y, dz = high.z - low.z;
  const float diagonal = std::sqrt(dx * dx + dy * dy + dz * dz);
  if (!(diagonal > 0) || !std::isfinite(diagonal))
    return Error(StatusCode::kDegenerate,
                 "the first shape has no extent, or one that is not a number");
  return diagonal;
}

// The diagonal of the first shape's box, in mesh units, of a character in which all is well.
Result<float> CheckAll(const RigTables& tables, const SkinMesh& mesh) {
  LIMBER_RETURN_IF_ERROR(CheckTables(tables));
  if (mesh.num_handles != tables.num_handles() || mesh.num_shapes != tables.num_shapes()) {
    return Error(StatusCode::kMalformed, "mesh has %d handles and %d shapes, its tables %d and %d",
                 mesh.num_handles, mesh.num_shapes, tables.num_handles(), tables.num_shapes());
  }
  LIMBER_RETURN_IF_ERROR(CheckMesh(mesh));
  LIMBER_RETURN_IF_ERROR(CheckHandles(tables, mesh));
  Result<float> diagonal = MeasureShapes(mesh);
  if (!diagonal.ok()) return diagonal;
  *diagonal *= tables.space.scale;
  if (*diagonal > 0 && std::isfinite(*diagonal)) return diagonal;
  return Error(StatusCode::kDegenerate, "space: at scale %g the character has no size",
               static_cast<double>(tables.space.scale));
}

}  // namespace

Result<std::shared_ptr<const Rig>> Rig::Create(std::string name, RigTables tables, SkinMesh mesh) {
  return CatchOutOfMemory("rig", [&]() -> Result<std::shared_ptr<const Rig>> {
    Result<float> diagonal = CheckAll(tables, mesh);
    if (!diagonal.ok()) return diagonal.status().WithContext(Printable(name));
    std::shared_ptr<Rig> rig = Share(new Rig());
    rig->name_.assign(name);
    rig->tables_ = std::move(tables);
    rig->mesh_ = std::move(mesh);
    rig->diagonal_ = *diagonal;
    return std::shared_ptr<const Rig>(std::move(rig));
  });
}

int Rig::FindHandle(std::string_view handle_name) const {
  for (int h = 0; h < num_handles(); ++h) {
    if (tables_.handles[static_cast<size_t>(h)].name == handle_name) return h;
  }
  return -1;
}

Vec3 Rig::ToMesh(Vec3 x_rig) const {
  const RigSpace& space = tables_.space;
  Vec3 x_mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const float turned = space.basis[axis] * x_rig.x + space.basis[3 + axis] * x_rig.y +
                         space.basis[6 + axis] * x_rig.z;
    x_mesh[axis] = space.origin[axis] + space.scale * turned;
  }
  return x_mesh;
}

Vec3 Rig::ToRig(Vec3 x_mesh) const {
  const RigSpace& space = tables_.space;
  Vec3 x_rig;
  for (int axis = 0; axis < 3; ++axis) {
    float turned = 0;
    for (int a = 0; a < 3; ++a) {
      turned += space.basis[3 * axis + a] * (x_mesh[a] - space.origin[a]);
    }
    x_rig[axis] = turned / space.scale;
  }
  return x_rig;
}

}  // namespace limber
