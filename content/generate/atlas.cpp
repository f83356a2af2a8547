#include "generate/atlas.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace limber::content {
namespace {

constexpr int kMargin = 4;  // pixels around a chart

struct Chart {
  int axis = 0;
  std::vector<size_t> triangles;
  // In units of the surface, scaled.
  Vector2d low = Vector2d::Zero(), size = Vector2d::Zero();
  Eigen::Vector2i corner = Eigen::Vector2i::Zero();  // in pixels, once packed
};

// The three triangles across the edges of each triangle of a closed surface.
std::vector<std::array<size_t, 3>> Neighbours(const std::vector<uint32_t>& triangles) {
  std::map<std::pair<uint32_t, uint32_t>, size_t> owner;
  for (size_t t = 0; t < triangles.size() / 3; ++t) {
    for (int k = 0; k < 3; ++k)
      owner[{triangles[3 * t + k], triangles[3 * t + (k + 1) % 3]}] = t;
  }
  std::vector<std::array<size_t, 3>> across(triangles.size() / 3);
  for (size_t t = 0; t < across.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto found = owner.find({triangles[3 * t + (k + 1) % 3], triangles[3 * t + k]});
      across[t][k] = found == owner.end() ? t : found->second;
    }
  }
  return across;
}

// Axis 2a for +a, 2a + 1 for -a.
double Along(const Vector3d& normal, int axis) {
  return axis % 2 == 0 ? normal[axis / 2] : -normal[axis / 2];
}

// The projection of a chart: two coordinates, not mirrored as seen from outside.
Vector2d Project(const Vector3d& p, int axis) {
  const int a = axis / 2;
  const Vector2d plane = a == 2   ? Vector2d(p.x(), -p.y())
                         : a == 0 ? Vector2d(-p.z(), -p.y())
                                  : Vector2d(p.x(), p.z());
  return axis % 2 == 0 ? plane : Vector2d(-plane.x(), plane.y());
}

// A label per triangle: part and axis, with ragged borders smoothed by majority.
std::vector<int> Label(const Surface& surface, const std::vector<std::array<size_t, 3>>& across,
                       const std::function<int(const Vector3d&)>& part) {
  const size_t count = across.size();
  std::vector<Vector3d> normal(count);
  std::vector<int> label(count), part_of(count);
  for (size_t t = 0; t < count; ++t) {
    const uint32_t* v = &surface.triangles[3 * t];
    const std::vector<Vector3d>& p = surface.positions;
    normal[t] = (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]).normalized();
    part_of[t] = part((p[v[0]] + p[v[1]] + p[v[2]]) / 3);
    int best = 0;
    // The front is kept whole as far as it can be seen from the front: that is where the face is.
    const auto score = [&](int axis) { return Along(normal[t], axis) * (axis == 4 ? 1.6 : 1.0); };
    for (int axis = 1; axis < 6; ++axis)
      best = score(axis) > score(best) ? axis : best;
    label[t] = 6 * part_of[t] + best;
  }
  for (int pass = 0; pass < 8; ++pass) {
    for (size_t t = 0; t < count; ++t) {
      const auto& n = across[t];
      const int wish = label[n[0]] == label[n[1]] || label[n[0]] == label[n[2]] ? label[n[0]]
                       : label[n[1]] == label[n[2]]                             ? label[n[1]]
                                                                                : label[t];
      if (Along(normal[t], wish % 6) > 0.25) label[t] = wish;
    }
  }
  return label;
}

std::vector<Chart> CutCharts(const Surface& surface,
                             const std::vector<std::array<size_t, 3>>& across,
                             const std::vector<int>& label, const std::array<double, 6>& scale) {
  std::vector<bool> seen(across.size(), false);
  std::vector<Chart> charts;
  for (size_t seed = 0; seed < across.size(); ++seed) {
    if (seen[seed]) continue;
    Chart chart;
    chart.axis = label[seed] % 6;
    chart.triangles = {seed};
    seen[seed] = true;
    Vector2d low(1e30, 1e30), high(-1e30, -1e30);
    for (size_t i = 0; i < chart.triangles.size(); ++i) {
      const size_t t = chart.triangles[i];
      for (size_t next : across[t]) {
        if (seen[next] || label[next] != label[seed]) continue;
        seen[next] = true;
        chart.triangles.push_back(next);
      }
      for (int k = 0; k < 3; ++k) {
        const Vector3d& p = surface.positions[surface.triangles[3 * t + k]];
        const Vector2d q = scale[chart.axis] * Project(p, chart.axis);
        low = low.cwiseMin(q);
        high = high.cwiseMax(q);
      }
    }
    chart.low = low;
    chart.size = high - low;
    charts.push_back(std::move(chart));
  }
  return charts;
}

