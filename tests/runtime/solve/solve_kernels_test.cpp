// Each kernel over blocks, of each instruction set, against the formula in its header, written
// plainly; and all sets with a fused multiply-add against each other, bit for bit.
#include "core/vector.h"
#include "runtime/solve/kernel_fixture.h"

#include <Eigen/Geometry>

namespace limber {
namespace {

using test::kBlocks;
using test::RowMajor;

template <class Dimension>
class SolveKernelsTest : public test::KernelTest<Dimension> {};

TYPED_TEST_SUITE(SolveKernelsTest, test::Dimensions);

TYPED_TEST(SolveKernelsTest, Traces_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  const auto planes = this->numbers_.Some(this->chunks_ * kBlockLanes * K * K);
  const auto rotations = this->numbers_.template Rotations<K>(kBlocks);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> traces(this->chunks_ * kBlockLanes);
    set.traces(rotations.data(), planes.data(), this->chunks_, traces.data());
    return traces;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> traces = run(set);
    for (size_t i = 0; i < kBlocks; ++i) {
      const Eigen::Matrix<double, K, K> rotation = MatrixOfBlock<K>(rotations.data(), i);
      EXPECT_NEAR(traces[i], (rotation * MatrixOfBlock<K>(planes.data(), i)).trace(), 1e-14);
    }
  });
  this->ExpectSameBits(run);
}

// Of some of the strips, in single precision and in double, of fewer chunks than are worked on at
// once and of more.
TYPED_TEST(SolveKernelsTest, Products_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  const Vector<int> blocks = {0, 2, 3, 4, 7, 8};
  for (const size_t chunks : {size_t{3}, size_t{32}, size_t{67}}) {
    const size_t size = chunks * kBlockLanes * K * K;
    const auto numbers = this->numbers_.Some(9 * size);
    const AlignedVector<float> floats(numbers.begin(), numbers.end());
    const AlignedVector<double> strips(floats.begin(), floats.end());
    const auto m = this->numbers_.Some(blocks.size() * K * K);
    const auto start = this->numbers_.Some(size);
    for (size_t count = 0; count <= blocks.size(); count += 3) {
      const auto run = [&](const SolveKernels& set) {
        AlignedVector<double> results(start);
        set.add_products(strips.data(), size, blocks.data(), m.data(), count, chunks,
                         results.data());
        return results;
      };
      this->ForEachSet([&](const SolveKernels& set) {
        const AlignedVector<double> results = run(set);
        for (size_t i = 0; i < chunks * kBlockLanes; ++i) {
          Eigen::Matrix<double, K, K> expected = MatrixOfBlock<K>(start.data(), i);
          for (size_t j = 0; j < count; ++j) {
            expected += MatrixOfBlock<K>(strips.data() + size_t(blocks[j]) * size, i).transpose() *
                        RowMajor<K>(m.data() + j * K * K).transpose();
          }
          EXPECT_LT((MatrixOfBlock<K>(results.data(), i) - expected).norm(), 1e-13);
        }
        AlignedVector<double> same(start);
        set.add_float_products(floats.data(), size, blocks.data(), m.data(), count, chunks,
                               same.data());
        EXPECT_EQ(same, results);
      });
      this->ExpectSameBits(run);
    }
  }
}

// Of fewer chunks of rows than are worked on at once and of more.
TYPED_TEST(SolveKernelsTest, Transforms_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  const Vector<int> blocks = {1, 2, 4};
  for (const size_t chunks : {size_t{1}, size_t{2}, size_t{3}, size_t{100}}) {
    const size_t size = chunks * K * kBlockLanes;
    const auto doubles = this->numbers_.Some(5 * size);
    const AlignedVector<float> tables(doubles.begin(), doubles.end());
    const auto m = this->numbers_.Some(blocks.size() * K * K);
    const auto start = this->numbers_.Some(size);
    const auto run = [&](const SolveKernels& set) {
      AlignedVector<double> results(start);
      set.add_transforms(tables.data(), blocks.data(), m.data(), blocks.size(), chunks,
                         results.data());
      return results;
    };
    this->ForEachSet([&](const SolveKernels& set) {
      const AlignedVector<double> results = run(set);
      for (size_t at = 0; at < size; ++at) {
        const size_t row = at / (K * kBlockLanes), c = at / kBlockLanes % K,
                     lane = at % kBlockLanes;
        double expected = start[at];
        for (size_t j = 0; j < blocks.size(); ++j) {
          for (size_t b = 0; b < K; ++b) {
            expected += double(tables[size_t(blocks[j]) * size + (row * K + b) * 8 + lane]) *
                        m[(j * K + c) * K + b];
          }
        }
        EXPECT_NEAR(results[at], expected, 1e-13);
      }
    });
    this->ExpectSameBits(run);
  }
}

