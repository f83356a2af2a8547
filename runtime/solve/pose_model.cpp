#include "solve/pose_model.h"

#include "core/out_of_memory.h"
#include "core/vector.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

using RowMajorF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using TableMap = Eigen::Map<const RowMajorF>;

TableMap MapTable(const Vector<float>& table, Eigen::Index rows, Eigen::Index columns) {
  return TableMap(table.data(), rows, columns);
}

// The K columns of one block, rows (i, a), as planes; block i goes to place `offset` + i.
template <int K, typename Number>
void LayOutStrip(const Eigen::Ref<const Eigen::MatrixXd>& columns, size_t offset, Number* strip) {
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    const size_t i = offset + static_cast<size_t>(row / K), a = static_cast<size_t>(row % K);
    for (size_t b = 0; b < K; ++b)
      strip[PlaneIndex<K>(i, b, a)] =
          static_cast<Number>(columns(row, static_cast<Eigen::Index>(b)));
  }
}

// Group by group H = F^T F + K_z K_z^T.
template <int K>
void LayOutNear(const RigTables& tables, const Eigen::MatrixXd& gram, PoseModel* model) {
  const TableMap edges = MapTable(tables.mode_edges, gram.rows(), model->num_modes);
  size_t widest = 0;
  for (int j = 0; j < model->num_blocks; j += model->num_shapes)
    widest = std::max(widest, model->near_chunks(j));
  model->near_stride = widest * kBlockLanes * K * K;
  model->near.assign(model->near_stride * static_cast<size_t>(model->num_blocks), 0.0);
  const Eigen::Index rows = Eigen::Index{model->num_shapes} * K;
  for (int j = 0; j < model->num_blocks; j += model->num_shapes) {
    const Eigen::Index first = Eigen::Index{j} * K;
    const Eigen::MatrixXd part = edges.middleRows(first, rows).cast<double>();
    const Eigen::MatrixXd near = part * part.transpose() + gram.block(first, first, rows, rows);
    const size_t offset = static_cast<size_t>(j) - model->near_first(j) * kBlockLanes;
    for (int s = 0; s < model->num_shapes; ++s) {
      LayOutStrip<K>(near.middleCols<K>(Eigen::Index{s} * K), offset,
                     model->near.data() + static_cast<size_t>(j + s) * model->near_stride);
    }
  }
}

// F^T F.
template <int K>
void LayOutGram(const RigTables& tables, PoseModel* model) {
  const Eigen::Index columns = Eigen::Index{model->num_blocks} * K;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns, columns);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(
      MapTable(tables.residual_factor, tables.residual_rank, columns).cast<double>().transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const auto blocks = static_cast<size_t>(model->num_blocks);
  model->gram_stride = blocks * K * K;
  model->gram.assign(model->gram_stride * blocks, 0.0);
  model->gram_planes.assign(model->planes_stride() * blocks, 0.0f);
  model->gram_norms.assign(model->chunks() * kBlockLanes, 0.0);
  for (size_t j = 0; j < blocks; ++j) {
    const auto strip = gram.middleCols<K>(static_cast<Eigen::Index>(j) * K);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, K, Eigen::RowMajor>>(
        model->gram.data() + j * model->gram_stride, columns, K) = strip;
    LayOutStrip<K>(strip, 0, model->gram_planes.data() + j * model->planes_stride());
    model->gram_norms[j] =
        std::sqrt(strip.template middleRows<K>(static_cast<Eigen::Index>(j) * K).trace());
  }
  LayOutNear<K>(tables, gram, model);
}

// Without rotations the Gram matrix of whole shapes is enough: a number a pair of blocks.
void LayOutFoldedGram(const RigTables& tables, PoseModel* model) {
  const Eigen::Index blocks = model->num_blocks;
  const Eigen::MatrixXd factor =
      MapTable(tables.residual_factor, tables.residual_rank, blocks).cast<double>();
  model->gram_stride = PaddedSize(static_cast<size_t>(blocks));
  model->gram.assign(model->gram_stride * static_cast<size_t>(blocks), 0.0);
  model->gram_norms.assign(model->gram_stride, 0.0);
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
      model->gram.data(), blocks, blocks,
      Eigen::OuterStride<>(static_cast<Eigen::Index>(model->gram_stride)))
      .noalias() = factor.transpose() * factor;
}

