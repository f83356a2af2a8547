#include "bench/made_character.h"

#include "bench/made_surface.h"
#include "core/vector.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace limber::bench {
namespace {

using bake::PointMatrix;
using bake::RawCharacter;
using Eigen::Vector3d;

// A body with knobs, about two units tall; what is planar stays so.
Vector3d RestPoint(const Vector3d& unit) {
  const double bump = 1 + 0.12 * std::sin(5 * unit.x() + 1) * std::sin(4 * unit.y()) +
                      0.08 * std::sin(7 * unit.z() - 2 * unit.y());
  return bump * Vector3d(0.7 * unit.x(), unit.y(), 0.5 * unit.z());
}

// Example shape s > 0: turned about an axis of its own (in the plane, about the plane's) by an
// angle that varies over the body, and swollen where s says.
Vector3d ExamplePoint(const Vector3d& rest, int s, int dimension) {
  const double phase = 1.7 * s;
  Vector3d axis(std::sin(phase), std::cos(2 * phase), 0.4);
  Vector3d along(std::cos(phase), 1, std::sin(3 * phase));
  if (dimension == 2) {
    axis = Vector3d::UnitZ();
    along.z() = 0;
  }
  const double place = along.normalized().dot(rest);
  const double swell = 1 + 0.25 * std::sin(2 * place + phase);
  const double angle = 0.9 * std::sin(1.5 * place + phase);
  return swell * (Eigen::AngleAxisd(angle, axis.normalized()) * rest);
}

// Farthest points by straight distance.
Vector<int> SpreadHandles(const PointMatrix& points, int first, int count) {
  Vector<int> chosen = {first};
  Eigen::VectorXd distance = (points.rowwise() - points.row(first)).rowwise().squaredNorm();
  while (static_cast<int>(chosen.size()) < count) {
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    chosen.push_back(static_cast<int>(farthest));
    distance = distance.cwiseMin((points.rowwise() - points.row(farthest)).rowwise().squaredNorm());
  }
  return chosen;
}

}  // namespace

RawCharacter MakeRawCharacter(const CharacterSize& size) {
  const bool planar = size.dimension == 2;
  MadeSurface surface = planar ? MakeDisc(size.vertices) : MakeSphere(size.vertices);
  const auto num_vertices = static_cast<uint32_t>(surface.points.size());
  RawCharacter raw;
  raw.file = raw.name = "bumpy";
  raw.triangles = std::move(surface.triangles);
  for (int s = 0; s < size.shapes; ++s) {
    raw.shape_names.push_back("shape_" + std::to_string(s));
    PointMatrix& shape = raw.shapes.emplace_back(num_vertices, 3);
    for (uint32_t v = 0; v < num_vertices; ++v) {
      const Vector3d rest = RestPoint(surface.points[v]);
      shape.row(v) = (s == 0 ? rest : ExamplePoint(rest, s, size.dimension)).transpose();
    }
  }
  const int first = planar ? static_cast<int>(num_vertices) - 1 : 0;  // the rim, or the top
  for (const int vertex : SpreadHandles(raw.shapes[0], first, size.handles)) {
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

}  // namespace limber::bench
