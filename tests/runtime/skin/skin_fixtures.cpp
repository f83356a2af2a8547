#include "runtime/skin/skin_fixtures.h"

#include "core/vector.h"
#include "support/test_meshes.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace limber::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d Basis(const RigSpace& space) {
  Matrix3d basis;
  for (int i = 0; i < 9; ++i)
    basis(i % 3, i / 3) = space.basis[static_cast<size_t>(i)];
  return basis;
}

Vec3 ToVec3(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vec3 ToRig(const RigSpace& space, const Vector3d& mesh) {
  const Vector3d origin(space.origin[0], space.origin[1], space.origin[2]);
  return ToVec3(Basis(space).transpose() * (mesh - origin) / double{space.scale});
}

RigSpace TurnedSpace() {
  RigSpace space;
  space.origin = {0.3f, 1.0f, -0.2f};
  space.scale = 1.7f;
  const Matrix3d basis = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (int i = 0; i < 9; ++i) {
    space.basis[static_cast<size_t>(i)] = static_cast<float>(basis(i % 3, i / 3));
  }
  return space;
}

void AddPrimitive(SkinMesh* mesh) {
  SkinPrimitive primitive;
  primitive.num_vertices = mesh->num_draw_vertices;
  primitive.num_triangles = mesh->num_triangles();
  mesh->primitives = {primitive};
  mesh->source_vertex.resize(mesh->num_draw_vertices);
  for (uint32_t d = 0; d < mesh->num_draw_vertices; ++d)
    mesh->source_vertex[d] = d;
  mesh->num_source_vertices = mesh->num_draw_vertices;
}

}  // namespace

SkinFixture MakeCylinderFixture(int around, int along) {
  const bake::RawCharacter raw = MakeBendCylinder(around, along);
  SkinFixture fixture;
  fixture.space = TurnedSpace();
  SkinMesh& mesh = fixture.mesh;
  const auto count = static_cast<uint32_t>(raw.num_draw_vertices());
  mesh.num_solve_vertices = mesh.num_draw_vertices = count;
  mesh.num_handles = 3;
  mesh.num_shapes = static_cast<int>(raw.shapes.size());
  mesh.triangles = raw.triangles;
  for (const bake::PointMatrix& shape : raw.shapes) {
    for (int v = 0; v < shape.rows(); ++v) {
      mesh.shape_positions.push_back(ToRig(fixture.space, shape.row(v).transpose()));
    }
  }
  Vector<Vector3d> normals(count, Vector3d::Zero());
  const bake::PointMatrix& rest = raw.shapes[0];
  for (size_t t = 0; t < raw.triangles.size(); t += 3) {
    const Vector3d a = rest.row(raw.triangles[t]), b = rest.row(raw.triangles[t + 1]);
    const Vector3d c = rest.row(raw.triangles[t + 2]);
    for (size_t i = 0; i < 3; ++i)
      normals[raw.triangles[t + i]] += (b - a).cross(c - a);
  }
  for (uint32_t v = 0; v < count; ++v) {
    mesh.solve_vertex.push_back(v);
    mesh.rest_normals.push_back(ToVec3(normals[v].normalized()));
    const double y = rest(v, 1);  // 0 to 2
    mesh.weights.push_back(static_cast<float>(std::max(0.0, 1 - y)));
    mesh.weights.push_back(static_cast<float>(1 - std::abs(y - 1)));
    mesh.weights.push_back(static_cast<float>(std::max(0.0, y - 1)));
  }
  AddPrimitive(&mesh);
  return fixture;
}

SkinFixture MakeSeamSphereFixture(int around, int along) {
  SkinFixture fixture;
  fixture.space = TurnedSpace();
  SkinMesh& mesh = fixture.mesh;
  mesh.num_handles = 2;
  mesh.num_shapes = 1;
  const int columns = around + 1, rows = along + 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = 2 * std::numbers::pi * (i % around) / around;
      const double v = std::numbers::pi * j / along;
      const Vector3d p(std::sin(v) * std::sin(u), std::cos(v), std::sin(v) * std::cos(u));
      const bool pole = j == 0 || j == along;
      const uint32_t ring = 1 + static_cast<uint32_t>((j - 1) * around + i % around);
      const auto last = static_cast<uint32_t>(1 + (along - 1) * around);
      mesh.solve_vertex.push_back(j == 0 ? 0 : j == along ? last : ring);
      mesh.rest_normals.push_back(ToVec3(p));
      const float tangent[4] = {static_cast<float>(std::cos(u)), 0,
                                static_cast<float>(-std::sin(u)), -1};
      mesh.rest_tangents.insert(mesh.rest_tangents.end(), tangent, tangent + 4);
      mesh.texcoords.push_back(static_cast<float>(i) / static_cast<float>(around));
      mesh.texcoords.push_back(static_cast<float>(j) / static_cast<float>(along));
      if (pole ? i == 0 : i < around) {
        mesh.shape_positions.push_back(ToRig(fixture.space, p));
        const float weight = static_cast<float>((p.y() + 1) / 2);
        mesh.weights.push_back(1 - weight);
        mesh.weights.push_back(weight);
      }
    }
  }
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const auto a = static_cast<uint32_t>(j * columns + i), b = a + 1;
      const auto c = static_cast<uint32_t>(a + static_cast<uint32_t>(columns)), d = c + 1;
      if (j > 0) mesh.triangles.insert(mesh.triangles.end(), {a, c, b});
      if (j < along - 1) mesh.triangles.insert(mesh.triangles.end(), {b, c, d});
    }
  }
  mesh.num_solve_vertices = static_cast<uint32_t>(mesh.shape_positions.size());
  mesh.num_draw_vertices = static_cast<uint32_t>(mesh.solve_vertex.size());
  AddPrimitive(&mesh);
  return fixture;
}

