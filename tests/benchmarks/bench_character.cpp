#include "benchmarks/bench_character.h"

#include "bake/edge_groups.h"
#include "bake/reduce.h"
#include "bake/rig_space.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "rig/rest_frames.h"
#include "support/smooth_weights.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>

namespace limber::bench {
namespace {

using bake::PointMatrix;
using bake::RawCharacter;
using Eigen::Vector3d;

// An octahedron subdivided n times along each edge and blown up to a sphere: rings of
// 4, 8, ..., 4 n, ..., 8, 4 vertices between two poles, triangles of nearly one size.
class RingSphere {
 public:
  explicit RingSphere(int n) : n_(n) {}

  int num_vertices() const { return 4 * n_ * n_ + 2; }

  std::vector<Vector3d> Points() const {
    std::vector<Vector3d> points;
    for (int ring = 0; ring <= 2 * n_; ++ring) {
      const double polar = std::numbers::pi * ring / (2 * n_);
      for (int i = 0; i < RingSize(ring); ++i) {
        const double around = 2 * std::numbers::pi * i / RingSize(ring);
        points.emplace_back(std::sin(polar) * std::cos(around), std::cos(polar),
                            -std::sin(polar) * std::sin(around));
      }
    }
    return points;
  }

  // Counter-clockwise from outside.
  std::vector<uint32_t> Triangles() const {
    std::vector<uint32_t> triangles;
    for (int ring = 0; ring < n_; ++ring) {
      AddBand(ring, ring + 1, false, &triangles);
      AddBand(2 * n_ - ring, 2 * n_ - ring - 1, true, &triangles);
    }
    return triangles;
  }

 private:
  int RingSize(int ring) const { return std::max(1, 4 * std::min(ring, 2 * n_ - ring)); }

  uint32_t At(int ring, int i) const {
    int start = 0;  // sums of arithmetic series from the nearer pole
    if (ring > 0 && ring <= n_) start = 1 + 2 * ring * (ring - 1);
    if (ring > n_) start = num_vertices() - 1 - 2 * (2 * n_ - ring) * (2 * n_ - ring + 1);
    if (ring == 2 * n_) start = num_vertices() - 1;
    return static_cast<uint32_t>(start + i % RingSize(ring));
  }

  // Between a ring and the next one nearer to the equator, which has one vertex more a quadrant.
  void AddBand(int small, int large, bool flipped, std::vector<uint32_t>* triangles) const {
    const int steps = std::min(small, 2 * n_ - small);
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      if (flipped) std::swap(b, c);
      triangles->insert(triangles->end(), {a, b, c});
    };
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      for (int j = 0; j <= steps; ++j) {
        const int inner = quadrant * steps + j, outer = quadrant * (steps + 1) + j;
        add(At(small, inner), At(large, outer), At(large, outer + 1));
        if (j < steps) add(At(small, inner), At(large, outer + 1), At(small, inner + 1));
      }
    }
  }

  int n_;
};

// A body with knobs, about two units tall.
Vector3d RestPoint(const Vector3d& unit) {
  const double bump = 1 + 0.12 * std::sin(5 * unit.x() + 1) * std::sin(4 * unit.y()) +
                      0.08 * std::sin(7 * unit.z() - 2 * unit.y());
  return bump * Vector3d(0.7 * unit.x(), unit.y(), 0.5 * unit.z());
}

// Example shape s > 0: turned about an axis of its own by an angle that varies over the body, and
// swollen where s says.
Vector3d ExamplePoint(const Vector3d& rest, int s) {
  const double phase = 1.7 * s;
  const Vector3d axis = Vector3d(std::sin(phase), std::cos(2 * phase), 0.4).normalized();
  const Vector3d along = Vector3d(std::cos(phase), 1, std::sin(3 * phase)).normalized();
  const double place = along.dot(rest);
  const double swell = 1 + 0.25 * std::sin(2 * place + phase);
  return swell * (Eigen::AngleAxisd(0.9 * std::sin(1.5 * place + phase), axis) * rest);
}

// Farthest points by straight distance, beginning at the top.
std::vector<int> SpreadHandles(const PointMatrix& points, int count) {
  std::vector<int> chosen = {0};
  Eigen::VectorXd distance = (points.rowwise() - points.row(0)).rowwise().squaredNorm();
  while (static_cast<int>(chosen.size()) < count) {
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    chosen.push_back(static_cast<int>(farthest));
    distance = distance.cwiseMin((points.rowwise() - points.row(farthest)).rowwise().squaredNorm());
  }
  return chosen;
}

