// The tables of a rig as a baked file holds them: packed, and shorter where something stands for
// them.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "rig/local_group_factors.h"
#include "rig/rig_tables.h"

#include <cstdint>
#include <string>

namespace limber::bake {

struct PackedTable {
  std::string name;
  Vector<int64_t> shape;
  int exponent = 0;
  Vector<uint8_t> bytes;  // rig/packed_numbers.h
};

// Everything but empty tables. Where `local` is empty the energies of single groups are packed as
// `tables` has them. The error of a number is at most 2^-23 of the largest in its table (of
// modes: 2^-24, of transforms in their column), about that of single precision; for energies also
// at most 2^-19 of what tells the two examples apart that are most alike, unless that is finer than
// 2^-27 of the largest.
// Errors: kInvalidArgument (a table of another size than the counts say), kInternal (a number that
// is not finite); the message names the table and the element.
Result<Vector<PackedTable>> PackRigTables(const RigTables& tables, const LocalGroupFactors& local);

uint64_t NumBytes(const Vector<PackedTable>& tables);

}  // namespace limber::bake
