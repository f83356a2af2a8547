// The instruction sets that this build has kernels for (k = 2 and 3 each).
#pragma once

#include "solve/kernels/solve_kernels.h"

namespace limber {

extern const SolveKernels kBaselineKernels2, kBaselineKernels3;
#ifdef LIMBER_X86_KERNELS
extern const SolveKernels kAvx2Kernels2, kAvx2Kernels3;
extern const SolveKernels kAvx512Kernels2, kAvx512Kernels3;
#endif

}  // namespace limber
