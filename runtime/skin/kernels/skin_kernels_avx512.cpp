// Skinning for AVX-512; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE skin_avx512
#include "skin/kernels/skin_frames_body.h"
#include "skin/kernels/skin_kernel_sets.h"
#include "skin/kernels/skin_kernels_body.h"

namespace limber {

const SkinKernels kAvx512SkinKernels = {"AVX-512", skin_avx512::Skin, skin_avx512::ComputeFrames,
                                        skin_avx512::ApplyFrames};

}  // namespace limber