void LayOutTransforms(const RigTables& tables, PoseModel* model) {
  const Eigen::Index n = tables.num_transform_rows(), r = tables.num_modes, k = model->k;
  const TableMap transforms = MapTable(tables.mode_transforms, n, 1 + r);
  const TableMap edges = MapTable(tables.mode_edges, Eigen::Index{model->num_blocks} * k, r);
  const size_t chunks = model->row_chunks(), planes = static_cast<size_t>(k) * kBlockLanes;
  model->transform_response.assign(chunks * planes * static_cast<size_t>(model->num_blocks), 0.0f);
  const Eigen::MatrixXd modes = transforms.rightCols(r).cast<double>();
  for (Eigen::Index row = 0; row < edges.rows(); ++row) {
    const Eigen::VectorXd answer = modes * edges.row(row).transpose().cast<double>();
    float* out = model->transform_response.data() + static_cast<size_t>(row / k) * chunks * planes +
                 static_cast<size_t>(row % k) * kBlockLanes;
    for (Eigen::Index i = 0; i < n; ++i) {
      out[static_cast<size_t>(i) / kBlockLanes * planes + static_cast<size_t>(i) % kBlockLanes] =
          static_cast<float>(answer[i]);
    }
  }
}

// Group g's edges of shape s, an axis and a mode after the other, both ways round.
void LayOutSingleEdges(const RigTables& tables, PoseModel* model) {
  const auto shapes = static_cast<size_t>(model->num_shapes);
  const auto groups = static_cast<size_t>(model->num_groups);
  const auto k = static_cast<size_t>(model->k), r1 = static_cast<size_t>(model->num_single_modes);
  const size_t stride = model->single_stride();
  model->single_edges_by_mode.assign(shapes * groups * k * stride, 0.0f);
  const size_t shape_size = model->group_chunks() * r1 * k * kBlockLanes;
  model->single_edges_by_group.assign(shapes * shape_size, 0.0f);
  const float* edges = tables.single_edges.data();
  for (size_t row = 0; row < shapes * groups * k; ++row, edges += r1) {
    const size_t s = row / (groups * k), g = row / k % groups, a = row % k;
    float* by_mode = model->single_edges_by_mode.data() + row * stride;
    float* by_group = model->single_edges_by_group.data() + s * shape_size +
                      (g / kBlockLanes * r1 * k + a) * kBlockLanes + g % kBlockLanes;
    for (size_t m = 0; m < r1; ++m)
      by_mode[m] = by_group[m * k * kBlockLanes] = edges[m];
  }
}

// One U, packed by rows in the file, eight rows at a time as the kernels want it. Returns the norm
// of its last k columns, |E_gs|.
double LayOutSingleFactor(const float* entry, size_t size, size_t k, float* head, float* tail) {
  double squares = 0;
  for (size_t row = 0; row < size; ++row) {
    const size_t first = row / kBlockLanes * kBlockLanes;
    float* rows = first == 0 ? head : tail;
    for (size_t column = row; column < size; ++column, ++entry) {
      rows[(column - first) * kBlockLanes + row - first] = *entry;
      if (column + k >= size) squares += static_cast<double>(*entry) * static_cast<double>(*entry);
    }
    if (first != 0 && row % kBlockLanes == kBlockLanes - 1) tail += (size - first) * kBlockLanes;
  }
  return std::sqrt(squares);
}

void LayOutSingleFactors(const RigTables& tables, PoseModel* model) {
  const auto shapes = static_cast<size_t>(model->num_shapes);
  const auto groups = static_cast<size_t>(model->num_groups);
  const size_t size = model->single_size();
  for (size_t first = kBlockLanes; first < size; first += kBlockLanes)
    model->single_tail_size += (size - first) * kBlockLanes;
  model->single_heads.assign(shapes * groups * size * kBlockLanes, 0.0f);
  model->single_tails.assign(shapes * groups * model->single_tail_size, 0.0f);
  model->single_edge_norms.assign(shapes * groups, 0.0);
  for (size_t i = 0; i < shapes * groups; ++i) {
    const size_t block = i % groups * shapes + i / groups;
    model->single_edge_norms[block] = LayOutSingleFactor(
        tables.single_group_factors.data() + i * (size * (size + 1) / 2), size,
        static_cast<size_t>(model->k), model->single_heads.data() + block * size * kBlockLanes,
        model->single_tails.data() + block * model->single_tail_size);
  }
}

