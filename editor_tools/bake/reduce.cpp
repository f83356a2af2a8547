#include "bake/reduce.h"

#include "bake/group_tensors.h"
#include "bake/mode_basis.h"
#include "bake/pivoted_cholesky.h"
#include "bake/single_shape_models.h"
#include "core/vector.h"

#include <Eigen/QR>

namespace limber::bake {
namespace {

// Energies below this fraction of the largest single one are rounding of the sums before them.
constexpr double kResidualCut = 1e-13;

Vector<Eigen::MatrixXd> ToRigSpace(const geometry::SolveMesh& mesh, const RigTables& tables) {
  const Eigen::Map<const Eigen::Matrix3f> basis(tables.space.basis.data());
  const Eigen::Map<const Eigen::RowVector3f> origin(tables.space.origin.data());
  Vector<Eigen::MatrixXd> shapes;
  for (const geometry::PointMatrix& shape : mesh.shapes) {
    const Eigen::MatrixXd centred = shape.rowwise() - origin.cast<double>();
    const Eigen::MatrixXd turned =
        centred * basis.cast<double>() / static_cast<double>(tables.space.scale);
    shapes.push_back(turned.leftCols(tables.dimension));
  }
  return shapes;
}

void StoreRows(const Eigen::MatrixXd& matrix, Vector<float>* table) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      table->push_back(static_cast<float>(matrix(row, column)));
    }
  }
}

// K_z of all groups: G*S*k x r, rows (g, s, axis): the coordinates of every example's weighted
// edges in the span of the modes' edges.
Eigen::MatrixXd ModeEdges(const Vector<GroupTensors>& groups, const ModeBasis& basis) {
  const Eigen::Index rows = groups.front().edge_load.cols();
  Eigen::MatrixXd edges(rows * static_cast<Eigen::Index>(groups.size()), basis.shapes.cols());
  for (size_t g = 0; g < groups.size(); ++g) {
    edges.middleRows(static_cast<Eigen::Index>(g) * rows, rows) =
        groups[g].edge_load.transpose() * groups[g].Rows(basis.shapes);
  }
  return edges;
}

// Gram matrix of what the modes cannot reach: H - K_z K_z^T, positive semi-definite.
Eigen::MatrixXd ResidualGram(const Vector<GroupTensors>& groups,
                             const Eigen::MatrixXd& mode_edges) {
  Eigen::MatrixXd gram = -mode_edges * mode_edges.transpose();
  Eigen::Index at = 0;
  for (const GroupTensors& group : groups) {
    const Eigen::Index size = group.shape_gram.rows();
    gram.block(at, at, size, size) += group.shape_gram;
    at += size;
  }
  return gram;
}

// Without rotations only whole shapes are mixed: the k axes of a block fold to their trace.
Eigen::MatrixXd FoldAxes(const Eigen::MatrixXd& gram, Eigen::Index k) {
  const Eigen::Index size = gram.rows() / k;
  Eigen::MatrixXd folded(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j)
      folded(i, j) = gram.block(i * k, j * k, k, k).trace();
  }
  return folded;
}

// The modes may be turned among each other at will. Turned so that each example edge in its turn,
// the longest that is left first, needs no more than one further mode, most of K_z is zero or small
// and takes no room in the file. Modes with transforms beyond a thousand are left as they are,
// after the others: examples nearly coincide there, and single precision has no digits to spare for
// what they would bring into the rest. transforms: Phi_1, n x r. Turns *mode_edges; returns the
// orthogonal matrix, r x r.
Eigen::MatrixXd ConcentrateModes(const Eigen::MatrixXd& transforms, Eigen::MatrixXd* mode_edges) {
  constexpr double kLargest = 1000;
  Vector<Eigen::Index> turned, left;
  for (Eigen::Index mode = 0; mode < transforms.cols(); ++mode)
    (transforms.col(mode).cwiseAbs().maxCoeff() <= kLargest ? turned : left).push_back(mode);
  const auto num_turned = static_cast<Eigen::Index>(turned.size());
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(transforms.cols(), transforms.cols());
  if (num_turned > 0) {
    const Eigen::MatrixXd edges = (*mode_edges)(Eigen::all, turned);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(edges.transpose());
    turn(turned, Eigen::seqN(0, num_turned)) = Eigen::MatrixXd(qr.householderQ());
  }
  for (size_t i = 0; i < left.size(); ++i)
    turn(left[i], num_turned + static_cast<Eigen::Index>(i)) = 1;
  *mode_edges *= turn;
  return turn;
}

