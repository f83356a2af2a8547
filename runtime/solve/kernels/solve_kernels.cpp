#include "solve/kernels/solve_kernels.h"

#include "solve/kernels/kernel_sets.h"

namespace limber {
namespace {

constexpr int kMaxSets = 4;

template <int K>
const SolveKernels* Set(const SolveKernels& plane, const SolveKernels& space) {
  return K == 2 ? &plane : &space;
}

// Null-terminated, narrowest first.
template <int K>
struct Sets {
  const SolveKernels* available[kMaxSets] = {};
  int count = 0;

  Sets() {
    available[count++] = Set<K>(kBaselineKernels2, kBaselineKernels3);
#ifdef LIMBER_X86_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      available[count++] = Set<K>(kAvx2Kernels2, kAvx2Kernels3);
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
      available[count++] = Set<K>(kAvx512Kernels2, kAvx512Kernels3);
    }
#endif
  }
};

template <int K>
const Sets<K>& AllSets() {
  static const Sets<K> sets;
  return sets;
}

}  // namespace

template <int K>
const SolveKernels& ChooseSolveKernels() {
  return *AllSets<K>().available[AllSets<K>().count - 1];
}

template <int K>
const SolveKernels* const* AvailableSolveKernels() {
  return AllSets<K>().available;
}

template const SolveKernels& ChooseSolveKernels<2>();
template const SolveKernels& ChooseSolveKernels<3>();
template const SolveKernels* const* AvailableSolveKernels<2>();
template const SolveKernels* const* AvailableSolveKernels<3>();

}  // namespace limber