// tr H summed over shapes, from H = F^T F + K_z K_z^T.
double SumOfEdgeEnergies(const RigTables& tables) {
  double sum = 0;
  for (float value : tables.residual_factor)
    sum += static_cast<double>(value) * static_cast<double>(value);
  for (float value : tables.mode_edges)
    sum += static_cast<double>(value) * static_cast<double>(value);
  return sum;
}

void HoldHandles(PoseModel* model) {
  const Rig& rig = *model->rig;
  const auto rows = MakeShared<HeldRowTable>(rig, rig.tables().handles.size());
  for (int h = 0; h < rig.num_handles(); ++h)
    rows->FillHandle(rig, static_cast<size_t>(h), h);
  Vector<Hold> holds;
  for (const int h : model->pinned_handles)
    holds.push_back({rows->row(static_cast<size_t>(h)), 0});
  const auto pins = MakeShared<PinSet>(rig, holds.size());
  pins->Build(rig, holds);
  model->handle_rows = rows;
  model->pins = pins;
}

void LayOutTables(PoseModel* model) {
  const RigTables& tables = model->rig->tables();
  if (model->is_folded) {
    LayOutFoldedGram(tables, model);
  } else if (model->k == 2) {
    LayOutGram<2>(tables, model);
  } else {
    LayOutGram<3>(tables, model);
  }
  LayOutTransforms(tables, model);
  if (model->num_shapes == 1) return;  // nothing to be near to
  LayOutSingleEdges(tables, model);
  LayOutSingleFactors(tables, model);
}

}  // namespace

size_t PoseModel::bytes() const {
  return BytesOf(gram, gram_planes, gram_norms, near, transform_response, single_edges_by_mode,
                 single_edges_by_group, single_heads, single_tails, single_edge_norms,
                 pin_of_handle, pinned_handles) +
         pins->bytes() + handle_rows->bytes();
}

Result<std::shared_ptr<const PoseModel>> PoseModel::Build(std::shared_ptr<const Rig> rig) {
  const RigTables& tables = rig->tables();
  const int blocks = tables.num_groups * tables.num_shapes();
  const int columns = blocks * (tables.has_rotations ? tables.dimension : 1);
  if (columns > kMostRigColumns) {
    return Error(StatusCode::kLimitExceeded,
                 "%s: %d groups, %d shapes and %d axes make %d columns; expected at most %d: use "
                 "fewer shapes, fewer handles, or bake without rotations",
                 rig->name().c_str(), tables.num_groups, tables.num_shapes(),
                 tables.has_rotations ? tables.dimension : 1, columns,
                 static_cast<int>(kMostRigColumns));
  }
  std::shared_ptr<PoseModel> model = Share(new PoseModel());
  model->k = tables.dimension;
  model->num_groups = tables.num_groups;
  model->num_shapes = tables.num_shapes();
  model->num_modes = tables.num_modes;
  model->num_single_modes = tables.num_single_modes;
  model->num_blocks = blocks;
  model->is_folded = !tables.has_rotations;
  for (int h = 0; h < tables.num_handles(); ++h) {
    const bool pinned = tables.handles[static_cast<size_t>(h)].pinned;
    model->pin_of_handle.push_back(pinned ? static_cast<int>(model->pinned_handles.size()) : -1);
    if (pinned) model->pinned_handles.push_back(h);
  }
  if (model->pinned_handles.empty()) {
    return Error(StatusCode::kNoHandles, "%s: no handle is pinned; pin at least one",
                 rig->name().c_str());
  }
  model->energy_scale = 0.5 * SumOfEdgeEnergies(tables) / model->num_shapes;
  model->rig = std::move(rig);
  HoldHandles(model.get());
  LayOutTables(model.get());
  return std::shared_ptr<const PoseModel>(std::move(model));
}

Result<std::shared_ptr<const PoseModel>> PoseModel::Create(std::shared_ptr<const Rig> rig) {
  if (rig == nullptr) return Error(StatusCode::kInvalidArgument, "no rig was given");
  return CatchOutOfMemory(rig->name(), [&] { return Build(rig); });
}

}  // namespace limber
