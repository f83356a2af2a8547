#include "geometry/intrinsic_triangulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limber::geometry {
namespace {

// Of the square of the longest side. Triangles with a mollified side keep well above it.
constexpr double kSmallestArea = 1e-14;

// Four times the area; never below that of a needle, nor NaN.
double FourAreas(double a, double b, double c) {
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  // Heron's formula in Kahan's order, which is exact to rounding for needles too.
  const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
  return std::max(std::sqrt(std::max(product, 0.0)), 4 * kSmallestArea * a * a);
}

// The third corner of a triangle whose side of length `base` lies on the x axis from the origin.
struct Apex {
  double x = 0, y = 0;
};

Apex LayOut(double base, double from_origin, double from_end) {
  const double x = 0.5 * (base + (from_origin - from_end) * (from_origin + from_end) / base);
  return {x, 0.5 * FourAreas(base, from_origin, from_end) / base};
}

}  // namespace

double OppositeCotangent(const IntrinsicTriangulation& triangulation, int h) {
  const double a = triangulation.length[h], b = triangulation.length[Next(h)],
               c = triangulation.length[Previous(h)];
  return (b * b + (c - a) * (c + a)) / FourAreas(a, b, c);
}

bool FlipEdge(int h, IntrinsicTriangulation* triangulation) {
  auto& [tail, twin, length] = *triangulation;
  const int g = twin[h];
  if (h / 3 == g / 3) return false;
  // h goes from a to b; c is opposite on its side, d on the other.
  const int h_bc = Next(h), h_ca = Previous(h), g_ad = Next(g), g_db = Previous(g);
  const double base = length[h];
  const Apex c = LayOut(base, length[h_ca], length[h_bc]);
  const Apex d = LayOut(base, length[g_ad], length[g_db]);
  const double crossing = c.x + (d.x - c.x) * (c.y / (c.y + d.y));
  if (!(crossing > 0 && crossing < base)) return false;
  const double diagonal = std::hypot(c.x - d.x, c.y + d.y);

  // The face of h becomes d c a, that of g becomes c d b. The sides c a and d b stay where they
  // are, b c and a d change places with the halves of the edge.
  const int vertex_c = tail[h_ca], vertex_d = tail[g_db];
  const auto moved = [=](int halfedge) {
    return halfedge == h_bc ? g : halfedge == g_ad ? h : halfedge;
  };
  const int beyond_bc = moved(twin[h_bc]), beyond_ad = moved(twin[g_ad]);
  tail[g] = tail[h_bc];
  tail[h] = tail[g_ad];
  length[g] = length[h_bc];
  length[h] = length[g_ad];
  twin[g] = beyond_bc;
  twin[beyond_bc] = g;
  twin[h] = beyond_ad;
  twin[beyond_ad] = h;
  tail[h_bc] = vertex_d;
  tail[g_ad] = vertex_c;
  length[h_bc] = length[g_ad] = diagonal;
  twin[h_bc] = g_ad;
  twin[g_ad] = h_bc;
  return true;
}

}  // namespace limber::geometry
