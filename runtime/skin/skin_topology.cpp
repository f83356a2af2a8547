#include "skin/skin_topology.h"

#include "core/out_of_memory.h"
#include "core/vector.h"
#include "skin/skin_frames.h"
#include "skin/skin_layout.h"
#include "skin/vec3_math.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace limber {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

// The first example shape in mesh units and mesh orientation, without the origin.
Vector<Vec3> RestPositions(const SkinMesh& mesh, const RigSpace& space) {
  Vector<Vec3> rest(mesh.num_solve_vertices);
  const auto& m = space.basis;
  for (size_t v = 0; v < rest.size(); ++v) {
    const Vec3 p = mesh.shape_positions[v];
    rest[v] = space.scale * Vec3{m[0] * p.x + m[3] * p.y + m[6] * p.z,
                                 m[1] * p.x + m[4] * p.y + m[7] * p.z,
                                 m[2] * p.x + m[5] * p.y + m[8] * p.z};
  }
  return rest;
}

// The authored normal, or none (zero) where it is absent, zero or not finite.
Vec3 RestNormal(const SkinMesh& mesh, size_t d) {
  if (mesh.rest_normals.empty()) return {};
  const Vec3 n = mesh.rest_normals[d];
  const float length = std::sqrt(Dot(n, n));
  return std::isfinite(length) && length > 1e-6f ? (1 / length) * n : Vec3{};
}

// Groups draw vertices; those of one solve vertex are compared with the first of each group of it.
void AssignGroups(const SkinMesh& mesh, const Vector<Vec3>& normals, SkinTopology* topology) {
  Vector<uint32_t> first_group(mesh.num_solve_vertices, kNone);  // list of a solve vertex
  Vector<uint32_t> next_group;
  Vector<Vec3> group_normal;
  for (uint32_t d = 0; d < mesh.num_draw_vertices; ++d) {
    const uint32_t v = mesh.solve_vertex[d];
    uint32_t group = first_group[v];
    const auto agrees = [&](uint32_t g) {
      return normals[d] == group_normal[g] || Dot(normals[d], group_normal[g]) > kNormalGroupCosine;
    };
    while (group != kNone && !agrees(group))
      group = next_group[group];
    if (group == kNone) {
      group = static_cast<uint32_t>(group_normal.size());
      group_normal.push_back(normals[d]);
      topology->group_solve_vertex.push_back(v);
      next_group.push_back(first_group[v]);
      first_group[v] = group;
    }
    topology->draw_vertices[d].solve_vertex = v;
    topology->draw_vertices[d].normal_group = group;
  }
}

// Calls visit(group, a, b) for each corner of each triangle: the group of its draw vertex and the
// solve vertices of the other two, in order. Triangles that weld to fewer than three corners have
// no area and are passed over.
template <class Visitor>
void VisitCorners(const SkinMesh& mesh, const SkinTopology& topology, Visitor&& visit) {
  for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const uint32_t* triangle = mesh.triangles.data() + t;
    const uint32_t v[3] = {mesh.solve_vertex[triangle[0]], mesh.solve_vertex[triangle[1]],
                           mesh.solve_vertex[triangle[2]]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (size_t i = 0; i < 3; ++i) {
      visit(topology.draw_vertices[triangle[i]].normal_group, v[(i + 1) % 3], v[(i + 2) % 3]);
    }
  }
}

