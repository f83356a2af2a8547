#include "bake/cholesky_kernels/cholesky_kernels.h"

namespace limber::bake {
namespace {

constexpr int kMostSets = 4;

struct Sets {
  const CholeskyKernels* available[kMostSets] = {};
  int count = 0;

  Sets() {
    available[count++] = &kBaselineCholeskyKernels;
#ifdef LIMBER_X86_CHOLESKY_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      available[count++] = &kAvx2CholeskyKernels;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) {
      available[count++] = &kAvx512CholeskyKernels;
    }
#endif
  }
};

const Sets& AllSets() {
  static const Sets sets;
  return sets;
}

}  // namespace

const CholeskyKernels& ChooseCholeskyKernels() {
  return *AllSets().available[AllSets().count - 1];
}

const CholeskyKernels* const* AvailableCholeskyKernels() {
  return AllSets().available;
}

}  // namespace limber::bake
