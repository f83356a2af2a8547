// How the energies of single groups travel in a file: each in the transforms of only those handles
// that move the group's edges, which is a fraction of the modes that the solver uses.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "rig/rig_tables.h"

#include <cstdint>

namespace limber {

// With T the transforms ((k+1) x k each, the translation last) of the n_g handles that move group
// g, one below the other, and c_g = (k+1) n_g + k, the energy of group g in the model of shape s
// alone is E_g = |U_sg [T; -R^T]|^2, U_sg upper triangular.
struct LocalGroupFactors {
  Vector<float> group_handles;  // [G][H]: 1 where handle h moves edges of group g, else 0
  Vector<float> factors;  // [S] of [G] of U_sg, packed by rows: c_g (c_g + 1) / 2 numbers each
};

// Numbers in `factors` that group_handles asks for, all shapes together. Errors: kMalformed (it is
// not [G][H], or holds something that is neither 0 nor 1).
Result<int64_t> NumLocalFactors(const RigTables& tables, const Vector<float>& group_handles);

// Fills single_edges and single_group_factors from the other counts and tables, of which
// single_mode_transforms is read. Errors: kMalformed.
Status ExpandLocalGroupFactors(const LocalGroupFactors& local, RigTables* tables);

}  // namespace limber
