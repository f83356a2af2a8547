#include "solve/nearness_step.h"

#include "core/vector.h"
#include "solve/patch_turns.h"
#include "solve/rotation_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber {
namespace {

// What rounding may add to a root, of itself and of the norm of the group's edges.
constexpr double kRootRounding = 1e-6;

}  // namespace

template <int K>
NearnessStep<K>::NearnessStep(const PoseModel& model, size_t max_pins)
    : kernels_(ChooseSolveKernels<K>()),
      shape_planes_(model.group_chunks() * kBlockLanes * K * K),
      size_(model.single_size()),
      stride_(model.single_stride()),
      memory_(MakeMemory(model)),
      last_rotations_(shape_planes_),
      last_modes_(K * stride_),
      gaps_(std::max(max_pins, model.pins->capacity()) * K),
      images_(gaps_.size() / K),
      fits_(shape_planes_),
      turned_(model.group_chunks() * kBlockLanes),
      squares_(memory_.lower.size() * kBlockLanes),
      rows_done_(memory_.lower.size()),
      failed_(model.group_chunks() * kBlockLanes) {
  Reset();
}

template <int K>
typename NearnessStep<K>::Memory NearnessStep<K>::MakeMemory(const PoseModel& model) {
  const auto shapes = static_cast<size_t>(model.num_shapes);
  return {AlignedVector<double>(shapes * model.group_chunks() * kBlockLanes * K * K),
          AlignedVector<double>(shapes * K * model.single_stride()),
          Vector<double>(static_cast<size_t>(model.num_blocks))};
}

template <int K>
void NearnessStep<K>::Reset() {
  SetIdentity<K>(&memory_.rotations);
  std::fill(memory_.modes.begin(), memory_.modes.end(), 0.0);
  std::fill(memory_.lower.begin(), memory_.lower.end(), 0.0);
}

// z = b + C^T y with b = sum_g K_g^T R_g^T, y = W (X - C b), as in constraint_system.h.
template <int K>
void NearnessStep<K>::MeetTargets(const PoseModel& model, const PinSet& pins, size_t shape,
                                  const double* targets, const double* turns) {
  const auto groups = static_cast<size_t>(model.num_groups);
  const size_t count = pins.size(), chunks = stride_ / kBlockLanes;
  double* modes = Modes(shape);
  for (size_t c = 0; c < K; ++c)
    std::fill_n(modes + c * stride_ + (size_ - K), K, 0.0);
  std::copy_n(modes, K * stride_, last_modes_.data());
  kernels_.single_modes(model.single_edges_by_mode.data() + shape * groups * K * stride_,
                        Rotations(shape), groups, chunks, modes);
  const double* held = pins.single_modes(shape);
  for (size_t c = 0; c < K; ++c) {
    kernels_.dot_rows(held, stride_, count, modes + c * stride_, chunks, images_.data());
    for (size_t p = 0; p < count; ++p)
      gaps_[p * K + c] = targets[p * K + c] - images_[p];
  }
  // Of a turned patch the images so far are the free ones: less themselves turned.
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const auto& [first, patch] = pins.turns[turn];
    double images[K * K];
    for (size_t i = 0; i < patch.count * K; ++i)
      images[i] = targets[first * K + i] - gaps_[first * K + i];
    const Eigen::Matrix<double, K, K> to_target =
        TurnToTarget<K>(patch, images, turns + turn * K * K);
    for (size_t i = 0; i < patch.count; ++i) {
      const Eigen::Map<const Eigen::Matrix<double, K, 1>> image(images + i * K);
      Eigen::Map<Eigen::Matrix<double, K, 1>>{gaps_.data() + (first + i)* K} =
          to_target * image - image;
    }
  }
  const double* response = pins.single_response(shape);
  for (size_t c = 0; c < K; ++c) {
    double* answers = images_.data();
    for (size_t p = 0; p < count; ++p) {
      const double* row = response + p * count;  // symmetric
      answers[p] = 0;
      for (size_t other = 0; other < count; ++other)
        answers[p] += row[other] * gaps_[other * K + c];
    }
    kernels_.add_rows(held, stride_, answers, count, chunks, modes + c * stride_);
  }
}