// `turn`: of the modes among each other.
void StoreModes(const ReduceInput& input, const ModeBasis& basis, const Eigen::MatrixXd& turn,
                RigTables* tables) {
  const Eigen::Index n = basis.transforms.rows();
  const Eigen::Index affine_rows = tables->dimension + 1;
  tables->num_modes = static_cast<int32_t>(basis.transforms.cols());
  // phi_0 moves everything by (1, ..., 1): equal translations in all the shapes of each handle.
  Eigen::MatrixXd transforms = Eigen::MatrixXd::Zero(n, 1 + basis.transforms.cols());
  for (Eigen::Index row = affine_rows - 1; row < n; row += affine_rows) {
    transforms(row, 0) = 1.0 / static_cast<double>(input.mesh->shapes.size());
  }
  transforms.rightCols(basis.transforms.cols()) = basis.transforms * turn;
  tables->mode_transforms.clear();
  StoreRows(transforms, &tables->mode_transforms);
  tables->handle_modes.clear();
  for (int vertex : input.handle_vertices) {
    tables->handle_modes.push_back(1);
    StoreRows(basis.shapes.row(vertex) * turn, &tables->handle_modes);
  }
}

}  // namespace

Status Reduce(const ReduceInput& input, const ProgressCallback& progress, RigTables* tables,
              LocalGroupFactors* local) {
  const auto cancelled = [&progress](const char* stage, double fraction) {
    return progress && !progress(stage, fraction);
  };
  if (cancelled("tensors", 0)) return Error(StatusCode::kInvalidArgument, "cancelled");
  const Vector<Eigen::MatrixXd> shapes = ToRigSpace(*input.mesh, *tables);
  const Eigen::SparseMatrix<double> laplacian =
      SumLaplacian(*input.edges, input.mesh->num_vertices());
  tables->num_groups = input.num_groups;

  Result<ModeBasis> basis = ComputeModeBasis(
      SkinningMatrix(*input.weights, shapes.data(), static_cast<int>(shapes.size())), laplacian,
      input.num_threads);
  if (!basis.ok()) return basis.status();
  if (cancelled("tensors", 0.5)) return Error(StatusCode::kInvalidArgument, "cancelled");

  // Edges of the examples as the modes reach them: a millionth off in length, which on a fine mesh
  // would be a thousandth of the energy's root, and an example must cost nothing at its own
  // handles.
  Vector<Eigen::MatrixXd> reached;
  reached.reserve(shapes.size());
  for (const Eigen::MatrixXd& shape : shapes) {
    reached.push_back(ReachableShape(*basis, laplacian, shape));
  }
  const Vector<GroupTensors> reached_groups =
      BuildGroupTensors(reached, *input.edges, input.num_groups);
  Eigen::MatrixXd mode_edges = ModeEdges(reached_groups, *basis);
  StoreModes(input, *basis, ConcentrateModes(basis->transforms, &mode_edges), tables);
  tables->mode_edges.clear();
  StoreRows(mode_edges, &tables->mode_edges);
  Eigen::MatrixXd gram = ResidualGram(reached_groups, mode_edges);
  if (!tables->has_rotations) gram = FoldAxes(gram, tables->dimension);
  const Eigen::MatrixXd factor = PivotedCholesky(std::move(gram), kResidualCut);
  tables->residual_rank = static_cast<int32_t>(factor.rows());
  tables->residual_factor.clear();
  StoreRows(factor, &tables->residual_factor);
  if (cancelled("tensors", 0.75)) return Error(StatusCode::kInvalidArgument, "cancelled");

  const Vector<GroupTensors> groups = BuildGroupTensors(shapes, *input.edges, input.num_groups);
  const SingleShapeInput single{&shapes,    input.weights,          &groups,
                                &laplacian, &input.handle_vertices, input.num_threads};
  return BuildSingleShapeModels(single, tables, local);
}

}  // namespace limber::bake
