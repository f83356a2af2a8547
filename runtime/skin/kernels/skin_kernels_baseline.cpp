// Skinning for every machine of its kind.
#define LIMBER_KERNEL_NAMESPACE skin_baseline
#include "skin/kernels/skin_frames_body.h"
#include "skin/kernels/skin_kernel_sets.h"
#include "skin/kernels/skin_kernels_body.h"

namespace limber {

const SkinKernels kBaselineSkinKernels = {"baseline", skin_baseline::Skin,
                                          skin_baseline::ComputeFrames, skin_baseline::ApplyFrames};

}  // namespace limber
