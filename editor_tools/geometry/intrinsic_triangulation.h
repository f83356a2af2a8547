// A closed triangulation known by its edge lengths alone: no vertex has a position.
#pragma once

#include "core/vector.h"

namespace limber::geometry {

// Triangles glued side to side (the "glue map" of Sharp, Gillespie and Crane 2021, Geometry
// Processing with Intrinsic Triangulations). Halfedges 3 f, 3 f + 1 and 3 f + 2 go once around face
// f. There is no border, so every halfedge has a twin, which is never itself. Vertices are names
// only: an edge may join a vertex to itself, two vertices may share several edges, two faces
// several sides, and the faces at a vertex may form several fans.
struct IntrinsicTriangulation {
  Vector<int> tail;       // [3 F] the vertex that the halfedge leaves
  Vector<int> twin;       // [3 F] the same edge seen from the neighbour, other direction
  Vector<double> length;  // [3 F] > 0, equal for twins

  int num_halfedges() const { return static_cast<int>(tail.size()); }
};

// The halfedge after and before h around its face.
inline int Next(int h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}

inline int Previous(int h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

// Cotangent of the angle opposite halfedge h in its face; finite for any lengths (an area that
// vanishes in rounding counts as a small one).
double OppositeCotangent(const IntrinsicTriangulation& triangulation, int h);

// Replaces the edge of h by the other diagonal of the two faces beside it, drawn straight in the
// plane they unfold to; its halfedges are then Next(h) and Next(twin of h) as those were before.
// False, and no change, where h's two sides belong to one face, and where the quadrilateral is not
// strictly convex to rounding.
bool FlipEdge(int h, IntrinsicTriangulation* triangulation);

}  // namespace limber::geometry
