// The instruction sets that this build has skinning for.
#pragma once

#include "skin/kernels/skin_kernels.h"

namespace limber {

extern const SkinKernels kBaselineSkinKernels;
#ifdef LIMBER_X86_KERNELS
extern const SkinKernels kAvx2SkinKernels, kAvx512SkinKernels;
#endif

}  // namespace limber
