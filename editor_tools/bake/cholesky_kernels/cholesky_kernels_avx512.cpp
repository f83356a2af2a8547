// LaneCholesky's kernels for AVX-512; compiled with its own flags (CMakeLists.txt).
#define LIMBER_KERNEL_NAMESPACE cholesky_avx512
#include "bake/cholesky_kernels/cholesky_kernels_body.h"

namespace limber::bake {

const CholeskyKernels kAvx512CholeskyKernels = cholesky_avx512::MakeTable("AVX-512");

}  // namespace limber::bake
