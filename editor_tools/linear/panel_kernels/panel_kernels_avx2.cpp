// SupernodalCholesky's kernels for AVX2 with FMA; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE panel_avx2
#include "linear/panel_kernels/panel_kernels_body.h"

namespace limber::linear {

const PanelKernels kAvx2PanelKernels = panel_avx2::MakeTable("AVX2");

}  // namespace limber::linear