template <int K>
void NearnessStep<K>::FitRotations(const PoseModel& model, size_t shape) {
  const auto modes = static_cast<size_t>(model.num_single_modes);
  std::copy_n(Rotations(shape), shape_planes_, last_rotations_.data());
  kernels_.single_fits(
      model.single_edges_by_group.data() + shape * model.group_chunks() * modes * K * kBlockLanes,
      Modes(shape), modes, stride_, model.group_chunks(), fits_.data());
  FitRotationPlanes<K>(kernels_, static_cast<size_t>(model.num_groups), fits_, Rotations(shape),
                       &failed_);
}

// How far the roots of one shape can have fallen since the last call.
template <int K>
void NearnessStep<K>::LowerBounds(const PoseModel& model, size_t shape) {
  const double* modes = Modes(shape);
  kernels_.add_scaled(-1, modes, K * stride_ / kBlockLanes, last_modes_.data());
  const double squared =
      kernels_.dot(last_modes_.data(), last_modes_.data(), K * stride_ / kBlockLanes);
  const double moved = std::sqrt(squared) * (1 + kRootRounding);
  kernels_.rotation_changes(Rotations(shape), last_rotations_.data(), model.group_chunks(),
                            turned_.data());
  for (size_t g = 0; g < static_cast<size_t>(model.num_groups); ++g) {
    const size_t block = g * static_cast<size_t>(model.num_shapes) + shape;
    const double fall = moved + model.single_edge_norms[block] * (turned_[g] + kRootRounding);
    memory_.lower[block] = std::max(0.0, memory_.lower[block] - fall);
  }
}

template <int K>
void NearnessStep<K>::Run(const PoseModel& model, const PinSet& pins, const double* targets,
                          bool hold_rotations, const double* turns) {
  for (size_t s = 0; s < static_cast<size_t>(model.num_shapes); ++s) {
    MeetTargets(model, pins, s, targets, turns);
    if (hold_rotations) {
      std::copy_n(Rotations(s), shape_planes_, last_rotations_.data());
    } else {
      FitRotations(model, s);
    }
    LowerBounds(model, s);
  }
  std::fill(rows_done_.begin(), rows_done_.end(), size_t{0});
}

template <int K>
double NearnessStep<K>::RaiseBound(const PoseModel& model, int block, double at_least) {
  const auto i = static_cast<size_t>(block);
  if (memory_.lower[i] >= at_least || is_exact(block)) return memory_.lower[i];
  const size_t shapes = static_cast<size_t>(model.num_shapes), s = i % shapes, g = i / shapes;
  double *modes = Modes(s), *squares = squares_.data() + i * kBlockLanes;
  if (rows_done_[i] == 0) std::fill_n(squares, kBlockLanes, 0.0);
  for (size_t c = 0; c < K; ++c) {
    for (size_t a = 0; a < K; ++a)
      modes[c * stride_ + (size_ - K) + a] = -Rotations(s)[PlaneIndex<K>(g, c, a)];
  }
  const double root = std::sqrt(
      kernels_.single_energy(model.single_heads.data() + i * size_ * kBlockLanes,
                             model.single_tails.data() + i * model.single_tail_size, modes, size_,
                             stride_, at_least * at_least, &rows_done_[i], squares));
  memory_.lower[i] = is_exact(block) ? root : std::max(memory_.lower[i], root);
  return memory_.lower[i];
}

template <int K>
double NearnessStep<K>::Root(const PoseModel& model, int block) {
  return RaiseBound(model, block, std::numeric_limits<double>::infinity());
}

template class NearnessStep<2>;
template class NearnessStep<3>;

}  // namespace limber
