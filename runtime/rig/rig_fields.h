// The one table of names and shapes that the reader and the writer of LIMBER_mesh_ik share.
// To add a table to the format: add it to RigTables, add a line to VisitRigTables and one to
// FirstVersionOfTable, raise kRigFormatVersion. Tables that stand for others in the file alone are
// named here and read in load/rig_table_reader.cpp.
#pragma once

#include "core/vector.h"
#include "rig/rig_tables.h"

#include <cstdint>
#include <string_view>

namespace limber {

inline constexpr char kRigExtensionName[] = "LIMBER_mesh_ik";
inline constexpr int kRigFormatVersion = 3;        // what is written
inline constexpr int kOldestRigFormatVersion = 1;  // what is still read
// Per-vertex data travels as vertex attributes, so that tools that re-index a mesh carry it along.
inline constexpr char kWeightsAttributePrefix[] = "_LIMBER_WEIGHTS_";  // + 0, 1, ...: VEC4 floats
inline constexpr char kWeldAttribute[] = "_LIMBER_WELD";  // SCALAR float: the solve vertex
// SCALAR float, optional: the edge group, for tools; the runtime does not read it.
inline constexpr char kGroupAttribute[] = "_LIMBER_GROUP";
inline constexpr char kSourceAttribute[] = "_LIMBER_SOURCE";  // SCALAR float: written by `pack`

// Since version 3, instead of singleEdges and singleGroupFactors (rig/local_group_factors.h):
inline constexpr char kGroupHandlesTable[] = "groupHandles";  // [G][H]
inline constexpr char kGroupFactorsTable[] = "groupFactors";  // [their number]
// Since version 3, optional: the column of F that each column of the file's residualFactor holds.
// In the order in which columns end, F is a trapezoid, and its zeros take no room.
inline constexpr char kResidualColumnsTable[] = "residualColumns";

// Since version 3, optional: the file's modeTransforms and singleModeTransforms have each column
// divided by 2 to this power. A mode that hardly moves anything has transforms of a size of its
// own.
inline constexpr char kModeExponentsTable[] = "modeExponents";              // [1 + r]
inline constexpr char kSingleModeExponentsTable[] = "singleModeExponents";  // [S][1 + r1]

// The version of the format that brought a table; in older files it is absent, and then empty.
inline int FirstVersionOfTable(std::string_view name) {
  return name == "singleModeTransforms" || name == "handleReach" ? 2 : 1;
}

// The number of elements of a table of that shape.
inline int64_t NumElements(const Vector<int64_t>& shape) {
  int64_t count = 1;
  for (const int64_t size : shape)
    count *= size;
  return count;
}

// Calls visit(name, table, shape) for each float table; shape is the declared dimensions, whose
// product is the element count. `Tables` is RigTables or const RigTables.
template <class Tables, class Visitor>
void VisitRigTables(Tables& t, Visitor&& visit) {
  using Shape = Vector<int64_t>;
  const int64_t k = t.dimension, h = t.num_handles(), s = t.num_shapes(), g = t.num_groups;
  const int64_t n = t.num_transform_rows(), r = t.num_modes, r1 = t.num_single_modes;
  const int64_t m = r1 + k;
  visit("modeTransforms", t.mode_transforms, Shape{n, 1 + r});
  visit("handleModes", t.handle_modes, Shape{h, 1 + r});
  visit("modeEdges", t.mode_edges, Shape{g, s, k, r});
  visit("residualFactor", t.residual_factor,
        t.has_rotations ? Shape{t.residual_rank, g * s * k} : Shape{t.residual_rank, g * s});
  visit("singleHandleModes", t.single_handle_modes, Shape{s, h, 1 + r1});
  visit("singleEdges", t.single_edges, Shape{s, g, k, r1});
  visit("singleGroupFactors", t.single_group_factors, Shape{s, g, m * (m + 1) / 2});
  visit("singleModeTransforms", t.single_mode_transforms, Shape{s, h * (k + 1), 1 + r1});
  visit("handleReach", t.handle_reach, Shape{h, h});
}

}  // namespace limber
