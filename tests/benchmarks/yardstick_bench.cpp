// What the machine can do at best: the two numbers that everything else is held against.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstring>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace {

constexpr int kSteps = 4096;
// Independent chains: more than latency times throughput (four cycles, two a cycle), and few enough
// for the sixteen registers of AVX2.
constexpr int kChains = 12;

// Each Run does kSteps * kChains multiply-adds of `lanes` floats, x = 0.5 x + 1, which settles at
// 2: neither infinite nor denormal.
struct Kernel {
  const char* name;
  int lanes;
  float (*run)();
};

// A macro and no template, because what a function may use of the processor belongs to its
// declaration. `multiply_add(x, y, z)` is x y + z; the last argument goes before the declaration.
#define LIMBER_YARDSTICK_KERNEL(name, vector, multiply_add, target) \
  target float name() {                                             \
    using Vector = vector;                                          \
    const Vector half = Vector{} + 0.5f, one = Vector{} + 1.0f;     \
    Vector x[kChains];                                              \
    for (int c = 0; c < kChains; ++c)                               \
      x[c] = one;                                                   \
    for (int step = 0; step < kSteps; ++step) {                     \
      _Pragma("GCC unroll 12") for (int c = 0; c < kChains; ++c) {  \
        x[c] = multiply_add(x[c], half, one);                       \
      }                                                             \
    }                                                               \
    Vector sum = x[0];                                              \
    for (int c = 1; c < kChains; ++c)                               \
      sum += x[c];                                                  \
    return sum[0];                                                  \
  }

#if defined(__x86_64__)
LIMBER_YARDSTICK_KERNEL(RunAvx512, __m512, _mm512_fmadd_ps, [[gnu::target("avx512f")]])
LIMBER_YARDSTICK_KERNEL(RunAvx2, __m256, _mm256_fmadd_ps, [[gnu::target("avx2,fma")]])
#endif

using FourFloats = float __attribute__((vector_size(16)));

FourFloats MultiplyAdd(FourFloats x, FourFloats y, FourFloats z) {
  return x * y + z;
}

// Wherever the compiler has vectors; a multiplication and an addition where the processor has no
// fused one.
LIMBER_YARDSTICK_KERNEL(RunPortable, FourFloats, MultiplyAdd, )

#undef LIMBER_YARDSTICK_KERNEL

Kernel WidestKernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return {"AVX-512", 16, RunAvx512};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {"AVX2", 8, RunAvx2};
#endif
  return {"four lanes, not fused", 4, RunPortable};
}

void FusedMultiplyAdd(benchmark::State& state) {
  const Kernel kernel = WidestKernel();
  float result = 0;
  while (state.KeepRunning())
    benchmark::DoNotOptimize(result = kernel.run());
  // A chain that settles: 2 each after twenty-five steps, so the work was done and not left out.
  if (std::abs(result - 2.0f * kChains) > 1e-3f) state.SkipWithError("wrong sum");
  state.SetItemsProcessed(state.iterations() * kSteps * kChains * kernel.lanes);
  state.SetLabel(kernel.name);
}

// Bytes are counted once: each is read once and written once.
void Copy(benchmark::State& state, size_t bytes) {
  std::vector<char> from(bytes, 1), to(bytes, 2);
  while (state.KeepRunning()) {
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes));
}

constexpr size_t kSkinnedVertexBytes = 40;  // position, normal, tangent (SkinnedVertex)

BENCHMARK(FusedMultiplyAdd)->Name("yardstick/fma")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Copy, skinned, 24000 * kSkinnedVertexBytes)
    ->Name("yardstick/copy/24k")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Copy, memory, size_t{64} << 20)
    ->Name("yardstick/copy/64MB")
    ->Unit(benchmark::kMicrosecond);

}  // namespace