SkinFixture MakeCubeFixture() {
  SkinFixture fixture;
  fixture.space = TurnedSpace();
  SkinMesh& mesh = fixture.mesh;
  mesh.num_handles = mesh.num_shapes = 1;
  mesh.num_solve_vertices = 8;
  mesh.weights.assign(8, 1.0f);
  for (int v = 0; v < 8; ++v) {
    const Vector3d p((v & 1) != 0 ? 1 : -1, (v & 2) != 0 ? 1 : -1, (v & 4) != 0 ? 1 : -1);
    mesh.shape_positions.push_back(ToRig(fixture.space, p));
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      const int u = 1 << (axis + 1) % 3, w = 1 << (axis + 2) % 3, base = side << axis;
      const auto first = static_cast<uint32_t>(mesh.solve_vertex.size());
      for (const int v : {base, base + u, base + u + w, base + w}) {
        mesh.solve_vertex.push_back(static_cast<uint32_t>(v));
        Vec3 normal;
        normal[axis] = side != 0 ? 1.0f : -1.0f;
        mesh.rest_normals.push_back(normal);
      }
      const std::array<uint32_t, 6> quad = side != 0 ? std::array<uint32_t, 6>{0, 1, 2, 0, 2, 3}
                                                     : std::array<uint32_t, 6>{0, 2, 1, 0, 3, 2};
      for (const uint32_t corner : quad)
        mesh.triangles.push_back(first + corner);
    }
  }
  mesh.num_draw_vertices = 24;
  AddPrimitive(&mesh);
  return fixture;
}

Affine RotationAffine(std::array<double, 3> axis, double angle, std::array<double, 3> translation) {
  const Matrix3d r =
      Eigen::AngleAxisd(angle, Vector3d(axis[0], axis[1], axis[2]).normalized()).toRotationMatrix();
  Affine affine{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      affine[static_cast<size_t>(i * 4 + j)] = r(i, j);
    affine[static_cast<size_t>(i * 4 + 3)] = translation[static_cast<size_t>(i)];
  }
  return affine;
}

SkinPose MakePose(const SkinFixture& fixture, const Vector<float>& blend,
                  const Vector<Affine>& maps) {
  const SkinMesh& mesh = fixture.mesh;
  SkinPose pose;
  pose.origin = {fixture.space.origin[0], fixture.space.origin[1], fixture.space.origin[2]};
  const Matrix3d to_mesh = double{fixture.space.scale} * Basis(fixture.space);
  for (int h = 0; h < mesh.num_handles; ++h) {
    const Affine& map = maps[static_cast<size_t>(h)];
    for (int s = 0; s < mesh.num_shapes; ++s) {
      const double share = blend[static_cast<size_t>(h * mesh.num_shapes + s)];
      for (size_t row = 0; row < 3; ++row) {
        const Vector3d linear(map[row * 4], map[row * 4 + 1], map[row * 4 + 2]);
        const Vector3d entries = share * (linear.transpose() * to_mesh).transpose();
        for (int c = 0; c < 3; ++c)
          pose.matrices.push_back(static_cast<float>(entries[c]));
        pose.matrices.push_back(static_cast<float>(share * map[row * 4 + 3]));
      }
    }
  }
  return pose;
}

SkinPose RestPose(const SkinFixture& fixture, int shape) {
  const auto num_handles = static_cast<size_t>(fixture.mesh.num_handles);
  const auto num_shapes = static_cast<size_t>(fixture.mesh.num_shapes);
  Vector<float> blend(num_handles * num_shapes, 0.0f);
  for (size_t h = 0; h < num_handles; ++h)
    blend[h * num_shapes + static_cast<size_t>(shape)] = 1;
  return MakePose(fixture, blend,
                  Vector<Affine>(num_handles, RotationAffine({0, 1, 0}, 0, {0, 0, 0})));
}

SkinPose CylinderPose(const SkinFixture& fixture, double amount) {
  const auto a = static_cast<float>(amount);
  const Vector<float> blend = {1, 0, 0, 1 - a, 0.4f * a, 0.6f * a, 1 - a, a, 0};
  return MakePose(fixture, blend,
                  {RotationAffine({0, 1, 0}, 0, {0, 0, 0}),
                   RotationAffine({0, 1, 0}, 0.6 * amount, {0.1 * amount, 0, 0}),
                   RotationAffine({1, 0, 1}, 0.5 * amount, {0, 0.2 * amount, 0.1 * amount})});
}

float FixtureSize(const SkinFixture& fixture) {
  Vec3 low = fixture.mesh.shape_positions[0], high = low;
  for (uint32_t v = 0; v < fixture.mesh.num_solve_vertices; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], fixture.mesh.shape_positions[v][axis]);
      high[axis] = std::max(high[axis], fixture.mesh.shape_positions[v][axis]);
    }
  }
  const Vector3d diagonal(high.x - low.x, high.y - low.y, high.z - low.z);
  return static_cast<float>(diagonal.norm()) * fixture.space.scale;
}

}  // namespace limber::test
