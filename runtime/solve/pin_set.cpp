#include "solve/pin_set.h"

#include <algorithm>

namespace limber {
namespace {

size_t NumShapesOfSingles(const Rig& rig) {
  return rig.num_shapes() == 1 ? 0 : static_cast<size_t>(rig.num_shapes());
}

}  // namespace

PinSet::PinSet(const Rig& rig, size_t max_rows, size_t max_turns)
    : system(max_rows, static_cast<size_t>(rig.tables().num_modes)),
      holds_capacity_(max_rows),
      dimension_(static_cast<size_t>(rig.dimension())),
      num_blocks_(static_cast<size_t>(rig.num_groups()) * static_cast<size_t>(rig.num_shapes())),
      num_transforms_(static_cast<size_t>(rig.tables().num_transform_rows())),
      num_shapes_(NumShapesOfSingles(rig)),
      single_stride_(PaddedSize(static_cast<size_t>(rig.tables().num_single_modes) + dimension_)),
      num_single_modes_(static_cast<size_t>(rig.tables().num_single_modes)),
      single_system_(max_rows, num_single_modes_),
      block_loads_(num_blocks_ * dimension_ * LoadStride(max_rows)),
      single_modes_(num_shapes_ * max_rows * single_stride_),
      single_response_(num_shapes_ * max_rows * max_rows) {
  const size_t padded = PaddedSize(num_blocks_);
  loads.resize(padded * dimension_ * max_rows);
  shifts.resize(padded * dimension_);
  const size_t bunches = (1 + max_rows + dimension_ - 1) / dimension_;
  transforms.resize(bunches * dimension_ * PaddedSize(num_transforms_));
  rows_.resize(max_rows);
  turns.reserve(max_turns);
  axis_loads.resize(padded * dimension_ * dimension_ * max_turns);
}

size_t PinSet::bytes() const {
  return BytesOf(loads, axis_loads, shifts, transforms, rows_, block_loads_, single_modes_,
                 single_response_) +
         system.bytes() + single_system_.bytes();
}

void PinSet::Build(const Rig& rig, std::span<const Hold> holds,
                   std::span<const TurnedPatch> turned) {
  turns.assign(turned.begin(), turned.end());  // within the room of construction
  for (size_t i = 0; i < holds.size(); ++i)
    rows_[i] = {holds[i].row.modes, holds[i].row.translation, holds[i].compliance};
  system.Compute({rows_.data(), holds.size()});
  LayOutAxes(holds);
  LayOutLoads(holds);
  LayOutTransforms(rig, holds);
  BuildSingles(holds);
}

void PinSet::LayOutAxes(std::span<const Hold> holds) {
  num_axes = 0;
  for (const TurnedPatch& turn : turns)
    num_axes += turn.patch.count;
  const size_t padded = PaddedSize(num_blocks_);
  std::fill_n(axis_loads.begin(), padded * dimension_ * num_axes, 0.0);
  size_t at = 0;
  for (const TurnedPatch& turn : turns) {
    for (size_t i = 0; i < turn.patch.count; ++i, ++at) {
      const double* load = holds[turn.first_row + i].row.loads;
      for (size_t row = 0; row < num_blocks_ * dimension_; ++row) {
        const size_t block = row / dimension_;
        const size_t plane = block / kBlockLanes * dimension_ + row % dimension_;
        axis_loads[(plane * num_axes + at) * kBlockLanes + block % kBlockLanes] = load[row];
      }
    }
  }
}

void PinSet::LayOutLoads(std::span<const Hold> holds) {
  const size_t padded = PaddedSize(num_blocks_), q = rank();
  const auto root = system.root();
  const auto translation = system.translation();
  std::fill(block_loads_.begin(), block_loads_.end(), 0.0);
  for (size_t row = 0; row < num_blocks_ * dimension_; ++row) {
    const size_t block = row / dimension_, axis = row % dimension_, chunk = block / kBlockLanes;
    double shift = 0;
    for (size_t i = 0; i < holds.size(); ++i)
      shift += holds[i].row.loads[row] * translation[static_cast<Eigen::Index>(i)];
    shifts[axis * padded + block] = shift;
    for (size_t p = 0; p < q; ++p) {
      const double* column = root.data() + p * holds.size();
      double load = 0;
      for (size_t i = 0; i < holds.size(); ++i)
        load += holds[i].row.loads[row] * column[i];
      loads[((chunk * dimension_ + axis) * q + p) * kBlockLanes + block % kBlockLanes] = load;
      block_loads_[row * load_stride() + p] = load;
    }
  }
  // The lanes past the last block, which another rank may have used for something else.
  for (size_t block = num_blocks_; block < padded; ++block) {
    for (size_t entry = 0; entry < dimension_ * q; ++entry)
      loads[(block / kBlockLanes * dimension_ * q + entry) * kBlockLanes + block % kBlockLanes] = 0;
  }
}

void PinSet::LayOutTransforms(const Rig& rig, std::span<const Hold> holds) {
  const RigTables& tables = rig.tables();
  const auto modes = 1 + static_cast<size_t>(tables.num_modes);
  const size_t padded = PaddedSize(num_transforms_);
  const auto root = system.root();
  std::fill(transforms.begin(), transforms.end(), 0.0f);
  for (size_t column = 0; column < 1 + rank(); ++column) {
    float* bunch = transforms.data() + column / dimension_ * dimension_ * padded +
                   column % dimension_ * kBlockLanes;
    for (size_t row = 0; row < num_transforms_; ++row) {
      double sum = 0;
      if (column == 0) {
        sum = static_cast<double>(tables.mode_transforms[row * modes]);
      } else {
        for (size_t i = 0; i < holds.size(); ++i)
          sum += holds[i].row.response[row] *
                 root(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column - 1));
      }
      bunch[row / kBlockLanes * dimension_ * kBlockLanes + row % kBlockLanes] =
          static_cast<float>(sum);
    }
  }
}

void PinSet::BuildSingles(std::span<const Hold> holds) {
  for (size_t s = 0; s < num_shapes_; ++s) {
    double* modes = single_modes_.data() + s * holds.size() * single_stride_;
    for (size_t i = 0; i < holds.size(); ++i) {
      std::copy_n(holds[i].row.single + s * single_stride_, single_stride_,
                  modes + i * single_stride_);
      rows_[i].modes = modes + i * single_stride_;
    }
    single_system_.Compute({rows_.data(), holds.size()});
    std::copy_n(single_system_.response().data(), holds.size() * holds.size(),
                single_response_.data() + s * holds.size() * holds.size());
  }
}

}  // namespace limber
