#include "solve/pose_model.h"

namespace limber {
namespace {

using RowMajorF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using TableMap = Eigen::Map<const RowMajorF>;

// The gram matrix is the largest thing a model holds; 12 thousand columns are 1.2 GB.
constexpr int kMaxGramColumns = 12000;

TableMap MapTable(const std::vector<float>& table, Eigen::Index rows, Eigen::Index columns) {
  return TableMap(table.data(), rows, columns);
}

// Rows of the pinned handles of a [H][1 + modes] table, without the translation's column.
Eigen::MatrixXd PinnedRows(const TableMap& handle_modes, const std::vector<int>& pinned) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(pinned.size()), handle_modes.cols() - 1);
  for (size_t c = 0; c < pinned.size(); ++c) {
    rows.row(static_cast<Eigen::Index>(c)) =
        handle_modes.row(pinned[c]).tail(rows.cols()).cast<double>();
  }
  return rows;
}

// K_z folded over its axes against the constraints: G*S blocks, tr(V_i^T W V_j) without rotations.
Eigen::MatrixXd ConstraintGram(const PoseModel& model, bool folded) {
  const Eigen::MatrixXd answered = model.constraint_load * model.constraints.response;
  if (!folded) return answered * model.constraint_load.transpose();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(model.num_blocks, model.num_blocks);
  using Strided =
      Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
  const Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic> stride(model.constraint_load.rows(), model.k);
  for (int axis = 0; axis < model.k; ++axis) {
    const Strided left(answered.data() + axis, model.num_blocks, answered.cols(), stride);
    const Strided right(model.constraint_load.data() + axis, model.num_blocks,
                        model.constraint_load.cols(), stride);
    gram += left * right.transpose();
  }
  return gram;
}

void BuildGram(const RigTables& tables, PoseModel* model) {
  const Eigen::Index columns =
      model->num_blocks * (tables.has_rotations ? static_cast<Eigen::Index>(model->k) : 1);
  const Eigen::MatrixXd factor =
      MapTable(tables.residual_factor, tables.residual_rank, columns).cast<double>();
  model->gram = Eigen::MatrixXd::Zero(columns, columns);
  model->gram.selfadjointView<Eigen::Lower>().rankUpdate(factor.transpose());
  model->gram.triangularView<Eigen::StrictlyUpper>() = model->gram.transpose();
  model->gram += ConstraintGram(*model, !tables.has_rotations);
}

// tr H summed over shapes, from H = F^T F + K_z K_z^T.
double SumOfEdgeEnergies(const RigTables& tables) {
  double sum = 0;
  for (float value : tables.residual_factor)
    sum += static_cast<double>(value) * value;
  for (float value : tables.mode_edges)
    sum += static_cast<double>(value) * value;
  return sum;
}

}  // namespace

Result<std::shared_ptr<const PoseModel>> PoseModel::Create(std::shared_ptr<const Rig> rig) {
  if (rig == nullptr) return Error(StatusCode::kInvalidArgument, "no rig was given");
  const RigTables& tables = rig->tables();
  std::shared_ptr<PoseModel> model(new PoseModel());
  model->k = tables.dimension;
  model->num_groups = tables.num_groups;
  model->num_shapes = tables.num_shapes();
  model->num_modes = tables.num_modes;
  model->num_single_modes = tables.num_single_modes;
  model->num_blocks = model->num_groups * model->num_shapes;
  const int columns = model->num_blocks * (tables.has_rotations ? model->k : 1);
  if (columns > kMaxGramColumns) {
    return Error(StatusCode::kLimitExceeded,
                 "%s: %d groups, %d shapes and %d axes make %d columns; expected at most %d: use "
                 "fewer shapes, fewer handles, or bake without rotations",
                 rig->name().c_str(), model->num_groups, model->num_shapes,
                 tables.has_rotations ? model->k : 1, columns, kMaxGramColumns);
  }
  for (int h = 0; h < tables.num_handles(); ++h) {
    const bool pinned = tables.handles[static_cast<size_t>(h)].pinned;
    model->pin_of_handle.push_back(pinned ? static_cast<int>(model->pinned.size()) : -1);
    if (pinned) model->pinned.push_back(h);
  }
  if (model->pinned.empty()) {
    return Error(StatusCode::kNoHandles, "%s: no handle is pinned; pin at least one",
                 rig->name().c_str());
  }
  const Eigen::Index handles = tables.num_handles(), r = tables.num_modes;
  const Eigen::Index r1 = tables.num_single_modes;
  model->constraints = ConstraintSystem::Create(
      PinnedRows(MapTable(tables.handle_modes, handles, 1 + r), model->pinned));
  for (int s = 0; s < model->num_shapes; ++s) {
    const TableMap rows(tables.single_handle_modes.data() + s * handles * (1 + r1), handles,
                        1 + r1);
    model->single_constraints.push_back(ConstraintSystem::Create(PinnedRows(rows, model->pinned)));
  }
  model->mode_edges = MapTable(tables.mode_edges, Eigen::Index{model->num_blocks} * model->k, r);
  model->mode_transforms = MapTable(tables.mode_transforms, tables.num_transform_rows(), 1 + r);
  model->constraint_load = model->mode_edges.cast<double>() * model->constraints.modes.transpose();
  BuildGram(tables, model.get());
  model->energy_scale = 0.5 * SumOfEdgeEnergies(tables) / model->num_shapes;
  model->rig = std::move(rig);
  return std::shared_ptr<const PoseModel>(std::move(model));
}

}  // namespace limber
