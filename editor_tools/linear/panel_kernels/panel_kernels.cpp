#include "linear/panel_kernels/panel_kernels.h"

namespace limber::linear {
namespace {

constexpr int kMostSets = 4;

struct Sets {
  const PanelKernels* available[kMostSets] = {};
  int count = 0;

  Sets() {
    available[count++] = &kBaselinePanelKernels;
#ifdef LIMBER_X86_PANEL_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      available[count++] = &kAvx2PanelKernels;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) {
      available[count++] = &kAvx512PanelKernels;
    }
#endif
  }
};

const Sets& AllSets() {
  static const Sets sets;
  return sets;
}

}  // namespace

const PanelKernels& ChoosePanelKernels() {
  return *AllSets().available[AllSets().count - 1];
}

const PanelKernels* const* AvailablePanelKernels() {
  return AllSets().available;
}

}  // namespace limber::linear
