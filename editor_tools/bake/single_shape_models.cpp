#include "bake/single_shape_models.h"

#include "bake/mode_basis.h"
#include "threads/parallel_for.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

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

void AppendPacked(const Eigen::MatrixXd& upper, std::vector<float>* packed) {
  for (Eigen::Index row = 0; row < upper.rows(); ++row) {
    for (Eigen::Index column = row; column < upper.cols(); ++column) {
      packed->push_back(static_cast<float>(upper(row, column)));
    }
  }
}

// What one shape adds to the tables, of the same names there.
struct SingleShapeTables {
  std::vector<float> handle_modes, edges, group_factors, mode_transforms;
  Status status;
};

// Appends what group g contributes to the model of shape s with the mode fields `modes` (V x r1).
void AppendGroup(const GroupTensors& group, const Eigen::MatrixXd& modes, Eigen::Index s,
                 Eigen::Index k, SingleShapeTables* tables) {
  const Eigen::MatrixXd local = group.Rows(modes);
  const Eigen::Index r1 = modes.cols();
  const Eigen::MatrixXd edges = group.edge_load.middleCols(s * k, k).transpose() * local;  // k x r1
  Eigen::MatrixXd gram(r1 + k, r1 + k);
  gram.topLeftCorner(r1, r1) = local.transpose() * (group.laplacian * local);
  gram.bottomLeftCorner(k, r1) = edges;
  gram.topRightCorner(r1, k) = edges.transpose();
  gram.bottomRightCorner(k, k) = group.shape_gram.block(s * k, s * k, k, k);
  for (Eigen::Index axis = 0; axis < k; ++axis) {
    for (Eigen::Index mode = 0; mode < r1; ++mode) {
      tables->edges.push_back(static_cast<float>(edges(axis, mode)));
    }
  }
  AppendPacked(UpperFactor(gram), &tables->group_factors);
}

// The transforms of shape s's modes, phi_0 first: H*(k+1) rows of 1 + r1.
void AppendTransforms(const Eigen::MatrixXd& transforms, Eigen::Index k, Eigen::Index r1,
                      std::vector<float>* table) {
  for (Eigen::Index row = 0; row < transforms.rows(); ++row) {
    const bool is_translation = row % (k + 1) == k;
    table->push_back(is_translation ? 1.0f : 0.0f);
    for (Eigen::Index mode = 0; mode < r1; ++mode) {
      const double entry = mode < transforms.cols() ? transforms(row, mode) : 0;
      table->push_back(static_cast<float>(entry));
    }
  }
}

// Of shape s, with r1 modes, of which the last stay zero where the shape has fewer.
SingleShapeTables BuildShape(const SingleShapeInput& input, size_t s, Eigen::Index r1) {
  SingleShapeTables tables;
  const Eigen::Index k = input.shapes->front().cols();
  Result<ModeBasis> basis =
      ComputeModeBasis(SkinningMatrix(*input.weights, &(*input.shapes)[s], 1), *input.laplacian, 1);
  tables.status = basis.status();
  if (!basis.ok()) return tables;
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(input.weights->rows(), r1);
  modes.leftCols(basis->shapes.cols()) = basis->shapes;
  for (int vertex : *input.handle_vertices) {
    tables.handle_modes.push_back(1);
    for (Eigen::Index mode = 0; mode < r1; ++mode) {
      tables.handle_modes.push_back(static_cast<float>(modes(vertex, mode)));
    }
  }
  AppendTransforms(basis->transforms, k, r1, &tables.mode_transforms);
  for (const GroupTensors& group : *input.groups)
    AppendGroup(group, modes, static_cast<Eigen::Index>(s), k, &tables);
  return tables;
}

void Append(const std::vector<float>& numbers, std::vector<float>* table) {
  table->insert(table->end(), numbers.begin(), numbers.end());
}

}  // namespace

Status BuildSingleShapeModels(const SingleShapeInput& input, RigTables* tables) {
  // All shapes get the same count, the largest that one could need; a flat shape's modes are fewer
  // and the rest stay zero, which adds nothing to any sum.
  const Eigen::Index r1 = input.weights->cols() * (input.shapes->front().cols() + 1) - 1;
  std::vector<SingleShapeTables> shapes(input.shapes->size());
  threads::ParallelFor(static_cast<int>(shapes.size()), input.num_threads, [&](int s) {
    const auto shape = static_cast<size_t>(s);
    shapes[shape] = BuildShape(input, shape, r1);
  });
  tables->num_single_modes = static_cast<int32_t>(r1);
  tables->single_handle_modes.clear();
  tables->single_edges.clear();
  tables->single_group_factors.clear();
  tables->single_mode_transforms.clear();
  for (const SingleShapeTables& shape : shapes) {
    LIMBER_RETURN_IF_ERROR(shape.status);
    Append(shape.handle_modes, &tables->single_handle_modes);
    Append(shape.edges, &tables->single_edges);
    Append(shape.group_factors, &tables->single_group_factors);
    Append(shape.mode_transforms, &tables->single_mode_transforms);
  }
  return {};
}

}  // namespace limber::bake