void FillTables(const RawCharacter& raw, const CharacterSize& size, const geometry::SolveMesh& mesh,
                Eigen::MatrixXd* weights, RigTables* tables) {
  bake::ReduceInput input;
  tables->space = bake::FitRigSpace(mesh.shapes, &tables->dimension);
  tables->shape_names = raw.shape_names;
  for (const bake::HandleSpec& spec : raw.marked_handles) {
    RigHandle handle;
    handle.name = spec.name;
    handle.vertex = mesh.solve_vertex[*spec.source_vertex];
    for (int axis = 0; axis < 3; ++axis) {
      handle.rest_position[axis] = static_cast<float>(mesh.shapes[0](handle.vertex, axis));
    }
    input.handle_vertices.push_back(static_cast<int>(handle.vertex));
    tables->handles.push_back(handle);
  }
  *weights = test::SmoothWeights(mesh.shapes[0], input.handle_vertices);
  *weights = weights->cast<float>().cast<double>();
  const int wanted = size.groups > 0 ? size.groups : 2 * size.handles;
  const std::vector<int> groups = bake::ClusterVertices(*weights, wanted, &input.num_groups);
  const std::vector<geometry::GroupEdge> edges = bake::BuildGroupEdges(mesh, groups);
  input.mesh = &mesh;
  input.weights = weights;
  input.edges = &edges;
  ExitUnless(bake::Reduce(input, {}, tables));
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

std::shared_ptr<const Rig> MakeRig(const CharacterSize& size) {
  const RawCharacter raw = MakeRawCharacter(size);
  geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 0);
  geometry::ConnectComponents(&mesh);
  RigTables tables;
  Eigen::MatrixXd weights;
  FillTables(raw, size, mesh, &weights, &tables);
  SkinMesh skin = MakeSkinMesh(raw, mesh, weights, tables.space);
  auto rig = Rig::Create(raw.name, std::move(tables), std::move(skin));
  ExitUnless(rig.status());
  return *rig;
}

}  // namespace

void ExitUnless(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "limber_benchmarks: %s\n", status.message().c_str());
  std::exit(1);
}

RawCharacter MakeRawCharacter(const CharacterSize& size) {
  const RingSphere sphere(static_cast<int>(std::ceil(std::sqrt((size.vertices - 2) / 4.0))));
  const auto num_vertices = static_cast<uint32_t>(sphere.num_vertices());
  RawCharacter raw;
  raw.file = raw.name = "bumpy";
  raw.triangles = sphere.Triangles();
  const std::vector<Vector3d> units = sphere.Points();
  for (int s = 0; s < size.shapes; ++s) {
    raw.shape_names.push_back("shape_" + std::to_string(s));
    PointMatrix& shape = raw.shapes.emplace_back(num_vertices, 3);
    for (uint32_t v = 0; v < num_vertices; ++v) {
      const Vector3d rest = RestPoint(units[v]);
      shape.row(v) = (s == 0 ? rest : ExamplePoint(rest, s)).transpose();
    }
  }
  for (const int vertex : SpreadHandles(raw.shapes[0], size.handles)) {
    bake::HandleSpec spec;
    spec.name = "handle_" + std::to_string(raw.marked_handles.size());
    spec.source_vertex = static_cast<uint32_t>(vertex);
    raw.marked_handles.push_back(spec);
  }
  SkinPrimitive primitive;
  primitive.num_vertices = num_vertices;
  primitive.num_triangles = static_cast<uint32_t>(raw.triangles.size() / 3);
  raw.primitives = {primitive};
  raw.num_source_vertices = num_vertices;
  for (uint32_t v = 0; v < num_vertices; ++v)
    raw.source_vertex.push_back(v);
  return raw;
}

std::shared_ptr<const Rig> BakedCharacter(const CharacterSize& size) {
  static std::map<CharacterSize, std::shared_ptr<const Rig>> made;
  std::shared_ptr<const Rig>& rig = made[size];
  if (rig == nullptr) rig = MakeRig(size);
  return rig;
}

std::vector<std::vector<Vec3>> DragPath(const Rig& rig, int num_frames) {
  const SkinMesh& mesh = rig.mesh();
  std::vector<std::vector<Vec3>> path(static_cast<size_t>(num_frames));
  for (int f = 0; f < num_frames; ++f) {
    const double place = static_cast<double>(f) * rig.num_shapes() / num_frames;
    const int from = static_cast<int>(place), to = (from + 1) % rig.num_shapes();
    const auto mix = static_cast<float>(place - from);
    for (int h = 0; h < rig.num_handles(); ++h) {
      const uint32_t vertex = rig.tables().handles[static_cast<size_t>(h)].vertex;
      const Vec3 a = mesh.shape_positions[size_t(from) * mesh.num_solve_vertices + vertex];
      const Vec3 b = mesh.shape_positions[size_t(to) * mesh.num_solve_vertices + vertex];
      Vec3 target;
      for (int axis = 0; axis < 3; ++axis) {
        const double turn = 2 * std::numbers::pi * (1 + h % 3) * f / num_frames + h + 2 * axis;
        target[axis] =
            (1 - mix) * a[axis] + mix * b[axis] + 0.04f * static_cast<float>(std::sin(turn));
      }
      path[static_cast<size_t>(f)].push_back(rig.ToMesh(target));
    }
  }
  return path;
}

void SetTargets(const std::vector<Vec3>& targets, PoseState* pose) {
  for (size_t h = 0; h < targets.size(); ++h) {
    ExitUnless(pose->SetTarget(static_cast<int>(h), targets[h]));
  }
}

}  // namespace limber::bench
