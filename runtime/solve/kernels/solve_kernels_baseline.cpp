// The solver's kernels for the instruction set that the rest of the library is compiled for.
#define LIMBER_KERNEL_NAMESPACE kernels_baseline
#include "solve/kernels/kernel_sets.h"
#include "solve/kernels/solve_kernels_table.h"

namespace limber {

const SolveKernels kBaselineKernels2 = kernels_baseline::MakeTable<2>("baseline");
const SolveKernels kBaselineKernels3 = kernels_baseline::MakeTable<3>("baseline");

}  // namespace limber
