// LaneCholesky's kernels for AVX2 with FMA; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE cholesky_avx2
#include "bake/cholesky_kernels/cholesky_kernels_body.h"

namespace limber::bake {

const CholeskyKernels kAvx2CholeskyKernels = cholesky_avx2::MakeTable("AVX2");

}  // namespace limber::bake