TYPED_TEST(SolveKernelsTest, RotationChanges_AreNorms) {
  constexpr int K = TypeParam::value;
  const auto one = this->numbers_.template Rotations<K>(kBlocks);
  const auto other = this->numbers_.template Rotations<K>(kBlocks);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> changes(this->chunks_ * kBlockLanes);
    set.rotation_changes(one.data(), other.data(), this->chunks_, changes.data());
    return changes;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> changes = run(set);
    for (size_t i = 0; i < kBlocks; ++i) {
      const double expected =
          (MatrixOfBlock<K>(one.data(), i) - MatrixOfBlock<K>(other.data(), i)).norm();
      EXPECT_NEAR(changes[i], expected, 1e-14);
    }
  });
  this->ExpectSameBits(run);
}

TYPED_TEST(SolveKernelsTest, PinLoads_AreTheirFormulas) {
  constexpr int K = TypeParam::value;
  const size_t pins = 5, stride = 6, padded = this->chunks_ * kBlockLanes;
  const auto loads = this->numbers_.Some(padded * K * pins);
  const auto rotations = this->numbers_.template Rotations<K>(kBlocks);
  const auto values = this->numbers_.Some(stride * K), start = this->numbers_.Some(padded * K * K);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> results(start);
    set.add_loads(loads.data(), values.data(), pins, stride, this->chunks_, results.data());
    AlignedVector<double> rows(pins * K * padded);
    set.rotate_loads(loads.data(), rotations.data(), pins, this->chunks_, rows.data());
    results.insert(results.end(), rows.begin(), rows.end());
    return results;
  };
  const auto load = [&](size_t i, int a, size_t p) {
    return loads[((i / kBlockLanes * K + size_t(a)) * pins + p) * kBlockLanes + i % kBlockLanes];
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> results = run(set);
    for (size_t i = 0; i < kBlocks; ++i) {
      const Eigen::Matrix<double, K, K> rotation = MatrixOfBlock<K>(rotations.data(), i);
      for (int c = 0; c < K; ++c) {
        for (int a = 0; a < K; ++a) {
          double sum = start[PlaneIndex<K>(i, size_t(a), size_t(c))];
          for (size_t p = 0; p < pins; ++p)
            sum += load(i, a, p) * values[size_t(c) * stride + p];
          EXPECT_NEAR(results[PlaneIndex<K>(i, size_t(a), size_t(c))], sum, 1e-14);
        }
        for (size_t p = 0; p < pins; ++p) {
          double turned = 0;
          for (int a = 0; a < K; ++a)
            turned += rotation(c, a) * load(i, a, p);
          EXPECT_NEAR(results[start.size() + (p * K + size_t(c)) * padded + i], turned, 1e-14);
        }
      }
    }
  });
  this->ExpectSameBits(run);
}

