// The alternation's quantities against the same ones of the full mesh and of finite differences.
#include "solve/alternation.h"

#include "bake/edge_groups.h"
#include "core/rotation_fit.h"
#include "core/vector.h"
#include "deform/example_arap/full_energy.h"
#include "deform/example_arap/paper_tensors.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "runtime/solve/solved_character.h"

#include <Eigen/Geometry>

#include <numeric>

namespace limber {
namespace {

constexpr int kGroups = 5;

class AlternationTest : public testing::Test {
 protected:
  void SetUp() override {
    const bake::RawCharacter raw = test::MakeBendCylinder(12, 16);
    bake::BakeOptions options;
    options.num_groups = kGroups;
    rig_ = test::BakeInMemory(raw, options);
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
    RebuildEdges(raw);
    alternation_.emplace(*model_);
    for (size_t c = 0; c < model_->pins->size(); ++c) {
      const RigHandle& handle =
          rig_->tables().handles[static_cast<size_t>(model_->pinned_handles[c])];
      const Vec3 x = rig_->ToRig(handle.rest_position);
      Targets().row(static_cast<Eigen::Index>(c)) << x.x, x.y, x.z;
      pinned_vertices_.push_back(static_cast<int>(handle.vertex));
    }
    alternation_->ResetToRest(*model_);
    // Somewhere no example is: the top handle bent sideways and pulled.
    Targets().row(1) += Eigen::RowVector3d(0.3, -0.1, 0.15);
    for (int i = 0; i < 12; ++i)
      outcome_ = alternation_->Run(*model_, {});
  }

  // X, c x 3.
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> Targets() {
    return {alternation_->targets.data(), static_cast<Eigen::Index>(model_->pins->size()), 3};
  }

  // The bake's edges and shapes once more, from the weights that it stored.
  void RebuildEdges(const bake::RawCharacter& raw) {
    geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 1e-7);
    geometry::ConnectComponents(&mesh);
    const SkinMesh& skin = rig_->mesh();
    weights_.resize(skin.num_solve_vertices, skin.num_handles);
    for (Eigen::Index v = 0; v < weights_.rows(); ++v) {
      for (Eigen::Index h = 0; h < weights_.cols(); ++h) {
        weights_(v, h) = skin.weights[static_cast<size_t>(v * weights_.cols() + h)];
      }
    }
    int groups = 0;
    edges_ = bake::BuildGroupEdges(mesh, bake::ClusterVertices(weights_, kGroups, &groups));
    for (int s = 0; s < skin.num_shapes; ++s) {
      Eigen::MatrixXd shape(weights_.rows(), 3);
      for (Eigen::Index v = 0; v < shape.rows(); ++v) {
        const Vec3 p = skin.shape_positions[static_cast<size_t>(s * shape.rows() + v)];
        shape.row(v) << p.x, p.y, p.z;
      }
      shapes_.push_back(shape);
    }
  }

  deform::ExampleState State() {
    deform::ExampleState state;
    state.blend.assign(alternation_->blend().begin(), alternation_->blend().end());
    state.blend.resize(static_cast<size_t>(model_->num_blocks));
    for (int block = 0; block < model_->num_blocks; ++block)
      state.rotations.emplace_back(alternation_->rotation(block));
    const AlignedVector<double>& planes = alternation_->Transforms(*model_);
    Eigen::MatrixXd transforms(rig_->tables().num_transform_rows(), 3);
    for (Eigen::Index row = 0; row < transforms.rows(); ++row) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        transforms(row, c) = planes[static_cast<size_t>((row / 8 * 3 + c) * 8 + row % 8)];
      }
    }
    state.q = deform::BuildPaperTensors(shapes_, weights_, {}, 1).skinning * transforms;
    return state;
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
  std::optional<Alternation<3>> alternation_;
  Alternation<3>::Outcome outcome_;
  Vector<int> pinned_vertices_;
  Eigen::MatrixXd weights_;
  Vector<Eigen::MatrixXd> shapes_;
  Vector<geometry::GroupEdge> edges_;
};

TEST_F(AlternationTest, Energy_EqualsTheOneOfTheFullMesh) {
  const deform::ExampleState state = State();
  double nearness = 0;
  const double reduced = std::sqrt(alternation_->ElasticEnergy(*model_, &nearness));
  const double full = std::sqrt(deform::ElasticEnergy(shapes_, edges_, state));
  EXPECT_GT(full, 1e-3) << "the pose must be one that costs energy";
  EXPECT_NEAR(reduced, full, 1e-5 * full);
}

