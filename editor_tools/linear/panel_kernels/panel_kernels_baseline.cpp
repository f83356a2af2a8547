// SupernodalCholesky's kernels for the baseline of the processor family.
#define LIMBER_KERNEL_NAMESPACE panel_baseline
#include "linear/panel_kernels/panel_kernels_body.h"

namespace limber::linear {

const PanelKernels kBaselinePanelKernels = panel_baseline::MakeTable("baseline");

}  // namespace limber::linear