// Largest chart first, each where it comes to lie highest against those before it. False where the
// charts do not fit at this density.
bool Pack(double pixels_per_unit, int width, int height, std::vector<Chart>* charts) {
  std::vector<size_t> order(charts->size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return (*charts)[a].size.y() > (*charts)[b].size.y();
  });
  std::vector<int> filled(width, 0);  // down to here, per column of pixels
  for (size_t i : order) {
    Chart& chart = (*charts)[i];
    const Eigen::Vector2i box =
        (chart.size * pixels_per_unit).array().ceil().cast<int>() + 2 * kMargin;
    int best_x = -1, best_y = height;
    for (int x = 0; x + box.x() <= width; ++x) {
      const int y = *std::max_element(filled.begin() + x, filled.begin() + x + box.x());
      if (y < best_y) {
        best_x = x;
        best_y = y;
      }
    }
    if (best_x < 0 || best_y + box.y() > height) return false;
    chart.corner = {best_x, best_y};
    std::fill_n(filled.begin() + best_x, box.x(), best_y + box.y());
  }
  return true;
}

// How far `at` is outside the triangle of these corners, in pixels; negative inside. The winding
// does not matter.
double OutsideTriangle(const std::array<Vector2d, 3>& corner, const Vector2d& at) {
  const auto turn = [](const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  const double winding = turn(corner[1] - corner[0], corner[2] - corner[0]) > 0 ? 1 : -1;
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vector2d along = (corner[(k + 1) % 3] - corner[k]).normalized();
    most = std::max(most, -winding * turn(along, at - corner[k]));
  }
  return most;
}

std::array<Vector2d, 3> Corners(const Atlas& atlas, size_t first_corner) {
  std::array<Vector2d, 3> corner;
  for (int k = 0; k < 3; ++k)
    corner[k] = atlas.pixels[atlas.triangles[first_corner + k]];
  return corner;
}

// For each pixel the first corner of the triangle it lies in, or of the one it is least outside
// of; -1 far from all.
std::vector<int64_t> OwnTriangles(const Atlas& atlas, const Image& image) {
  const size_t count = static_cast<size_t>(image.width) * image.height;
  std::vector<double> distance(count, kMargin - 1.0);
  std::vector<int64_t> owner(count, -1);
  for (size_t t = 0; t < atlas.triangles.size(); t += 3) {
    const std::array<Vector2d, 3> corner = Corners(atlas, t);
    const Vector2d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
    const Vector2d high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
    const int x0 = std::max(0, static_cast<int>(low.x()) - kMargin);
    const int y0 = std::max(0, static_cast<int>(low.y()) - kMargin);
    const int x1 = std::min(image.width, static_cast<int>(high.x()) + kMargin + 1);
    const int y1 = std::min(image.height, static_cast<int>(high.y()) + kMargin + 1);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const size_t pixel = static_cast<size_t>(y) * image.width + x;
        const double here = OutsideTriangle(corner, {x + 0.5, y + 0.5});
        if (here >= distance[pixel]) continue;
        distance[pixel] = here;
        owner[pixel] = static_cast<int64_t>(t);
      }
    }
  }
  return owner;
}

}  // namespace

Atlas MakeAtlas(const Surface& surface, const std::function<int(const Vector3d&)>& part,
                const std::array<double, 6>& scale, int width, int height) {
  const auto across = Neighbours(surface.triangles);
  std::vector<Chart> charts = CutCharts(surface, across, Label(surface, across, part), scale);
  Atlas atlas;
  atlas.num_charts = static_cast<int>(charts.size());
  atlas.pixels_per_unit = width;
  while (!Pack(atlas.pixels_per_unit, width, height, &charts))
    atlas.pixels_per_unit *= 0.99;
  atlas.triangles.resize(surface.triangles.size());
  for (const Chart& chart : charts) {
    std::map<uint32_t, uint32_t> copy;
    for (size_t t : chart.triangles) {
      for (int k = 0; k < 3; ++k) {
        const uint32_t v = surface.triangles[3 * t + k];
        const auto [at, fresh] =
            copy.emplace(v, static_cast<uint32_t>(atlas.surface_vertex.size()));
        atlas.triangles[3 * t + k] = at->second;
        if (!fresh) continue;
        const Vector2d q = scale[chart.axis] * Project(surface.positions[v], chart.axis);
        atlas.surface_vertex.push_back(v);
        atlas.pixels.emplace_back((q - chart.low) * atlas.pixels_per_unit +
                                  (chart.corner.array() + kMargin).cast<double>().matrix());
      }
    }
  }
  return atlas;
}

void PaintAtlas(const Surface& surface, const Atlas& atlas,
                const std::function<Colour(const Vector3d&)>& colour, Image* image) {
  const std::vector<int64_t> owner = OwnTriangles(atlas, *image);
  for (size_t pixel = 0; pixel < owner.size(); ++pixel) {
    if (owner[pixel] < 0) continue;
    Eigen::Matrix3d place, corners;
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = atlas.triangles[owner[pixel] + k];
      place.col(k) << atlas.pixels[v], 1;
      corners.col(k) = surface.positions[atlas.surface_vertex[v]];
    }
    const Eigen::Matrix3d to_surface = corners * place.inverse();
    const auto x = static_cast<int>(pixel % image->width);
    const auto y = static_cast<int>(pixel / image->width);
    Colour sum = Colour::Zero();
    for (int i = 0; i < 4; ++i) {
      sum += colour(to_surface * Vector3d(x + 0.25 + 0.5 * (i & 1), y + 0.25 + 0.5 * (i >> 1), 1));
    }
    SetPixel(sum / 4, x, y, image);
  }
}

}  // namespace limber::content
