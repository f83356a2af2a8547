// What a rig will cost in the file and in the game, told before the minutes of a bake are spent.
#pragma once

#include "core/status.h"
#include "rig/rig_tables.h"

#include <cstdint>

namespace limber::bake {

// The numbers that everything else follows from.
struct RigSize {
  int dimension = 3;              // k
  int num_handles = 0;            // H
  int num_shapes = 0;             // S
  int num_groups = 0;             // G
  bool rotations = true;          // as BakeOptions::rotations
  int64_t num_vertices = 0;       // V, solve vertices
  int64_t num_draw_vertices = 0;  // D
};

struct RigCost {
  uint64_t file_bytes = 0;   // what the bake adds to the source file
  uint64_t model_bytes = 0;  // the solver's tables, shared by all characters of the rig
  uint64_t mesh_bytes = 0;   // weights and example shapes, shared likewise
  // Each character on the screen beside that, less what its vertices take; one with a PoseState of
  // its own (pose_solver.h) takes some twenty times as much.
  uint64_t character_bytes = 0;
  double alternation_seconds = 0;
};

RigSize SizeOf(const RigTables& tables, int64_t num_vertices, int64_t num_draw_vertices);

// Before the bake num_modes, r, is not known: the bytes are then upper bounds, reached where
// nothing in the examples is linearly dependent and nothing is small. With tables, table_bytes is
// what they take in the file (pack_tables.h). alternation_seconds is a fit to measurements
// (tests/benchmarks/README.md): a desktop core of 2023 that has its caches to itself, to a factor
// of two.
RigCost EstimateCost(const RigSize& size);
RigCost EstimateCost(const RigTables& tables, uint64_t table_bytes, int64_t num_vertices,
                     int64_t num_draw_vertices);

// kLimitExceeded, in one line that says what to reduce and to how many, where the solver would
// refuse the rig.
Status CheckRigSize(const RigSize& size);

}  // namespace limber::bake
