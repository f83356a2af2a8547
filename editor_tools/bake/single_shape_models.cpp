#include "bake/single_shape_models.h"

#include "bake/mode_basis.h"
#include "core/vector.h"
#include "threads/parallel_for.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>

namespace limber::bake {
namespace {

// Upper triangular U with U^T U = gram (positive semi-definite, m x m). By way of eigenvalues, so
// that a rank deficient group (one straight row of edges, say) is as good as any other.
Eigen::MatrixXd UpperFactor(const Eigen::MatrixXd& gram) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const Eigen::MatrixXd root =
      eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(root);
  return qr.matrixQR().triangularView<Eigen::Upper>();
}

void AppendPacked(const Eigen::MatrixXd& upper, Vector<float>* packed) {
  for (Eigen::Index row = 0; row < upper.rows(); ++row) {
    for (Eigen::Index column = row; column < upper.cols(); ++column) {
      packed->push_back(static_cast<float>(upper(row, column)));
    }
  }
}

// What one shape adds to the tables, of the same names there.
struct SingleShapeTables {
  Vector<float> handle_modes, mode_transforms, local_factors;
  Status status;
};

// Which handles move edges of which groups: [G][H] of 0 and 1.
Vector<float> GroupHandles(const Vector<GroupTensors>& groups, const Eigen::MatrixXd& weights) {
  Vector<float> flags;
  for (const GroupTensors& group : groups) {
    const Eigen::MatrixXd local = group.Rows(weights);
    for (Eigen::Index h = 0; h < weights.cols(); ++h)
      flags.push_back(local.col(h).cwiseAbs().maxCoeff() > 0 ? 1.0f : 0.0f);
  }
  return flags;
}

// The columns of `weights` that `flags` names.
Eigen::MatrixXd LocalWeights(const Eigen::MatrixXd& weights, const float* flags) {
  Eigen::MatrixXd local(weights.rows(), std::count(flags, flags + weights.cols(), 1.0f));
  Eigen::Index column = 0;
  for (Eigen::Index h = 0; h < weights.cols(); ++h) {
    if (flags[h] == 1) local.col(column++) = weights.col(h);
  }
  return local;
}

// U of group g in the model of shape s, in the transforms of the handles that `flags` names.
Eigen::MatrixXd LocalFactor(const SingleShapeInput& input, const GroupTensors& group, size_t s,
                            const float* flags) {
  const Eigen::MatrixXd& shape = (*input.shapes)[s];
  const Eigen::Index k = shape.cols(), first = static_cast<Eigen::Index>(s) * k;
  const Eigen::MatrixXd points = group.Rows(shape);
  const Eigen::MatrixXd skinning =
      SkinningMatrix(LocalWeights(group.Rows(*input.weights), flags), &points, 1);
  const Eigen::Index n = skinning.cols();
  Eigen::MatrixXd gram(n + k, n + k);
  gram.topLeftCorner(n, n) = skinning.transpose() * (group.laplacian * skinning);
  gram.bottomLeftCorner(k, n) = group.edge_load.middleCols(first, k).transpose() * skinning;
  gram.topRightCorner(n, k) = gram.bottomLeftCorner(k, n).transpose();
  gram.bottomRightCorner(k, k) = group.shape_gram.block(first, first, k, k);
  return UpperFactor(gram);
}

// The transforms of shape s's modes, phi_0 first: H*(k+1) rows of 1 + r1.
void AppendTransforms(const Eigen::MatrixXd& transforms, Eigen::Index k, Eigen::Index r1,
                      Vector<float>* table) {
  for (Eigen::Index row = 0; row < transforms.rows(); ++row) {
    const bool is_translation = row % (k + 1) == k;
    table->push_back(is_translation ? 1.0f : 0.0f);
    for (Eigen::Index mode = 0; mode < r1; ++mode) {
      const double entry = mode < transforms.cols() ? transforms(row, mode) : 0;
      table->push_back(static_cast<float>(entry));
    }
  }
}

// The modes may be turned among each other at will. Turned by this, r x r orthogonal, most of their
// transforms are zero and take no room in the file.
Eigen::MatrixXd TurnToTriangle(const Eigen::MatrixXd& transforms) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(transforms.transpose());
  return qr.householderQ();
}

// Of shape s, with r1 modes, of which the last stay zero where the shape has fewer.
SingleShapeTables BuildShape(const SingleShapeInput& input, size_t s, Eigen::Index r1,
                             const Vector<float>& group_handles) {
  SingleShapeTables tables;
  const Eigen::Index k = input.shapes->front().cols();
  Result<ModeBasis> basis =
      ComputeModeBasis(SkinningMatrix(*input.weights, &(*input.shapes)[s], 1), *input.laplacian, 1);
  tables.status = basis.status();
  if (!basis.ok()) return tables;
  const Eigen::MatrixXd turn = TurnToTriangle(basis->transforms);
  for (int vertex : *input.handle_vertices) {
    const Eigen::RowVectorXd modes = basis->shapes.row(vertex) * turn;
    tables.handle_modes.push_back(1);
    for (Eigen::Index mode = 0; mode < r1; ++mode) {
      tables.handle_modes.push_back(mode < modes.size() ? static_cast<float>(modes[mode]) : 0);
    }
  }
  AppendTransforms(basis->transforms * turn, k, r1, &tables.mode_transforms);
  const float* flags = group_handles.data();
  for (const GroupTensors& group : *input.groups) {
    AppendPacked(LocalFactor(input, group, s, flags), &tables.local_factors);
    flags += input.weights->cols();
  }
  return tables;
}

void Append(const Vector<float>& numbers, Vector<float>* table) {
  table->insert(table->end(), numbers.begin(), numbers.end());
}

}  // namespace

Status BuildSingleShapeModels(const SingleShapeInput& input, RigTables* tables,
                              LocalGroupFactors* local) {
  // All shapes get the same count, the largest that one could need; a flat shape's modes are fewer
  // and the rest stay zero, which adds nothing to any sum.
  const Eigen::Index r1 = input.weights->cols() * (input.shapes->front().cols() + 1) - 1;
  local->group_handles = GroupHandles(*input.groups, *input.weights);
  Vector<SingleShapeTables> shapes(input.shapes->size());
  threads::ParallelFor(static_cast<int>(shapes.size()), input.num_threads, [&](int s) {
    const auto shape = static_cast<size_t>(s);
    shapes[shape] = BuildShape(input, shape, r1, local->group_handles);
  });
  tables->num_single_modes = static_cast<int32_t>(r1);
  tables->single_handle_modes.clear();
  tables->single_mode_transforms.clear();
  local->factors.clear();
  for (const SingleShapeTables& shape : shapes) {
    LIMBER_RETURN_IF_ERROR(shape.status);
    Append(shape.handle_modes, &tables->single_handle_modes);
    Append(shape.mode_transforms, &tables->single_mode_transforms);
    Append(shape.local_factors, &local->factors);
  }
  return ExpandLocalGroupFactors(*local, tables);
}

}  // namespace limber::bake
