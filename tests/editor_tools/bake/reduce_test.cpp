// The factored reduction against the paper's tensors and against sums over the full mesh.
#include "bake/reduce.h"

#include "bake/edge_groups.h"
#include "bake/rig_space.h"
#include "bench/smooth_weights.h"
#include "core/rotation_fit.h"
#include "core/vector.h"
#include "deform/example_arap/full_energy.h"
#include "deform/example_arap/paper_tensors.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "support/test_meshes.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <gtest/gtest.h>

namespace limber::bake {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Table = Eigen::Map<const RowMajor>;

// A reduced character with everything that the oracles need beside it.
struct Reduced {
  geometry::SolveMesh mesh;
  Vector<Eigen::MatrixXd> shapes;  // rig space, V x k
  Eigen::MatrixXd weights;
  Vector<geometry::GroupEdge> edges;
  Vector<int> handle_vertices;
  RigTables tables;
  LocalGroupFactors local;
};

Reduced MakeReduced(const RawCharacter& raw, bool rotations) {
  Reduced r;
  r.mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 0);
  geometry::ConnectComponents(&r.mesh);
  r.tables.space = FitRigSpace(r.mesh.shapes, &r.tables.dimension);
  r.tables.shape_names.assign(raw.shape_names.begin(), raw.shape_names.end());
  r.tables.has_rotations = rotations;
  for (const HandleSpec& spec : raw.marked_handles) {
    RigHandle handle;
    handle.name = spec.name;
    handle.vertex = r.mesh.solve_vertex[*spec.source_vertex];
    r.tables.handles.push_back(handle);
    r.handle_vertices.push_back(static_cast<int>(handle.vertex));
  }
  r.weights = bench::SmoothWeights(r.mesh.shapes[0], r.handle_vertices);
  ReduceInput input;
  r.edges = BuildGroupEdges(r.mesh, ClusterVertices(r.weights, 6, &input.num_groups));
  input.mesh = &r.mesh;
  input.weights = &r.weights;
  input.edges = &r.edges;
  input.handle_vertices = r.handle_vertices;
  const Status status = Reduce(input, {}, &r.tables, &r.local);
  EXPECT_TRUE(status.ok()) << status.message();
  const Eigen::Map<const Eigen::Matrix3f> basis(r.tables.space.basis.data());
  const Eigen::Map<const Eigen::RowVector3f> origin(r.tables.space.origin.data());
  for (const geometry::PointMatrix& shape : r.mesh.shapes) {
    const Eigen::MatrixXd local = (shape.rowwise() - origin.cast<double>()) * basis.cast<double>() /
                                  static_cast<double>(r.tables.space.scale);
    r.shapes.push_back(local.leftCols(r.tables.dimension));
  }
  return r;
}

// Random blend weights on the simplices and rotations, from a fixed seed.
deform::ExampleState RandomState(const Reduced& r, bool rotations, unsigned seed) {
  srand(seed);
  deform::ExampleState state;
  const int k = r.tables.dimension, num_shapes = r.tables.num_shapes();
  for (int g = 0; g < r.tables.num_groups; ++g) {
    const Eigen::VectorXd raw = Eigen::VectorXd::Random(num_shapes).cwiseAbs();
    for (int s = 0; s < num_shapes; ++s) {
      state.blend.push_back(raw[s] / raw.sum());
      Eigen::MatrixXd rotation = Eigen::MatrixXd::Identity(k, k);
      const Eigen::Matrix3d random = Eigen::Matrix3d::Random();
      if (rotations && k == 3) rotation = FitRotation<3>(random);
      if (rotations && k == 2) rotation = FitRotation<2>(random.topLeftCorner<2, 2>());
      state.rotations.push_back(rotation);
    }
  }
  return state;
}

// E_d as rig_tables.h states it, from the float tables alone.
double ReducedEnergyOf(const RigTables& t, const Eigen::MatrixXd& z,
                       const deform::ExampleState& state) {
  const Eigen::Index k = t.dimension, blocks = t.num_groups * t.num_shapes();
  const Table edges(t.mode_edges.data(), blocks * k, t.num_modes);
  const Table factor(t.residual_factor.data(), t.residual_rank,
                     t.has_rotations ? blocks * k : blocks);
  Eigen::MatrixXd gap = z;
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(t.residual_rank, k);
  Eigen::VectorXd folded = Eigen::VectorXd::Zero(t.residual_rank);
  for (Eigen::Index j = 0; j < blocks; ++j) {
    const auto block = static_cast<size_t>(j);
    const double b = state.blend[block];
    gap -= b * edges.middleRows(j * k, k).cast<double>().transpose() *
           state.rotations[block].transpose();
    if (t.has_rotations) {
      rest += b * factor.middleCols(j * k, k).cast<double>() * state.rotations[block].transpose();
    } else {
      folded += b * factor.col(j).cast<double>();
    }
  }
  return 0.5 * (gap.squaredNorm() + rest.squaredNorm() + folded.squaredNorm());
}

