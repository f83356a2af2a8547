// What tests of the solver's kernels share: numbers to try, and every instruction set in turn.
#pragma once

#include "core/rotation_fit.h"
#include "solve/kernels/solve_kernels.h"
#include "solve/rotation_planes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>

namespace limber::test {

inline constexpr size_t kBlocks = 21;  // three chunks, the last not full

class Numbers {
 public:
  AlignedVector<double> Some(size_t count) {
    AlignedVector<double> numbers(count);
    for (double& number : numbers)
      number = range_(engine_);
    return numbers;
  }

  template <int K>
  AlignedVector<double> Rotations(size_t count) {
    AlignedVector<double> planes(PaddedSize(count) * K * K);
    SetIdentity<K>(&planes);
    for (size_t i = 0; i < count; ++i) {
      Eigen::Matrix<double, K, K> m;
      for (double& entry : m.reshaped())
        entry = range_(engine_);
      const Eigen::Matrix<double, K, K> rotation = FitRotation<K>(m);
      for (int row = 0; row < K; ++row) {
        for (int column = 0; column < K; ++column)
          planes[PlaneIndex<K>(i, size_t(row), size_t(column))] = rotation(row, column);
      }
    }
    return planes;
  }

 private:
  std::mt19937 engine_{7};
  std::uniform_real_distribution<double> range_{-1, 1};
};

template <int K>
Eigen::Matrix<double, K, K> RowMajor(const double* m) {
  return Eigen::Map<const Eigen::Matrix<double, K, K, Eigen::RowMajor>>(m);
}

template <class Dimension>
class KernelTest : public testing::Test {
 protected:
  static constexpr int kDimension = Dimension::value;

  template <class Check>
  void ForEachSet(const Check& check) {
    for (const SolveKernels* const* set = AvailableSolveKernels<kDimension>(); *set != nullptr;
         ++set) {
      SCOPED_TRACE((*set)->instruction_set);
      check(**set);
    }
  }

  // What `run` computes must have the same bits in all sets but the baseline.
  template <class Run>
  void ExpectSameBits(const Run& run) {
    AlignedVector<double> first;
    ForEachSet([&](const SolveKernels& set) {
      if (std::string(set.instruction_set) == "baseline") return;
      const AlignedVector<double> result = run(set);
      if (first.empty()) first = result;
      EXPECT_EQ(std::memcmp(first.data(), result.data(), first.size() * sizeof(double)), 0);
    });
  }

  Numbers numbers_;
  const size_t chunks_ = NumChunks(kBlocks);
};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;

}  // namespace limber::test
