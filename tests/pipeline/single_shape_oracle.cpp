#include "pipeline/single_shape_oracle.h"

#include "bake/edge_groups.h"
#include "core/rotation_fit.h"
#include "core/vector.h"
#include "deform/example_arap/full_energy.h"
#include "geometry/weld.h"

namespace limber::test {
namespace {

constexpr int kMostAlternations = 2000;

}  // namespace

SingleShapeOracle::SingleShapeOracle(const bake::RawCharacter& raw, const Rig& rig, bool rotations)
    : rotations_(rotations) {
  const geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 1e-6);
  for (const geometry::PointMatrix& shape : mesh.shapes)
    shapes_.emplace_back(shape.leftCols(2));
  const SkinMesh& skin = rig.mesh();
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  weights_ =
      Eigen::Map<const RowMajor>(skin.weights.data(), skin.num_solve_vertices, skin.num_handles)
          .cast<double>();
  edges_ = bake::BuildGroupEdges(
      mesh, bake::ClusterVertices(weights_, 2 * skin.num_handles, &num_groups_));
  for (const char* name : {"left", "right"}) {
    const auto handle = static_cast<size_t>(rig.FindHandle(name));
    pinned_.push_back(static_cast<int>(rig.tables().handles[handle].vertex));
  }
  tensors_ = deform::BuildPaperTensors(shapes_, weights_, edges_, num_groups_);
}

Vector<Eigen::MatrixXd> SingleShapeOracle::FitRotations(const Eigen::MatrixXd& q) const {
  Vector<Eigen::Matrix2d> fits(static_cast<size_t>(num_groups_) * shapes_.size(),
                               Eigen::Matrix2d::Zero());
  for (const geometry::GroupEdge& edge : edges_) {
    const Eigen::RowVector2d to = q.row(edge.j) - q.row(edge.i);
    for (size_t s = 0; s < shapes_.size(); ++s) {
      const Eigen::RowVector2d from = shapes_[s].row(edge.j) - shapes_[s].row(edge.i);
      fits[static_cast<size_t>(edge.group) * shapes_.size() + s] +=
          edge.weight * from.transpose() * to;
    }
  }
  Vector<Eigen::MatrixXd> rotations;
  rotations.reserve(fits.size());
  for (const Eigen::Matrix2d& fit : fits)
    rotations.emplace_back(FitRotation<2>(fit));
  return rotations;
}

SingleShapeOracle::Answer SingleShapeOracle::Solve(int shape, Vec3 right) const {
  Eigen::MatrixXd targets(2, 2);
  targets << shapes_[0].row(pinned_[0]), right.x, right.y;
  const size_t num_blocks = static_cast<size_t>(num_groups_) * shapes_.size();
  deform::ExampleState state;
  state.blend.assign(num_blocks, 0);
  for (size_t block = static_cast<size_t>(shape); block < num_blocks; block += shapes_.size())
    state.blend[block] = 1;
  state.rotations.assign(num_blocks, Eigen::Matrix2d::Identity());
  Answer answer;
  for (int i = 0; i < kMostAlternations; ++i) {
    state.q = tensors_.skinning * tensors_.Minimise(pinned_, targets, state.blend, state.rotations);
    if (rotations_) state.rotations = FitRotations(state.q);
    const double energy = deform::ElasticEnergy(shapes_, edges_, state);
    const bool at_rest = i > 0 && !(energy < answer.energy * (1 - 1e-12));
    answer = {energy, state.q};
    if (at_rest) break;
  }
  return answer;
}

}  // namespace limber::test