TYPED_TEST(SolveKernelsTest, ModelsOfOneShape_AreTheirFormulas) {
  constexpr int K = TypeParam::value;
  const size_t modes = 13, stride = PaddedSize(modes + K);
  const auto rotations = this->numbers_.template Rotations<K>(kBlocks);
  AlignedVector<float> by_mode(kBlocks * K * stride), by_group(this->chunks_ * modes * K * 8);
  const auto doubles = this->numbers_.Some(kBlocks * K * modes);
  const Vector<float> edge(doubles.begin(), doubles.end());
  for (size_t g = 0; g < kBlocks; ++g) {
    for (size_t a = 0; a < K; ++a) {
      for (size_t m = 0; m < modes; ++m) {
        by_mode[(g * K + a) * stride + m] = edge[(g * K + a) * modes + m];
        by_group[((g / 8 * modes + m) * K + a) * 8 + g % 8] = edge[(g * K + a) * modes + m];
      }
    }
  }
  AlignedVector<double> z(K * stride), fits(this->chunks_ * 8 * K * K);
  const auto run = [&](const SolveKernels& set) {
    set.single_modes(by_mode.data(), rotations.data(), kBlocks, stride / 8, z.data());
    set.single_fits(by_group.data(), z.data(), modes, stride, this->chunks_, fits.data());
    AlignedVector<double> all = z;
    all.insert(all.end(), fits.begin(), fits.end());
    return all;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    run(set);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(Eigen::Index(modes), K);
    const auto edges = [&](size_t g) {
      using Edges = Eigen::Matrix<float, K, Eigen::Dynamic, Eigen::RowMajor>;
      const Eigen::Map<const Edges> map(edge.data() + g * K * modes, K, Eigen::Index(modes));
      return Eigen::MatrixXd(map.template cast<double>());
    };
    for (size_t g = 0; g < kBlocks; ++g) {
      const Eigen::Matrix<double, K, K> rotation = MatrixOfBlock<K>(rotations.data(), g);
      expected += edges(g).transpose() * rotation.transpose();
    }
    for (Eigen::Index m = 0; m < expected.rows(); ++m) {
      for (Eigen::Index c = 0; c < K; ++c)
        EXPECT_NEAR(z[size_t(c) * stride + size_t(m)], expected(m, c), 1e-13);
    }
    for (size_t g = 0; g < kBlocks; ++g) {
      EXPECT_LT((MatrixOfBlock<K>(fits.data(), g) - edges(g) * expected).norm(), 1e-12);
    }
  });
  this->ExpectSameBits(run);
}

// |U x|^2 of triangles of all sizes around a chunk's.
TYPED_TEST(SolveKernelsTest, EnergyOfOneGroup_IsItsFormula) {
  constexpr int K = TypeParam::value;
  for (size_t size = 1; size <= 26; ++size) {
    const size_t stride = PaddedSize(size);
    const auto x = this->numbers_.Some(K * stride);
    Eigen::MatrixXf u = Eigen::MatrixXf::Zero(Eigen::Index(size), Eigen::Index(size));
    AlignedVector<float> factor;
    for (size_t first = 0; first < size; first += 8) {
      for (size_t column = first; column < size; ++column) {
        for (size_t row = first; row < first + 8; ++row) {
          const bool is_there = row <= column && row < size;
          factor.push_back(is_there ? static_cast<float>(this->numbers_.Some(1)[0]) : 0);
          if (is_there) u(Eigen::Index(row), Eigen::Index(column)) = factor.back();
        }
      }
    }
    Eigen::MatrixXd stacked(Eigen::Index(size), K);
    for (Eigen::Index row = 0; row < stacked.rows(); ++row) {
      for (Eigen::Index c = 0; c < K; ++c)
        stacked(row, c) = x[size_t(c) * stride + size_t(row)];
    }
    const double expected = (u.cast<double>() * stacked).squaredNorm();
    const auto run = [&](const SolveKernels& set) {
      size_t rows = 0;
      AlignedVector<double> squares(8), sums(1);  // eight rows after the other: each goes on
      while (rows < size) {
        sums.push_back(set.single_energy(factor.data(), factor.data() + 8 * size, x.data(), size,
                                         stride, std::nextafter(sums.back(), 1e9), &rows,
                                         squares.data()));
      }
      return sums;
    };
    this->ForEachSet([&](const SolveKernels& set) {
      const AlignedVector<double> sums = run(set);
      EXPECT_NEAR(sums.back(), expected, 1e-13 * expected);
      for (size_t chunk = 0; chunk < sums.size(); ++chunk) {
        const Eigen::Index rows = std::min(Eigen::Index(8 * chunk), u.rows());
        const double part = (u.topRows(rows).cast<double>() * stacked).squaredNorm();
        EXPECT_NEAR(sums[chunk], part, 1e-13 * expected);
      }
      size_t rows = 0;
      AlignedVector<double> squares(8);
      EXPECT_EQ(set.single_energy(factor.data(), factor.data() + 8 * size, x.data(), size, stride,
                                  INFINITY, &rows, squares.data()),
                sums.back())
          << "in one go or in several";
    });
    this->ExpectSameBits(run);
  }
}

