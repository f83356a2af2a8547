#include "rig/local_group_factors.h"

#include "core/vector.h"

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>

namespace limber {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// c_g for the n_g of one row of group_handles.
Eigen::Index LocalSize(const float* flags, Eigen::Index num_handles, Eigen::Index k) {
  const auto moved = std::count(flags, flags + num_handles, 1.0f);
  return static_cast<Eigen::Index>(moved) * (k + 1) + k;
}

Eigen::MatrixXd UnpackUpper(const float* packed, Eigen::Index size) {
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = row; column < size; ++column)
      upper(row, column) = static_cast<double>(*packed++);
  }
  return upper;
}

// [T; -R^T] = P [z; -R^T] but for the translation of everything, which moves no edge: the rows of
// Phi_1 of the handles that `flags` names, and an identity. c_g x (r1 + k).
Eigen::MatrixXd ModesToLocal(const RigTables& t, Eigen::Index shape, const float* flags,
                             Eigen::Index local_size) {
  const Eigen::Index k = t.dimension, h = t.num_handles(), r1 = t.num_single_modes;
  const Eigen::Map<const RowMajor> transforms(
      t.single_mode_transforms.data() + shape * h * (k + 1) * (1 + r1), h * (k + 1), 1 + r1);
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(local_size, r1 + k);
  Eigen::Index row = 0;
  for (Eigen::Index handle = 0; handle < h; ++handle) {
    if (flags[handle] != 1) continue;
    map.block(row, 0, k + 1, r1) = transforms.block(handle * (k + 1), 1, k + 1, r1).cast<double>();
    row += k + 1;
  }
  map.bottomRightCorner(k, k).setIdentity();
  return map;
}

// The triangular factor of `root` and its edges, appended as the tables hold them. By orthogonal
// transformations, so that no energy is a difference of large numbers.
void AppendGroup(const Eigen::MatrixXd& root, Eigen::Index r1, Eigen::Index k, RigTables* tables) {
  const Eigen::MatrixXd edges = root.rightCols(k).transpose() * root.leftCols(r1);
  for (Eigen::Index axis = 0; axis < k; ++axis) {
    for (Eigen::Index mode = 0; mode < r1; ++mode)
      tables->single_edges.push_back(static_cast<float>(edges(axis, mode)));
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(root);
  for (Eigen::Index row = 0; row < r1 + k; ++row) {
    for (Eigen::Index column = row; column < r1 + k; ++column) {
      const double entry = row < root.rows() ? qr.matrixQR()(row, column) : 0;
      tables->single_group_factors.push_back(static_cast<float>(entry));
    }
  }
}

Status CheckSize(const char* name, size_t found, int64_t expected) {
  if (static_cast<int64_t>(found) == expected) return {};
  return Error(StatusCode::kMalformed, "%s: it has %zu elements; expected %lld", name, found,
               static_cast<long long>(expected));
}

Status Check(const LocalGroupFactors& local, const RigTables& t) {
  const Result<int64_t> factors = NumLocalFactors(t, local.group_handles);
  if (!factors.ok()) return factors.status();
  LIMBER_RETURN_IF_ERROR(CheckSize("groupFactors", local.factors.size(), *factors));
  const int64_t transforms = int64_t{t.num_transform_rows()} * (1 + t.num_single_modes);
  return CheckSize("singleModeTransforms", t.single_mode_transforms.size(), transforms);
}

}  // namespace

Result<int64_t> NumLocalFactors(const RigTables& tables, const Vector<float>& group_handles) {
  const Eigen::Index h = tables.num_handles();
  LIMBER_RETURN_IF_ERROR(
      CheckSize("groupHandles", group_handles.size(), int64_t{tables.num_groups} * h));
  const auto bad = std::find_if(group_handles.begin(), group_handles.end(),
                                [](float flag) { return flag != 0 && flag != 1; });
  if (bad != group_handles.end()) {
    return Error(StatusCode::kMalformed, "groupHandles: element %td is %g; expected 0 or 1",
                 bad - group_handles.begin(), static_cast<double>(*bad));
  }
  int64_t count = 0;
  for (Eigen::Index g = 0; g < tables.num_groups; ++g) {
    const int64_t size = LocalSize(group_handles.data() + g * h, h, tables.dimension);
    count += size * (size + 1) / 2;
  }
  return count * tables.num_shapes();
}

Status ExpandLocalGroupFactors(const LocalGroupFactors& local, RigTables* tables) {
  LIMBER_RETURN_IF_ERROR(Check(local, *tables));
  const Eigen::Index h = tables->num_handles(), k = tables->dimension;
  const Eigen::Index r1 = tables->num_single_modes;
  const auto blocks =
      static_cast<size_t>(tables->num_shapes()) * static_cast<size_t>(tables->num_groups);
  tables->single_edges.clear();
  tables->single_edges.reserve(blocks * static_cast<size_t>(k * r1));
  tables->single_group_factors.clear();
  tables->single_group_factors.reserve(blocks * static_cast<size_t>((r1 + k) * (r1 + k + 1) / 2));
  const float* packed = local.factors.data();
  for (Eigen::Index s = 0; s < tables->num_shapes(); ++s) {
    for (Eigen::Index g = 0; g < tables->num_groups; ++g) {
      const float* flags = local.group_handles.data() + g * h;
      const Eigen::Index size = LocalSize(flags, h, k);
      AppendGroup(UnpackUpper(packed, size) * ModesToLocal(*tables, s, flags, size), r1, k, tables);
      packed += size * (size + 1) / 2;
    }
  }
  return {};
}

}  // namespace limber
