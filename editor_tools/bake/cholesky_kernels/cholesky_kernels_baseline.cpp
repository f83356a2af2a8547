// LaneCholesky's kernels for the baseline of the processor family.
#define LIMBER_KERNEL_NAMESPACE cholesky_baseline
#include "bake/cholesky_kernels/cholesky_kernels_body.h"

namespace limber::bake {

const CholeskyKernels kBaselineCholeskyKernels = cholesky_baseline::MakeTable("baseline");

}  // namespace limber::bake
