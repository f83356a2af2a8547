// The solver's kernels for AVX2; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE kernels_avx2
#include "solve/kernels/kernel_sets.h"
#include "solve/kernels/solve_kernels_table.h"

namespace limber {

const SolveKernels kAvx2Kernels2 = kernels_avx2::MakeTable<2>("AVX2");
const SolveKernels kAvx2Kernels3 = kernels_avx2::MakeTable<3>("AVX2");

}  // namespace limber