// Lists the triangles of each group: counted, then stored where the counts say.
void ListCorners(const SkinMesh& mesh, SkinTopology* topology) {
  Vector<uint32_t>& starts = topology->group_corners;
  starts.assign(size_t{topology->num_groups()} + 1, 0);
  VisitCorners(mesh, *topology,
               [&](uint32_t group, uint32_t, uint32_t) { ++starts[size_t{group} + 1]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  topology->corners.resize(starts.back());
  Vector<uint32_t> fill(starts.begin(), starts.end() - 1);
  VisitCorners(mesh, *topology, [&](uint32_t group, uint32_t a, uint32_t b) {
    SkinCorner& corner = topology->corners[fill[group]++];
    corner.a = a;
    corner.b = b;
  });
}

struct Vector3d {
  double x = 0, y = 0, z = 0;
};

Vector3d Wide(Vec3 v) {
  return {v.x, v.y, v.z};
}

double Dot(const Vector3d& a, const Vector3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

float NarrowOrZero(double x) {
  return std::abs(x) <= double{std::numeric_limits<float>::max()} ? static_cast<float>(x) : 0.0f;
}

// Coefficients of one group: each triangle writes the directions, projected into its plane, in its
// two edges; triangles are weighted by squared area. Solving with the Gram matrix divides by that
// same squared area, so nothing is divided by and a triangle without area weighs nothing. Triangles
// that are out of proportion to each other by more than single precision holds weigh nothing
// either.
void FitCorners(const Vector<Vec3>& rest, Vec3 first, Vec3 second, uint32_t group,
                SkinTopology* topology) {
  const uint32_t begin = topology->group_corners[group], end = topology->group_corners[group + 1];
  const Vec3 centre = rest[topology->group_solve_vertex[group]];
  const Vector3d directions[2] = {Wide(first), Wide(second)};
  double total = 0;
  for (const bool summing : {true, false}) {
    for (uint32_t c = begin; c < end; ++c) {
      SkinCorner& corner = topology->corners[c];
      const Vector3d e1 = Wide(topology->inverse_scale * (rest[corner.a] - centre));
      const Vector3d e2 = Wide(topology->inverse_scale * (rest[corner.b] - centre));
      const double g11 = Dot(e1, e1), g12 = Dot(e1, e2), g22 = Dot(e2, e2);
      if (summing) {
        total += std::max(0.0, g11 * g22 - g12 * g12);
        continue;
      }
      for (int i = 0; i < 2; ++i) {
        const double r1 = Dot(e1, directions[i]), r2 = Dot(e2, directions[i]);
        float* out = i == 0 ? corner.first : corner.second;
        out[0] = NarrowOrZero((g22 * r1 - g12 * r2) / total);
        out[1] = NarrowOrZero((g11 * r2 - g12 * r1) / total);
      }
    }
    if (!(total > 1e-60) || !std::isfinite(total)) return;  // all coefficients stay zero
  }
}

// Writes the authored normal and tangent of a draw vertex in the frame of its group at rest.
void StoreInFrame(const SurfaceFrame& frame, Vec3 normal, const float* tangent,
                  SkinDrawVertex* vertex) {
  const bool authored = Dot(normal, normal) > 0;
  if (frame.valid != 0) {
    vertex->normal = authored
                         ? Vec3{Dot(frame.t, normal), Dot(frame.b, normal), Dot(frame.n, normal)}
                         : Vec3{0, 0, 1};
  } else {
    vertex->normal = authored ? normal : Vec3{0, 0, 1};
  }
  vertex->tangent[0] = 1;
  if (tangent == nullptr) return;
  vertex->handedness = tangent[3] < 0 ? -1.0f : 1.0f;
  if (frame.valid == 0) return;
  // In the plane that ApplyFrame projects to (that of the authored normal, not of the surface), so
  // that at rest the authored tangent comes back exactly.
  const Vec3 n = authored ? normal : frame.n;
  const Vec3 tilted = frame.t - Dot(n, frame.t) * n;
  const Vec3 u = (1 / std::sqrt(Dot(tilted, tilted))) * tilted, w = Cross(n, u);
  const Vec3 wanted{tangent[0], tangent[1], tangent[2]};
  const float a = Dot(frame.first, u), b = Dot(frame.second, u);
  const float c = Dot(frame.first, w), d = Dot(frame.second, w);
  const float x = Dot(wanted, u), y = Dot(wanted, w);
  const float det = a * d - b * c;
  const float first = (d * x - b * y) / det, second = (a * y - c * x) / det;
  if (!std::isfinite(first) || !std::isfinite(second)) return;
  vertex->tangent[0] = first;
  vertex->tangent[1] = second;
}

// Two orthonormal tangent directions of a group at rest. Any will do; zero where there is no area.
void ChooseDirections(const SurfaceFrame& frame, Vec3* first, Vec3* second) {
  *first = frame.valid != 0 ? frame.t : Vec3{};
  *second = frame.valid != 0 ? frame.b : Vec3{};
}

Result<SkinTopology> BuildTopology(const SkinMesh& mesh, const RigSpace& space) {
  LIMBER_RETURN_IF_ERROR(CheckSkinMesh(mesh));
  if (!(space.scale > 0) || !std::isfinite(1 / space.scale)) {
    return Error(StatusCode::kMalformed, "rig space: scale is %g, expected a positive number",
                 static_cast<double>(space.scale));
  }
  SkinTopology topology;
  topology.inverse_scale = 1 / space.scale;
  topology.has_tangents = !mesh.rest_tangents.empty();
  topology.draw_vertices.resize(mesh.num_draw_vertices);

  Vector<Vec3> normals(mesh.num_draw_vertices);
  for (size_t d = 0; d < normals.size(); ++d)
    normals[d] = RestNormal(mesh, d);
  AssignGroups(mesh, normals, &topology);
  ListCorners(mesh, &topology);

  const Vector<Vec3> rest = RestPositions(mesh, space);
  Vector<SurfaceFrame> frames(topology.num_groups());
  for (uint32_t g = 0; g < topology.num_groups(); ++g) {
    Vec3 first, second;
    ChooseDirections(ComputeSurfaceFrame(topology, g, rest), &first, &second);
    FitCorners(rest, first, second, g, &topology);
    frames[g] = ComputeSurfaceFrame(topology, g, rest);
  }
  for (size_t d = 0; d < normals.size(); ++d) {
    SkinDrawVertex& vertex = topology.draw_vertices[d];
    StoreInFrame(frames[vertex.normal_group], normals[d],
                 topology.has_tangents ? mesh.rest_tangents.data() + 4 * d : nullptr, &vertex);
  }
  return topology;
}

}  // namespace

Result<SkinTopology> BuildSkinTopology(const SkinMesh& mesh, const RigSpace& space) {
  return CatchOutOfMemory("skin mesh", [&] { return BuildTopology(mesh, space); });
}

}  // namespace limber
