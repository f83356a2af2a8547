#include "rig/rest_frames.h"

#include "core/vector.h"

#include <cmath>

namespace limber {
namespace {

Vec3 Subtract(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

Vec3 AddScaled(Vec3 a, Vec3 b, float f) {
  return {a.x + f * b.x, a.y + f * b.y, a.z + f * b.z};
}

float Dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec3 Cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// `fallback` where the vector has no direction, or is too long for its square.
Vec3 Normalised(Vec3 v, Vec3 fallback) {
  const float length = std::sqrt(Dot(v, v));
  if (!(length > 1e-30f) || !std::isfinite(length)) return fallback;
  return {v.x / length, v.y / length, v.z / length};
}

Vec3 Turn(const std::array<float, 9>& basis, Vec3 v) {
  Vec3 turned;
  for (int a = 0; a < 3; ++a) {
    turned[a] = basis[a] * v.x + basis[3 + a] * v.y + basis[6 + a] * v.z;
  }
  return turned;
}

Vec3 AnyOrthogonal(Vec3 normal) {
  const Vec3 axis = std::abs(normal.x) < 0.9f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return Normalised(Cross(normal, Cross(axis, normal)), {1, 0, 0});
}

void ComputeNormals(const std::array<float, 9>& basis, SkinMesh* mesh) {
  Vector<Vec3> sums(mesh->num_solve_vertices);
  for (size_t t = 0; t < mesh->triangles.size(); t += 3) {
    uint32_t corner[3];
    for (size_t c = 0; c < 3; ++c)
      corner[c] = mesh->solve_vertex[mesh->triangles[t + c]];
    const Vec3 a = mesh->shape_positions[corner[0]];
    const Vec3 area = Cross(Subtract(mesh->shape_positions[corner[1]], a),
                            Subtract(mesh->shape_positions[corner[2]], a));
    for (uint32_t vertex : corner)
      sums[vertex] = AddScaled(sums[vertex], area, 1);
  }
  mesh->rest_normals.resize(mesh->num_draw_vertices);
  for (uint32_t d = 0; d < mesh->num_draw_vertices; ++d) {
    mesh->rest_normals[d] = Turn(basis, Normalised(sums[mesh->solve_vertex[d]], Vec3{0, 0, 1}));
  }
}

// Per triangle du/dx and dv/dx by the inverse of the texture map's Jacobian, summed at draw
// vertices (texture seams keep their sides apart).
void ComputeTangents(const std::array<float, 9>& basis, SkinMesh* mesh) {
  Vector<Vec3> along_u(mesh->num_draw_vertices), along_v(mesh->num_draw_vertices);
  for (size_t t = 0; t < mesh->triangles.size(); t += 3) {
    const uint32_t* corner = &mesh->triangles[t];
    const auto position = [mesh](uint32_t d) {
      return mesh->shape_positions[mesh->solve_vertex[d]];
    };
    const Vec3 e1 = Subtract(position(corner[1]), position(corner[0]));
    const Vec3 e2 = Subtract(position(corner[2]), position(corner[0]));
    const float* uv0 = &mesh->texcoords[2 * size_t{corner[0]}];
    const float* uv1 = &mesh->texcoords[2 * size_t{corner[1]}];
    const float* uv2 = &mesh->texcoords[2 * size_t{corner[2]}];
    const float u1 = uv1[0] - uv0[0], v1 = uv1[1] - uv0[1];
    const float u2 = uv2[0] - uv0[0], v2 = uv2[1] - uv0[1];
    const float orientation = u1 * v2 - u2 * v1 < 0 ? -1.0f : 1.0f;
    const Vec3 du = AddScaled(AddScaled({}, e1, orientation * v2), e2, -orientation * v1);
    const Vec3 dv = AddScaled(AddScaled({}, e2, orientation * u1), e1, -orientation * u2);
    for (int c = 0; c < 3; ++c) {
      along_u[corner[c]] = AddScaled(along_u[corner[c]], du, 1);
      along_v[corner[c]] = AddScaled(along_v[corner[c]], dv, 1);
    }
  }
  mesh->rest_tangents.resize(4 * size_t{mesh->num_draw_vertices});
  for (uint32_t d = 0; d < mesh->num_draw_vertices; ++d) {
    const Vec3 normal = mesh->rest_normals[d];
    const Vec3 u = Turn(basis, along_u[d]), v = Turn(basis, along_v[d]);
    const Vec3 tangent = Normalised(AddScaled(u, normal, -Dot(u, normal)), AnyOrthogonal(normal));
    for (int axis = 0; axis < 3; ++axis)
      mesh->rest_tangents[4 * size_t{d} + axis] = tangent[axis];
    mesh->rest_tangents[4 * size_t{d} + 3] = Dot(Cross(normal, tangent), v) < 0 ? -1.0f : 1.0f;
  }
}

}  // namespace

void CompleteRestFrames(const std::array<float, 9>& basis, SkinMesh* mesh) {
  if (mesh->rest_normals.empty()) ComputeNormals(basis, mesh);
  if (mesh->rest_tangents.empty() && !mesh->texcoords.empty()) ComputeTangents(basis, mesh);
}

}  // namespace limber
