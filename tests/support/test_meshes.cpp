#include "support/test_meshes.h"

#include "core/vector.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace limber::test {
namespace {

using bake::HandleSpec;
using bake::PointMatrix;
using bake::RawCharacter;
using Map = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

// Fills everything of `raw` that follows from its first shape, triangles and the maps of the
// others.
void Finish(RawCharacter* raw, const Vector<Map>& maps) {
  const PointMatrix rest = raw->shapes.at(0);
  for (const Map& map : maps) {
    PointMatrix shape(rest.rows(), 3);
    for (int v = 0; v < rest.rows(); ++v)
      shape.row(v) = map(rest.row(v).transpose()).transpose();
    raw->shapes.push_back(shape);
  }
  const auto num_vertices = static_cast<uint32_t>(rest.rows());
  raw->num_source_vertices = num_vertices;
  raw->source_vertex.resize(num_vertices);
  for (uint32_t v = 0; v < num_vertices; ++v)
    raw->source_vertex[v] = v;
  SkinPrimitive primitive;
  primitive.num_vertices = num_vertices;
  primitive.num_triangles = static_cast<uint32_t>(raw->triangles.size() / 3);
  raw->primitives = {primitive};
}

HandleSpec At(const char* name, uint32_t vertex, bool pinned = true) {
  HandleSpec spec;
  spec.name = name;
  spec.source_vertex = vertex;
  spec.pinned = pinned;
  return spec;
}

}  // namespace

RawCharacter MakeStretchSquare(int resolution) {
  RawCharacter raw;
  raw.file = "stretch_square";
  raw.name = "stretch_square";
  raw.shape_names = {"square", "puffed", "thinned"};
  const int row = resolution + 1;
  PointMatrix rest(row * row, 3);
  for (int y = 0; y <= resolution; ++y) {
    for (int x = 0; x <= resolution; ++x) {
      rest.row(y * row + x) << double(x) / resolution, double(y) / resolution - 0.5, 0;
    }
  }
  raw.shapes = {rest};
  for (int y = 0; y < resolution; ++y) {
    for (int x = 0; x < resolution; ++x) {
      const auto a = static_cast<uint32_t>(y * row + x), b = a + 1, c = a + row, d = c + 1;
      raw.triangles.insert(raw.triangles.end(), {a, b, d, a, d, c});
    }
  }
  const auto stretched = [](double width, double swell) {
    return [width, swell](const Eigen::Vector3d& p) {
      const double bulge = 1 + swell * std::sin(std::numbers::pi * p.x());
      return Eigen::Vector3d(width * p.x(), bulge * p.y(), 0);
    };
  };
  Finish(&raw, {stretched(1.6, 0.5), stretched(2.4, -0.5)});
  const auto middle = static_cast<uint32_t>(resolution / 2 * row);
  raw.marked_handles = {At("left", middle), At("centre", middle + resolution / 2, false),
                        At("right", middle + resolution)};
  return raw;
}

RawCharacter MakeBendCylinder(int around, int along) {
  RawCharacter raw;
  raw.file = "bend_cylinder";
  raw.name = "bend_cylinder";
  raw.shape_names = {"straight", "bent", "squashed"};
  const double radius = 0.25, height = 2;
  PointMatrix rest(around * (along + 1) + 2, 3);
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      rest.row(j * around + i) << radius * std::cos(angle), height * j / along,
          radius * std::sin(angle);
    }
  }
  const int bottom = around * (along + 1), top = bottom + 1;
  rest.row(bottom) << 0, 0, 0;
  rest.row(top) << 0, height, 0;
  raw.shapes = {rest};
  const auto add = [&raw](int a, int b, int c) {
    for (int v : {a, b, c})
      raw.triangles.push_back(static_cast<uint32_t>(v));
  };
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around;
    for (int j = 0; j < along; ++j) {
      const int a = j * around + i, b = j * around + next;
      add(a, a + around, b);
      add(b, a + around, b + around);
    }
    add(bottom, i, next);
    add(top, along * around + next, along * around + i);
  }
  const auto bend = [height](const Eigen::Vector3d& p) {
    const double angle = std::numbers::pi / 2 * p.y() / height;
    const double radius_of_arc = height / (std::numbers::pi / 2);
    const double r = radius_of_arc - p.x();
    return Eigen::Vector3d(radius_of_arc - r * std::cos(angle), r * std::sin(angle), p.z());
  };
  const auto squash = [height](const Eigen::Vector3d& p) {
    const double bulge = 1.2 + 0.6 * std::sin(std::numbers::pi * p.y() / height);
    return Eigen::Vector3d(bulge * p.x(), 0.5 * p.y(), bulge * p.z());
  };
  Finish(&raw, {bend, squash});
  raw.marked_handles = {At("bottom", static_cast<uint32_t>(bottom)),
                        At("middle", static_cast<uint32_t>(along / 2 * around), false),
                        At("top", static_cast<uint32_t>(top))};
  return raw;
}

}  // namespace limber::test