TEST_F(AlternationTest, Transforms_AreTheMinimiserOfThePaperTensors) {
  const deform::ExampleState state = State();
  const deform::PaperTensors tensors =
      deform::BuildPaperTensors(shapes_, weights_, edges_, rig_->num_groups());
  const Eigen::MatrixXd slow =
      tensors.Minimise(pinned_vertices_, Targets(), state.blend, state.rotations);
  EXPECT_LT((tensors.skinning * slow - state.q).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(tensors.Energy(slow, state.blend, state.rotations),
              deform::ElasticEnergy(shapes_, edges_, state), 1e-6);
}

TEST_F(AlternationTest, PinnedHandles_AreAtTheirTargets) {
  const deform::ExampleState state = State();
  for (size_t c = 0; c < pinned_vertices_.size(); ++c) {
    EXPECT_LT(
        (state.q.row(pinned_vertices_[c]) - Targets().row(static_cast<Eigen::Index>(c))).norm(),
        1e-5);
  }
}

// f(B) with the transforms eliminated, once more from the full mesh; its slope by differences.
TEST_F(AlternationTest, QuadraticForm_HasTheSlopeOfFiniteDifferences) {
  deform::ExampleState state = State();
  const deform::PaperTensors tensors =
      deform::BuildPaperTensors(shapes_, weights_, edges_, rig_->num_groups());
  const auto value = [&](const Vector<double>& blend) {
    const Eigen::MatrixXd t = tensors.Minimise(pinned_vertices_, Targets(), blend, state.rotations);
    return tensors.Energy(t, blend, state.rotations);
  };
  AlignedVector<double> planes(model_->chunks() * 8 * 9);
  for (int i = 0; i < model_->num_blocks; ++i) {
    for (int entry = 0; entry < 9; ++entry) {
      planes[PlaneIndex<3>(size_t(i), size_t(entry) / 3, size_t(entry) % 3)] =
          state.rotations[size_t(i)](entry / 3, entry % 3);
    }
  }
  ElasticMemory<3> memory(*model_);
  ElasticForm<3> form(*model_, *model_->pins, planes, nullptr, &memory);
  form.TakeRotations();
  Vector<int> all(static_cast<size_t>(model_->num_blocks));
  std::iota(all.begin(), all.end(), 0);
  // K_z C^T, of which f's other part is made: 1/2 tr(d^T W d), d = X - sum_j B_j V_j^T R_j^T.
  const RigTables& tables = rig_->tables();
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      edges(tables.mode_edges.data(), Eigen::Index{model_->num_blocks} * 3, tables.num_modes);
  const Eigen::MatrixXd loads = edges.cast<double>() * model_->pins->system.modes().transpose();
  Eigen::MatrixXd gap = Targets();
  const auto turned = [&](int j) {
    return Eigen::MatrixXd((state.rotations[size_t(j)] * loads.middleRows<3>(3 * j)).transpose());
  };
  for (int j = 0; j < model_->num_blocks; ++j)
    gap -= state.blend[size_t(j)] * turned(j);
  const double step = 1e-4;
  Vector<double> column(all.size());
  for (int i = 0; i < model_->num_blocks; ++i) {
    Vector<double> up = state.blend, down = state.blend;
    up[static_cast<size_t>(i)] += step;
    down[static_cast<size_t>(i)] -= step;
    const double differences = (value(up) - value(down)) / (2 * step);
    double slope = -(turned(i).transpose() * model_->pins->system.response() * gap).trace();
    form.Entries(i, all.data(), all.size(), column.data());
    for (int j = 0; j < model_->num_blocks; ++j)
      slope += column[size_t(j)] * state.blend[size_t(j)];
    EXPECT_NEAR(slope, differences, 1e-5 * model_->energy_scale) << "block " << i;
  }
}

TEST_F(AlternationTest, Nearness_IsEachShapesOwnEnergyOnTheFullMesh) {
  // At rest D is the energy of the single-shape problem, solved here slowly on the full mesh.
  alternation_->Run(*model_, {});
  for (int s = 0; s < model_->num_shapes; ++s) {
    const deform::PaperTensors single = deform::BuildPaperTensors(
        {shapes_[static_cast<size_t>(s)]}, weights_, edges_, rig_->num_groups());
    Vector<Eigen::MatrixXd> rotations(static_cast<size_t>(model_->num_groups),
                                      Eigen::Matrix3d::Identity());
    const Vector<double> ones(static_cast<size_t>(model_->num_groups), 1.0);
    // Local/global from the rotations of the alternation until it rests.
    for (int g = 0; g < model_->num_groups; ++g) {
      rotations[static_cast<size_t>(g)] = alternation_->rotation(g * model_->num_shapes + s);
    }
    Eigen::MatrixXd q;
    for (int i = 0; i < 200; ++i) {
      const Eigen::MatrixXd t = single.Minimise(pinned_vertices_, Targets(), ones, rotations);
      q = single.skinning * t;
      for (int g = 0; g < model_->num_groups; ++g) {
        rotations[static_cast<size_t>(g)] =
            FitRotation<3>(Eigen::Matrix3d(single.load[static_cast<size_t>(g)] * t));
      }
    }
    for (int i = 0; i < 200; ++i)
      alternation_->Run(*model_, {});
    for (int g = 0; g < model_->num_groups; ++g) {
      const double full = deform::GroupEnergy(shapes_[static_cast<size_t>(s)], edges_, g, q,
                                              rotations[static_cast<size_t>(g)]);
      EXPECT_NEAR(alternation_->Distance(*model_, g * model_->num_shapes + s), full,
                  2e-3 * full + 1e-8);
    }
  }
}

}  // namespace
}  // namespace limber
