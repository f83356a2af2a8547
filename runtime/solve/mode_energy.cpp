#include "solve/mode_energy.h"

#include "solve/rotation_planes.h"

#include <Eigen/LU>

#include <algorithm>

namespace limber {
namespace {

// eps of A + eps I, of the block's size.
constexpr double kSingular = 1e-9;

// Lanes that a sum over modes is kept in, so that it is done eight at a time.
constexpr size_t kLanes = 8;

// sum_m row[m] modes[c][m] for every c.
template <int K>
void TimesModes(const float* row, const double* modes, size_t num_modes, size_t stride,
                double* values) {
  for (size_t c = 0; c < K; ++c, modes += stride) {
    double lanes[kLanes] = {};
    size_t m = 0;
    for (; m + kLanes <= num_modes; m += kLanes) {
      for (size_t lane = 0; lane < kLanes; ++lane)
        lanes[lane] += static_cast<double>(row[m + lane]) * modes[m + lane];
    }
    for (; m < num_modes; ++m)
      lanes[m % kLanes] += static_cast<double>(row[m]) * modes[m];
    values[c] = ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
                ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
  }
}

}  // namespace

template <>
Eigen::Matrix2d PullBack<2>(const Eigen::Matrix2d& fit, const Eigen::Matrix2d& rotation,
                            const Eigen::Matrix2d& pull) {
  const double size = fit.norm() + pull.norm();
  if (!(size > 0)) return Eigen::Matrix2d::Zero();
  const Eigen::Matrix2d z = rotation * pull;
  const double p = (z(1, 0) - z(0, 1)) / ((rotation * fit).trace() + kSingular * size);
  return rotation.transpose() * Eigen::Matrix2d{{0, -p}, {p, 0}};
}

template <>
Eigen::Matrix3d PullBack<3>(const Eigen::Matrix3d& fit, const Eigen::Matrix3d& rotation,
                            const Eigen::Matrix3d& pull) {
  const double size = fit.norm() + pull.norm();
  if (!(size > 0)) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d s = rotation * fit, z = rotation * pull;
  const Eigen::Matrix3d a =
      (s.trace() + kSingular * size) * Eigen::Matrix3d::Identity() - 0.5 * (s + s.transpose());
  const Eigen::Vector3d p =
      a.inverse() * Eigen::Vector3d(z(2, 1) - z(1, 2), z(0, 2) - z(2, 0), z(1, 0) - z(0, 1));
  return rotation.transpose() *
         Eigen::Matrix3d{{0, -p[2], p[1]}, {p[2], 0, -p[0]}, {-p[1], p[0], 0}};
}

template <int K>
ModeEnergy<K>::ModeEnergy(const PoseModel& model)
    : kernels_(ChooseSolveKernels<K>()),
      stride_(PaddedSize(static_cast<size_t>(model.num_modes))),
      fits_(model.chunks() * kBlockLanes * K * K),
      near_(fits_),
      singles_(static_cast<size_t>(model.num_blocks) * K * kQuadLanes),
      active_(model.num_blocks),
      failed_(model.chunks() * kBlockLanes) {}

template <int K>
void ModeEnergy<K>::TimesEdges(const PoseModel& model, const double* modes, double* planes) const {
  const auto r = static_cast<size_t>(model.num_modes);
  const float* row = model.rig->tables().mode_edges.data();
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    for (size_t a = 0; a < K; ++a, row += r) {
      double values[K];
      TimesModes<K>(row, modes, r, stride_, values);
      for (size_t c = 0; c < K; ++c)
        planes[PlaneIndex<K>(i, a, c)] = values[c];
    }
  }
}

// modes(c, :) += sum_a m(c, a) K_z,block(a, :).
template <int K>
void ModeEnergy<K>::AddEdges(const PoseModel& model, int block, const double* m,
                             double* modes) const {
  const auto r = static_cast<size_t>(model.num_modes);
  const float* rows = model.rig->tables().mode_edges.data() + static_cast<size_t>(block) * K * r;
  for (size_t c = 0; c < K; ++c) {
    for (size_t a = 0; a < K; ++a) {
      const double scale = m[c * K + a];
      for (size_t i = 0; i < r; ++i)
        modes[c * stride_ + i] += scale * static_cast<double>(rows[a * r + i]);
    }
  }
}

template <int K>
void ModeEnergy<K>::Wanted(const PoseModel& model, const AlignedVector<double>& blend,
                           const AlignedVector<double>& rotations, double* modes) {
  std::fill_n(modes, size(), 0.0);
  active_.Collect(blend, rotations);
  for (size_t at = 0; at < active_.size(); ++at)
    AddEdges(model, active_.blocks()[at], active_.scaled(at), modes);
}

// The second fit starts where the first ended: nothing of the start is left but its choice between
// equals, and E_d(z, B, R(z)) is a function of z.
template <int K>
void ModeEnergy<K>::FitRotations(const PoseModel& model, const double* modes,
                                 AlignedVector<double>* rotations) {
  TimesEdges(model, modes, fits_.data());
  for (int pass = 0; pass < 2; ++pass) {
    FitRotationPlanes<K>(kernels_, static_cast<size_t>(model.num_blocks), fits_, rotations->data(),
                         &failed_);
  }
}