// Positions that the modes make: M Phi [t; z].
Eigen::MatrixXd Skinned(const Reduced& r, const Eigen::MatrixXd& z) {
  const Table phi(r.tables.mode_transforms.data(), r.tables.num_transform_rows(),
                  1 + r.tables.num_modes);
  const deform::PaperTensors tensors = deform::BuildPaperTensors(r.shapes, r.weights, {}, 1);
  return tensors.skinning * phi.rightCols(r.tables.num_modes).cast<double>() * z;
}

// Energy of group g in shape s's own model, |U [z; -R^T]|^2.
double SingleGroupEnergy(const RigTables& t, int s, int g, const Eigen::MatrixXd& z,
                         const Eigen::MatrixXd& rotation) {
  const int m = t.num_single_modes + t.dimension;
  const float* packed = t.single_group_factors.data() + (s * t.num_groups + g) * m * (m + 1) / 2;
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(m, m), stacked(m, t.dimension);
  for (int row = 0; row < m; ++row) {
    for (int column = row; column < m; ++column)
      factor(row, column) = *packed++;
  }
  stacked << z, -rotation.transpose();
  return (factor * stacked).squaredNorm();
}

class ReduceTest : public testing::TestWithParam<std::tuple<bool, bool>> {
 protected:
  Reduced MakeCharacter() const {
    const bool planar = std::get<0>(GetParam());
    return MakeReduced(planar ? test::MakeStretchSquare(8) : test::MakeBendCylinder(10, 14),
                       std::get<1>(GetParam()));
  }

  bool rotations() const { return std::get<1>(GetParam()); }
};

// Random modes, each about as large as the examples need it: modes that hardly move anything have
// large transforms, which single precision rounds.
Eigen::MatrixXd RandomModes(const RigTables& t) {
  const Eigen::Index rows = t.num_groups * t.num_shapes() * t.dimension;
  const Table edges(t.mode_edges.data(), rows, t.num_modes);
  const Eigen::VectorXd sizes = edges.cast<double>().colwise().norm();
  return sizes.asDiagonal() * Eigen::MatrixXd::Random(t.num_modes, t.dimension);
}

TEST_P(ReduceTest, Energy_EqualsTheSumOverTheEdgesOfTheFullMesh) {
  const Reduced r = MakeCharacter();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    deform::ExampleState state = RandomState(r, rotations(), seed);
    const Eigen::MatrixXd z = RandomModes(r.tables);
    state.q = Skinned(r, z);
    const double full = deform::ElasticEnergy(r.shapes, r.edges, state);
    EXPECT_NEAR(ReducedEnergyOf(r.tables, z, state), full, 2e-6 * full);
  }
}

TEST_P(ReduceTest, Energy_EqualsThePaperTensorsOne) {
  const Reduced r = MakeCharacter();
  const deform::PaperTensors tensors =
      deform::BuildPaperTensors(r.shapes, r.weights, r.edges, r.tables.num_groups);
  deform::ExampleState state = RandomState(r, rotations(), 7);
  const Eigen::MatrixXd transforms =
      Eigen::MatrixXd::Random(r.tables.num_transform_rows(), r.tables.dimension);
  state.q = tensors.skinning * transforms;
  const double full = deform::ElasticEnergy(r.shapes, r.edges, state);
  EXPECT_NEAR(tensors.Energy(transforms, state.blend, state.rotations), full, 1e-10 * full);
}

