// Skinning for AVX2 with FMA; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE skin_avx2
#include "skin/kernels/skin_frames_body.h"
#include "skin/kernels/skin_kernel_sets.h"
#include "skin/kernels/skin_kernels_body.h"

namespace limber {

const SkinKernels kAvx2SkinKernels = {"AVX2", skin_avx2::Skin, skin_avx2::ComputeFrames,
                                      skin_avx2::ApplyFrames};

}  // namespace limber