// From starts near and far: what the kernel calls done is what a singular value decomposition
// gives, and what it gives up is as it was.
TYPED_TEST(SolveKernelsTest, Procrustes_IsTheGlobalMaximumOrSaysSo) {
  constexpr int K = TypeParam::value;
  const auto fits = this->numbers_.Some(this->chunks_ * 8 * K * K);
  for (const double distance : {0.0, 0.1, 0.5, 3.0}) {
    AlignedVector<double> starts(fits.size());
    SetIdentity<K>(&starts);
    for (size_t i = 0; i < kBlocks; ++i) {
      Eigen::Matrix<double, K, K> turned = FitRotation<K>(MatrixOfBlock<K>(fits.data(), i));
      if constexpr (K == 3) {
        turned =
            Eigen::AngleAxisd(distance, Eigen::Vector3d(1, double(i), -2).normalized()) * turned;
      } else {
        turned = Eigen::Rotation2Dd(distance) * turned;
      }
      for (int entry = 0; entry < K * K; ++entry) {
        starts[PlaneIndex<K>(i, size_t(entry / K), size_t(entry % K))] =
            turned(entry / K, entry % K);
      }
    }
    const auto run = [&](const SolveKernels& set) {
      AlignedVector<double> rotations = starts;
      Vector<uint8_t> failed(this->chunks_ * 8);
      set.fit_rotations(fits.data(), rotations.data(), this->chunks_, failed.data());
      size_t done = 0;
      for (size_t i = 0; i < kBlocks; ++i) {
        const Eigen::Matrix<double, K, K> rotation = MatrixOfBlock<K>(rotations.data(), i);
        const Eigen::Matrix<double, K, K> best = FitRotation<K>(MatrixOfBlock<K>(fits.data(), i));
        EXPECT_LT(
            (rotation * rotation.transpose() - Eigen::Matrix<double, K, K>::Identity()).norm(),
            1e-13);
        if (failed[i] != 0) continue;
        ++done;
        EXPECT_NEAR((rotation * MatrixOfBlock<K>(fits.data(), i)).trace(),
                    (best * MatrixOfBlock<K>(fits.data(), i)).trace(), 1e-12);
        EXPECT_LT((rotation - best).norm(), 1e-7) << i;
      }
      if (distance <= 0.1) {
        EXPECT_EQ(done, kBlocks);
      }
      return rotations;
    };
    this->ForEachSet([&](const SolveKernels& set) { run(set); });
    this->ExpectSameBits(run);
  }
}

// Nothing to go by, edges on one line, a reflection with equal singular values: the rotation stays
// as near as it can to what it was, frame after frame.
TYPED_TEST(SolveKernelsTest, Procrustes_WhereSeveralServe_KeepsTheLast) {
  constexpr int K = TypeParam::value;
  using Matrix = Eigen::Matrix<double, K, K>;
  const auto starts = this->numbers_.template Rotations<K>(kBlocks);
  AlignedVector<double> fits(starts.size());
  Matrix line = Matrix::Zero(), mirrored = -Matrix::Identity();
  line(0, 0) = 1;
  if (K == 2) mirrored(0, 0) = 1;
  for (size_t i = 0; i < kBlocks; ++i) {
    // Block 0, 3, ...: zero. 1, 4, ...: satisfied by the start already, but not only by it.
    const Matrix& pattern = i % 3 == 1 ? line : mirrored;
    const Matrix fit = pattern * MatrixOfBlock<K>(starts.data(), i).transpose();
    for (int entry = 0; entry < K * K; ++entry) {
      fits[PlaneIndex<K>(i, size_t(entry / K), size_t(entry % K))] =
          i % 3 == 0 ? 0 : fit(entry / K, entry % K);
    }
  }
  this->ForEachSet([&](const SolveKernels& set) {
    AlignedVector<double> rotations = starts;
    Vector<uint8_t> failed(this->chunks_ * 8);
    for (int frame = 0; frame < 1000; ++frame)
      set.fit_rotations(fits.data(), rotations.data(), this->chunks_, failed.data());
    for (size_t i = 0; i < kBlocks; ++i) {
      const Matrix rotation = MatrixOfBlock<K>(rotations.data(), i);
      EXPECT_LT((rotation * rotation.transpose() - Matrix::Identity()).norm(), 1e-13);
      if (i % 3 == 2) continue;  // at a reflection every choice is as good: only no drift is asked
      EXPECT_LT((rotation - MatrixOfBlock<K>(starts.data(), i)).norm(), 1e-9) << i;
    }
  });
}

}  // namespace
}  // namespace limber
