// The form that the convex step sees against the rig's own tables, written out: Q from the factors
// F, A from the rows of what is held, and sums over all blocks as close as they say they are.
#include "solve/elastic_form.h"

#include "core/rotation_fit.h"
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/held_points.h"
#include "solve/rotation_planes.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace limber {
namespace {

template <int K>
class Posed {
 public:
  explicit Posed(const bake::RawCharacter& raw)
      : rig_(test::BakeInMemory(raw)),
        model_(PoseModel::Create(rig_).value()),
        memory_(*model_),
        rotations_(model_->chunks() * kBlockLanes * K * K),
        blend_(model_->chunks() * kBlockLanes),
        turns_(2, blend_.size()),
        held_(*model_, 0, 2) {
    SetIdentity<K>(&rotations_);
    for (int i = 0; i < model_->num_blocks; ++i) {
      Eigen::Matrix<double, K, K> m = 2 * Eigen::Matrix<double, K, K>::Identity();
      for (double& entry : m.reshaped())
        entry += Number();
      const Eigen::Matrix<double, K, K> rotation = FitRotation<K>(m);
      for (int row = 0; row < K; ++row) {
        for (int column = 0; column < K; ++column)
          rotations_[PlaneIndex<K>(size_t(i), size_t(row), size_t(column))] = rotation(row, column);
      }
      blend_[size_t(i)] = i % 3 == 1 ? 0 : std::abs(Number());
    }
  }

  void Turn(const char* handle) {
    const Quaternion turn = {0, 0, 0.6f, 0.8f};
    const float held = std::numeric_limits<float>::infinity();
    ASSERT_TRUE(held_.SetRotation(*rig_, rig_->FindHandle(handle), turn, held).ok());
  }

  ElasticForm<K> Form() {
    bool changed = false;
    pins_ = &held_.Pins(*model_, &changed);
    AlignedVector<double> targets(pins_->size() * K);
    held_.StoreTargets(targets.data(), turns_.targets.data());
    turns_.Update(ChooseSolveKernels<K>(), *pins_, rotations_.data(), blend_.data());
    ElasticForm<K> form(*model_, *pins_, rotations_, pins_->turns.empty() ? nullptr : &turns_,
                        &memory_);
    form.TakeRotations();
    return form;
  }

  // F_i R_i^T of every block, one after the other: Q are their products.
  Eigen::MatrixXd TurnedFactors() const {
    const RigTables& tables = rig_->tables();
    const Eigen::Index columns = Eigen::Index{K} * model_->num_blocks;
    using Factor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::MatrixXd factor =
        Eigen::Map<const Factor>(tables.residual_factor.data(), tables.residual_rank, columns)
            .template cast<double>();
    Eigen::MatrixXd turned(factor.rows() * K, model_->num_blocks);
    for (Eigen::Index i = 0; i < model_->num_blocks; ++i) {
      const Eigen::MatrixXd one =
          factor.middleCols(i * K, K) * MatrixOfBlock<K>(rotations_.data(), size_t(i)).transpose();
      turned.col(i) = one.reshaped();
    }
    return turned;
  }

  Eigen::MatrixXd Loads(ElasticForm<K>* form) const {
    Eigen::MatrixXd loads(form->num_rows(), model_->num_blocks);
    for (int i = 0; i < model_->num_blocks; ++i)
      form->Load(i, loads.col(i).data());
    return loads;
  }

  const PoseModel& model() const { return *model_; }

  const PinSet& pins() const { return *pins_; }

  const AlignedVector<double>& blend() const { return blend_; }

  const AlignedVector<double>& rotations() const { return rotations_; }

  Eigen::VectorXd Blend() const {
    return Eigen::Map<const Eigen::VectorXd>(blend_.data(), model_->num_blocks);
  }

  double Number() { return range_(engine_); }

