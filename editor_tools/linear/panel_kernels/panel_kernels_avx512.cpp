// SupernodalCholesky's kernels for AVX-512; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE panel_avx512
#include "linear/panel_kernels/panel_kernels_body.h"

namespace limber::linear {

const PanelKernels kAvx512PanelKernels = panel_avx512::MakeTable("AVX-512");

}  // namespace limber::linear