// P of the active blocks, from the table in double precision: E_d cancels.
template <int K>
void ModeEnergy<K>::Multiply(const PoseModel& model, AlignedVector<double>* product) {
  std::fill(singles_.begin(), singles_.end(), 0.0);
  kernels_.add_single_products(model.gram.data(), model.gram_stride, active_.blocks().data(),
                               active_.scaled(0), active_.size(),
                               static_cast<size_t>(model.num_blocks), singles_.data());
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    for (size_t a = 0; a < K; ++a) {
      for (size_t c = 0; c < K; ++c)
        (*product)[PlaneIndex<K>(i, a, c)] = singles_[(i * K + a) * kQuadLanes + c];
    }
  }
}

template <int K>
void ModeEnergy<K>::Evaluate(const PoseModel& model, const double* modes,
                             const AlignedVector<double>& blend,
                             const AlignedVector<double>& rotations, Parts* parts) {
  Wanted(model, blend, rotations, parts->gap.data());  // collects the active blocks, too
  for (size_t i = 0; i < size(); ++i)
    parts->gap[i] = modes[i] - parts->gap[i];
  Multiply(model, &parts->product);
  double rest = 0;
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    if (blend[i] == 0) continue;
    rest += blend[i] *
            (MatrixOfBlock<K>(rotations.data(), i) * MatrixOfBlock<K>(parts->product.data(), i))
                .trace();
  }
  const double gap = kernels_.dot(parts->gap.data(), parts->gap.data(), size() / kBlockLanes);
  parts->energy = std::max(0.5 * (gap + rest), 0.0);
}

template <int K>
void ModeEnergy<K>::SlopeThroughRotations(const PoseModel& model, const double* modes,
                                          const AlignedVector<double>& blend,
                                          const AlignedVector<double>& rotations, double* slope) {
  TimesEdges(model, modes, fits_.data());
  std::fill(near_.begin(), near_.end(), 0.0);
  active_.Collect(blend, rotations);
  AddNearProducts(kernels_, model, active_, &near_);
  std::fill_n(slope, size(), 0.0);
  for (int i = 0; i < model.num_blocks; ++i) {
    const auto block = static_cast<size_t>(i);
    if (blend[block] == 0) continue;
    const Eigen::Matrix<double, K, K, Eigen::ColMajor> pulled = PullBack<K>(
        MatrixOfBlock<K>(fits_.data(), block), MatrixOfBlock<K>(rotations.data(), block),
        blend[block] * MatrixOfBlock<K>(near_.data(), block));
    AddEdges(model, i, pulled.data(), slope);  // read by rows: its transpose
  }
}

template <int K>
void ModeEnergy<K>::AtPins(const PinSet& pins, const double* modes, double* values) const {
  const auto held = pins.system.modes();
  const auto root = pins.system.root();
  std::fill_n(values, pins.load_stride() * K, 0.0);
  for (Eigen::Index pin = 0; pin < held.rows(); ++pin) {
    double at_pin[K] = {};
    for (Eigen::Index m = 0; m < held.cols(); ++m) {
      for (size_t c = 0; c < K; ++c)
        at_pin[c] += held(pin, m) * modes[c * stride_ + static_cast<size_t>(m)];
    }
    for (Eigen::Index p = 0; p < root.cols(); ++p) {
      for (size_t c = 0; c < K; ++c)
        values[c * pins.load_stride() + static_cast<size_t>(p)] += root(pin, p) * at_pin[c];
    }
  }
}

template <int K>
void ModeEnergy<K>::AddPinned(const PinSet& pins, const double* values, double* modes) const {
  const auto held = pins.system.modes();
  const auto root = pins.system.root();
  for (Eigen::Index pin = 0; pin < held.rows(); ++pin) {
    double at_pin[K] = {};
    for (Eigen::Index p = 0; p < root.cols(); ++p) {
      for (size_t c = 0; c < K; ++c)
        at_pin[c] += root(pin, p) * values[c * pins.load_stride() + static_cast<size_t>(p)];
    }
    for (Eigen::Index m = 0; m < held.cols(); ++m) {
      for (size_t c = 0; c < K; ++c)
        modes[c * stride_ + static_cast<size_t>(m)] += held(pin, m) * at_pin[c];
    }
  }
}

// t is the mean of X - C z: pins that cannot all be met are met in the least-squares sense.
template <int K>
void ModeEnergy<K>::Transforms(const PoseModel& model, const PinSet& pins, const double* modes,
                               const double* targets, AlignedVector<double>* transforms) const {
  const auto held = pins.system.modes();
  double translation[K] = {};
  for (Eigen::Index pin = 0; pin < held.rows(); ++pin) {
    for (size_t c = 0; c < K; ++c) {
      double at_pin = 0;
      for (Eigen::Index m = 0; m < held.cols(); ++m)
        at_pin += held(pin, m) * modes[c * stride_ + static_cast<size_t>(m)];
      translation[c] +=
          (targets[static_cast<size_t>(pin) * K + c] - at_pin) / static_cast<double>(held.rows());
    }
  }
  const RigTables& tables = model.rig->tables();
  const auto r = static_cast<size_t>(model.num_modes);
  const float* row = tables.mode_transforms.data();
  for (size_t i = 0; i < static_cast<size_t>(tables.num_transform_rows()); ++i, row += 1 + r) {
    double values[K];
    TimesModes<K>(row + 1, modes, r, stride_, values);
    for (size_t c = 0; c < K; ++c) {
      (*transforms)[(i / kBlockLanes * K + c) * kBlockLanes + i % kBlockLanes] =
          values[c] + static_cast<double>(row[0]) * translation[c];
    }
  }
}

template class ModeEnergy<2>;
template class ModeEnergy<3>;

}  // namespace limber