 private:
  std::mt19937 engine_{3};
  std::uniform_real_distribution<double> range_{-1, 1};
  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
  ElasticMemory<K> memory_;
  AlignedVector<double> rotations_, blend_;
  PatchTurns<K> turns_;
  HeldPoints held_;
  const PinSet* pins_ = nullptr;
};

template <int K>
void ExpectQuadraticForm(const bake::RawCharacter& raw) {
  Posed<K> posed(raw);
  ElasticForm<K> form = posed.Form();
  const int blocks = posed.model().num_blocks;
  const Eigen::MatrixXd factors = posed.TurnedFactors();
  const Eigen::MatrixXd q = factors.transpose() * factors;
  const double largest = q.cwiseAbs().maxCoeff();
  ASSERT_GT(largest, 0);
  Vector<int> others;
  for (int i = blocks - 1; i >= 0; i -= 2)
    others.push_back(i);
  Vector<double> entries(others.size());
  for (int j = 0; j < blocks; ++j) {
    form.Entries(j, others.data(), others.size(), entries.data());
    for (size_t n = 0; n < others.size(); ++n)
      EXPECT_NEAR(entries[n], q(others[n], j), 1e-13 * largest);
  }
  form.UseBlend(posed.blend().data());
  const double half = 0.5 * posed.Blend().dot(q * posed.Blend());
  EXPECT_NEAR(form.HalfSquare(), half, 1e-13 * half);
}

TEST(ElasticForm, EntriesAndEnergy_AreThoseOfTheFactors) {
  ExpectQuadraticForm<2>(test::MakeStretchSquare(8));
  ExpectQuadraticForm<3>(test::MakeBendCylinder(12, 16));
}

template <int K>
void ExpectGradient(const bake::RawCharacter& raw, const char* turned) {
  Posed<K> posed(raw);
  if (turned != nullptr) posed.Turn(turned);
  ElasticForm<K> form = posed.Form();
  ASSERT_EQ(posed.pins().turns.empty(), turned == nullptr);
  const Eigen::MatrixXd loads = posed.Loads(&form);
  Eigen::VectorXd residual(loads.rows());
  for (double& number : residual)
    number = posed.Number();
  AlignedVector<double> gradient(posed.blend().size()), errors(gradient);
  form.Gradient(posed.blend().data(), residual.data(), gradient.data(), errors.data());
  const Eigen::MatrixXd factors = posed.TurnedFactors();
  const Eigen::VectorXd quadratic = factors.transpose() * (factors * posed.Blend());
  const Eigen::VectorXd pulled = loads.transpose() * residual;
  double off = 0;
  for (Eigen::Index i = 0; i < pulled.size(); ++i) {
    const double error = std::abs(gradient[size_t(i)] - quadratic[i] - pulled[i]);
    EXPECT_LE(error, errors[size_t(i)] + 1e-13 * pulled.cwiseAbs().maxCoeff()) << i;
    EXPECT_LE(errors[size_t(i)], 1e-5 * quadratic.cwiseAbs().maxCoeff()) << i;
    off = std::max(off, error);
  }
  EXPECT_GT(off, 0) << "sums in single precision are expected here";
  // A B, by blocks and as it is subtracted.
  ActiveBlocks<K> active(posed.model().num_blocks);
  active.Collect(posed.blend(), posed.rotations());
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(loads.rows());
  form.TakeLoads(active, rows.data());
  EXPECT_LT((rows + loads * posed.Blend()).norm(), 1e-13 * loads.norm());
}

TEST(ElasticForm, Gradient_IsAsCloseAsItSays) {
  ExpectGradient<2>(test::MakeStretchSquare(8), nullptr);
  ExpectGradient<3>(test::MakeBendCylinder(12, 16), nullptr);
}

TEST(ElasticForm, Gradient_OfTurnedPatches_IsTheirLoads) {
  ExpectGradient<2>(test::MakeStretchSquare(8), "right");
  ExpectGradient<3>(test::MakeBendCylinder(12, 16), "top");
}

}  // namespace
}  // namespace limber
