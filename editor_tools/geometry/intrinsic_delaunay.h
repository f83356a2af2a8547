// Intrinsic Delaunay triangulation by edge flips.
#pragma once

#include "geometry/intrinsic_triangulation.h"

#include <cstdint>

namespace limber::geometry {

// Cotangent weight of the edge of halfedge h: half the sum of the two opposite cotangents. Not
// negative exactly where the edge is Delaunay.
double CotangentWeight(const IntrinsicTriangulation& triangulation, int h);

// Flips edges until all are Delaunay (Indermitte, Liebling, Troyanov and Clémençon 2001; Bobenko
// and Springborn 2007), first in, first out from the first halfedge on. Edges of four cocircular
// corners, to rounding, stay as they are: either diagonal is Delaunay and weighs nothing. The
// number of flips is finite but not bounded by the size of the mesh, so flipping stops after
// max_flips: false then, and some weights may be negative.
bool FlipToDelaunay(int64_t max_flips, IntrinsicTriangulation* triangulation);

}  // namespace limber::geometry