TEST_P(ReduceTest, Modes_AreWhiteAndReachWhatTheTransformsReach) {
  const Reduced r = MakeCharacter();
  const Eigen::MatrixXd fields =
      Skinned(r, Eigen::MatrixXd::Identity(r.tables.num_modes, r.tables.num_modes));
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(fields.cols(), fields.cols());
  for (const geometry::GroupEdge& edge : r.edges) {
    const Eigen::RowVectorXd row = fields.row(edge.j) - fields.row(edge.i);
    gram += edge.weight * row.transpose() * row;
  }
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
            1e-4);
  // Every example shape is in their span, translation apart.
  Eigen::MatrixXd basis(fields.rows(), fields.cols() + 1);
  basis << fields, Eigen::VectorXd::Ones(fields.rows());
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
  for (const Eigen::MatrixXd& shape : r.shapes) {
    EXPECT_LT((basis * qr.solve(shape) - shape).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST_P(ReduceTest, HandleModes_GiveTheHandlesPositions) {
  const Reduced r = MakeCharacter();
  const Eigen::MatrixXd z = Eigen::MatrixXd::Random(r.tables.num_modes, r.tables.dimension);
  const Eigen::MatrixXd q = Skinned(r, z);
  const Table rows(r.tables.handle_modes.data(), r.tables.num_handles(), 1 + r.tables.num_modes);
  const Eigen::MatrixXd handles = rows.rightCols(r.tables.num_modes).cast<double>() * z;
  for (size_t h = 0; h < r.handle_vertices.size(); ++h) {
    EXPECT_EQ(rows(static_cast<Eigen::Index>(h), 0), 1);
    EXPECT_LT((handles.row(static_cast<Eigen::Index>(h)) - q.row(r.handle_vertices[h])).norm(),
              1e-5 * (1 + q.row(r.handle_vertices[h]).norm()));
  }
}

TEST_P(ReduceTest, SingleGroupFactors_GiveEachGroupsEnergyOfTheFullMesh) {
  const Reduced r = MakeCharacter();
  const int k = r.tables.dimension, r1 = r.tables.num_single_modes;
  for (int s = 0; s < r.tables.num_shapes(); ++s) {
    // A rigidly moved shape, so that the answer is known: R = motion gives zero, the identity not.
    const deform::ExampleState state = RandomState(r, true, 3);
    const Eigen::MatrixXd& motion = state.rotations[0];
    const Eigen::MatrixXd q = r.shapes[static_cast<size_t>(s)] * motion.transpose();
    // Its modes by the whitening: z = sum_g K_g^T motion^T.
    Eigen::MatrixXd z = Eigen::MatrixXd::Zero(r1, k);
    for (int g = 0; g < r.tables.num_groups; ++g) {
      const Table edges(r.tables.single_edges.data() + (s * r.tables.num_groups + g) * k * r1, k,
                        r1);
      z += edges.cast<double>().transpose() * motion.transpose();
    }
    for (int g = 0; g < r.tables.num_groups; ++g) {
      for (const Eigen::MatrixXd& rotation :
           {motion, Eigen::MatrixXd(Eigen::MatrixXd::Identity(k, k))}) {
        const double full =
            deform::GroupEnergy(r.shapes[static_cast<size_t>(s)], r.edges, g, q, rotation);
        EXPECT_NEAR(SingleGroupEnergy(r.tables, s, g, z, rotation), full, 1e-5 * full + 1e-10);
      }
    }
  }
}

// The row of M_s at any vertex, times the transforms, is the mode field there: in the handles'
// vertices what single_handle_modes says, and all rows together give the shape's own edges.
TEST_P(ReduceTest, SingleModeTransforms_GiveTheModesAnywhere) {
  const Reduced r = MakeCharacter();
  const RigTables& t = r.tables;
  const Eigen::Index r1 = t.num_single_modes, rows = t.num_handles() * (t.dimension + 1);
  for (int s = 0; s < t.num_shapes(); ++s) {
    const Table transforms(t.single_mode_transforms.data() + s * rows * (1 + r1), rows, 1 + r1);
    const Table handles(t.single_handle_modes.data() + s * t.num_handles() * (1 + r1),
                        t.num_handles(), 1 + r1);
    const Vector<Eigen::MatrixXd> shape = {r.shapes[static_cast<size_t>(s)]};
    const Eigen::MatrixXd skinning = deform::BuildPaperTensors(shape, r.weights, {}, 1).skinning;
    const Eigen::MatrixXd fields = skinning * transforms.cast<double>();
    EXPECT_LT((fields.col(0).array() - 1).abs().maxCoeff(), 1e-6)
        << "a translation moves all alike";
    for (int h = 0; h < t.num_handles(); ++h) {
      const Eigen::RowVectorXd known = handles.row(h).cast<double>();
      EXPECT_LT((fields.row(r.handle_vertices[static_cast<size_t>(h)]) - known).norm(),
                1e-5 * known.norm());
    }
    // Elsewhere: the energy of a group by way of these fields is that of its factor.
    const Eigen::MatrixXd z = Eigen::MatrixXd::Random(r1, t.dimension);
    const Eigen::MatrixXd q = fields.rightCols(r1) * z;
    const deform::ExampleState state = RandomState(r, true, 5);
    for (int g = 0; g < t.num_groups; ++g) {
      const Eigen::MatrixXd& rotation = state.rotations[static_cast<size_t>(g)];
      const double full = deform::GroupEnergy(shape[0], r.edges, g, q, rotation);
      EXPECT_NEAR(SingleGroupEnergy(t, s, g, z, rotation), full, 1e-5 * full + 1e-10);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Characters, ReduceTest, testing::Combine(testing::Bool(), testing::Bool()),
                         [](const auto& parameter) {
                           return std::string(std::get<0>(parameter.param) ? "Square"
                                                                           : "Cylinder") +
                                  (std::get<1>(parameter.param) ? "" : "WithoutRotations");
                         });

}  // namespace
}  // namespace limber::bake
