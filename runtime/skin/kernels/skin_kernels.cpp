#include "skin/kernels/skin_kernels.h"

#include "skin/kernels/skin_kernel_sets.h"

namespace limber {
namespace {

// Null-terminated, narrowest first.
struct Sets {
  const SkinKernels* available[4] = {};
  int count = 0;

  Sets() {
    available[count++] = &kBaselineSkinKernels;
#ifdef LIMBER_X86_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      available[count++] = &kAvx2SkinKernels;
    if (__builtin_cpu_supports("avx512f")) available[count++] = &kAvx512SkinKernels;
#endif
  }
};

const Sets& AllSets() {
  static const Sets sets;
  return sets;
}

}  // namespace

const SkinKernels& ChooseSkinKernels() {
  return *AllSets().available[AllSets().count - 1];
}

const SkinKernels* const* AvailableSkinKernels() {
  return AllSets().available;
}

}  // namespace limber
