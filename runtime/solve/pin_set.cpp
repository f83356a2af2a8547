#include "solve/pin_set.h"

#include "solve/kernels/solve_kernels.h"

namespace limber {
namespace {

using RowMajorF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using TableMap = Eigen::Map<const RowMajorF>;

// Rows of the held handles of a [H][1 + modes] table, without the translation's column.
Eigen::MatrixXd HeldRows(const float* handle_modes, Eigen::Index num_handles, Eigen::Index modes,
                         const std::vector<int>& handles) {
  const TableMap table(handle_modes, num_handles, 1 + modes);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(handles.size()), modes);
  for (size_t c = 0; c < handles.size(); ++c)
    rows.row(static_cast<Eigen::Index>(c)) = table.row(handles[c]).tail(modes).cast<double>();
  return rows;
}

// K_z C^T: rows (block, axis), a column a pin.
void LayOutLoads(const RigTables& tables, const Eigen::MatrixXd& loads, PinSet* pins) {
  const int k = tables.dimension;
  const Eigen::MatrixXd scaled = loads * pins->system.root;
  const Eigen::VectorXd shifts = loads * pins->system.translation.transpose();
  const size_t blocks = static_cast<size_t>(scaled.rows()) / static_cast<size_t>(k);
  const size_t padded = PaddedSize(blocks), rank = pins->rank();
  pins->loads.assign(padded * static_cast<size_t>(k) * rank, 0.0);
  pins->shifts.assign(padded * static_cast<size_t>(k), 0.0);
  for (size_t block = 0; block < blocks; ++block) {
    for (size_t axis = 0; axis < static_cast<size_t>(k); ++axis) {
      const auto row = static_cast<Eigen::Index>(block * static_cast<size_t>(k) + axis);
      pins->shifts[axis * padded + block] = shifts[row];
      for (size_t p = 0; p < rank; ++p) {
        const size_t chunk = block / kBlockLanes;
        pins->loads[((chunk * static_cast<size_t>(k) + axis) * rank + p) * kBlockLanes +
                    block % kBlockLanes] = scaled(row, static_cast<Eigen::Index>(p));
      }
    }
  }
}

void LayOutTransforms(const RigTables& tables, PinSet* pins) {
  const Eigen::Index n = tables.num_transform_rows(), r = tables.num_modes;
  const TableMap modes(tables.mode_transforms.data(), n, 1 + r);
  Eigen::MatrixXd columns(n, 1 + pins->system.root.cols());
  columns.col(0) = modes.col(0).cast<double>();
  columns.rightCols(pins->system.root.cols()) =
      modes.rightCols(r).cast<double>() * (pins->system.modes.transpose() * pins->system.root);
  const auto k = static_cast<size_t>(tables.dimension);
  const size_t padded = PaddedSize(static_cast<size_t>(n));
  const size_t bunches = (static_cast<size_t>(columns.cols()) + k - 1) / k;
  pins->transforms.assign(bunches * k * padded, 0.0f);
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    const size_t bunch = static_cast<size_t>(column) / k, place = static_cast<size_t>(column) % k;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto row = static_cast<size_t>(i);
      pins->transforms[bunch * k * padded + (row / kBlockLanes * k + place) * kBlockLanes +
                       row % kBlockLanes] = static_cast<float>(columns(i, column));
    }
  }
}

}  // namespace

std::shared_ptr<const PinSet> PinSet::Create(const RigTables& tables, std::vector<int> handles) {
  auto pins = std::make_shared<PinSet>();
  const Eigen::Index num_handles = tables.num_handles(), r = tables.num_modes;
  pins->system =
      ConstraintSystem::Create(HeldRows(tables.handle_modes.data(), num_handles, r, handles));
  const Eigen::Index rows =
      static_cast<Eigen::Index>(tables.num_groups) * tables.num_shapes() * tables.dimension;
  const TableMap edges(tables.mode_edges.data(), rows, r);
  LayOutLoads(tables, edges.cast<double>() * pins->system.modes.transpose(), pins.get());
  LayOutTransforms(tables, pins.get());
  const Eigen::Index r1 = tables.num_single_modes;
  const auto stride =
      static_cast<Eigen::Index>(PaddedSize(static_cast<size_t>(r1 + tables.dimension)));
  for (Eigen::Index s = 0; s < tables.num_shapes(); ++s) {
    const ConstraintSystem single = ConstraintSystem::Create(HeldRows(
        tables.single_handle_modes.data() + s * num_handles * (1 + r1), num_handles, r1, handles));
    for (const auto& row : single.modes.rowwise()) {
      pins->single_modes.insert(pins->single_modes.end(), row.begin(), row.end());
      pins->single_modes.insert(pins->single_modes.end(), static_cast<size_t>(stride - r1), 0.0);
    }
    pins->single_response.push_back(single.response);
  }
  pins->handles = std::move(handles);
  return pins;
}

}  // namespace limber
