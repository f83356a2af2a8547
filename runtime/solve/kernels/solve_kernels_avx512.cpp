// The solver's kernels for AVX-512; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE kernels_avx512
#include "solve/kernels/kernel_sets.h"
#include "solve/kernels/solve_kernels_table.h"

namespace limber {

const SolveKernels kAvx512Kernels2 = kernels_avx512::MakeTable<2>("AVX-512");
const SolveKernels kAvx512Kernels3 = kernels_avx512::MakeTable<3>("AVX-512");

}  // namespace limber
