// E_d with the modes as unknowns: against the alternation's own, and its slope through the
// rotations against finite differences.
#include "solve/mode_energy.h"

#include "core/rotation_fit.h"
#include "runtime/solve/solved_character.h"
#include "solve/alternation.h"
#include "solve/rotation_planes.h"

#include <Eigen/Geometry>

#include <random>

namespace limber {
namespace {

template <int K>
using Small = Eigen::Matrix<double, K, K>;

template <int K>
Small<K> RandomMatrix(std::mt19937* engine) {
  std::normal_distribution<double> normal;
  return Small<K>::NullaryExpr([&] { return normal(*engine); });
}

// U diag(d) V^T.
template <int K>
Small<K> MatrixWith(const Eigen::Matrix<double, K, 1>& d, std::mt19937* engine) {
  const Small<K> u = FitRotation<K>(RandomMatrix<K>(engine));
  return u * d.asDiagonal() * FitRotation<K>(RandomMatrix<K>(engine));
}

// The largest difference of the two slopes, of the larger of one and the slope.
template <int K>
double PullBackError(const Small<K>& fit, double step, std::mt19937* engine) {
  const Small<K> pull = RandomMatrix<K>(engine);
  const Small<K> slope = PullBack<K>(fit, FitRotation<K>(fit), pull);
  Small<K> differences;
  for (int entry = 0; entry < K * K; ++entry) {
    Small<K> up = fit, down = fit;
    up(entry) += step;
    down(entry) -= step;
    differences(entry) = ((FitRotation<K>(up) - FitRotation<K>(down)) * pull).trace() / (2 * step);
  }
  return (slope - differences).norm() / std::max(1.0, differences.norm());
}

TEST(PullBack, AnyMatrix_GivesTheSlopeOfFiniteDifferences) {
  std::mt19937 engine(1);
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(PullBackError<2>(MatrixWith<2>({2, 0.7}, &engine), 1e-5, &engine), 1e-7);
    EXPECT_LT(PullBackError<3>(MatrixWith<3>({2, 1, 0.3}, &engine), 1e-5, &engine), 1e-7);
  }
}

TEST(PullBack, NearlySingularOrReflected_GivesTheSlopeOfFiniteDifferences) {
  std::mt19937 engine(2);
  for (int i = 0; i < 100; ++i) {
    // D_22 + D_33 is a thousandth; edges in a plane; a reflection.
    EXPECT_LT(PullBackError<2>(MatrixWith<2>({1, -0.999}, &engine), 1e-7, &engine), 1e-4);
    EXPECT_LT(PullBackError<3>(MatrixWith<3>({2, 1e-3, 0}, &engine), 1e-7, &engine), 1e-4);
    EXPECT_LT(PullBackError<3>(MatrixWith<3>({2, 1, 0}, &engine), 1e-5, &engine), 1e-7);
    EXPECT_LT(PullBackError<3>(MatrixWith<3>({2, 1, -0.999}, &engine), 1e-7, &engine), 1e-4);
  }
}

TEST(PullBack, WhereTheRotationJumps_StaysFinite) {
  std::mt19937 engine(3);
  const Small<3> pull = RandomMatrix<3>(&engine);
  for (const Eigen::Vector3d& d : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 1, -1),
                                   Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1e-20, 0)}) {
    const Small<3> fit = MatrixWith<3>(d, &engine);
    EXPECT_TRUE(PullBack<3>(fit, FitRotation<3>(fit), pull).allFinite());
  }
  EXPECT_EQ(PullBack<3>(Small<3>::Zero(), Small<3>::Identity(), Small<3>::Zero()),
            Small<3>::Zero());
  EXPECT_EQ(PullBack<2>(Small<2>::Zero(), Small<2>::Identity(), Small<2>::Zero()),
            Small<2>::Zero());
}

template <int K>
class ModeEnergyCase {
 public:
  explicit ModeEnergyCase(const std::shared_ptr<const Rig>& rig)
      : model(PoseModel::Create(rig).value()),
        energy(*model),
        alternation(*model),
        modes(energy.size()),
        parts(energy.MakeParts()) {
    std::mt19937 engine(4);
    std::normal_distribution<double> normal;
    for (size_t c = 0; c < model->pins->size(); ++c) {
      const auto handle = static_cast<size_t>(model->pinned_handles[c]);
      const Vec3 x = rig->ToRig(rig->tables().handles[handle].rest_position);
      for (int axis = 0; axis < K; ++axis)
        alternation.targets[c * K + static_cast<size_t>(axis)] =
            static_cast<double>(x[axis]) + 0.1 * normal(engine);
    }
    alternation.ResetToRest(*model);
    for (int i = 0; i < 5; ++i)
      alternation.Run(*model, {});
    energy.Wanted(*model, alternation.blend(), alternation.rotations(), modes.data());
    const size_t stride = model->pins->load_stride();
    AlignedVector<double> values(K * stride);
    energy.AtPins(*model->pins, modes.data(), values.data());
    for (size_t p = 0; p < model->pins->rank(); ++p) {
      for (size_t c = 0; c < K; ++c) {
        double goal = 0;
        for (size_t pin = 0; pin < model->pins->size(); ++pin)
          goal += model->pins->system.root()(static_cast<Eigen::Index>(pin),
                                             static_cast<Eigen::Index>(p)) *
                  alternation.targets[pin * K + c];
        values[c * stride + p] = goal - values[c * stride + p];
      }
    }
    energy.AddPinned(*model->pins, values.data(), modes.data());
  }

  // Adds |z| * size, at random, to the modes.
  AlignedVector<double> Direction(double size, std::mt19937* engine) const {
    std::normal_distribution<double> normal;
    AlignedVector<double> direction(modes.size());
    const size_t stride = modes.size() / K;
    for (size_t i = 0; i < direction.size(); ++i) {
      if (i % stride < static_cast<size_t>(model->num_modes))
        direction[i] = size * normal(*engine) * std::sqrt(model->energy_scale / model->num_modes);
    }
    return direction;
  }

  std::shared_ptr<const PoseModel> model;
  ModeEnergy<K> energy;
  Alternation<K> alternation;
  AlignedVector<double> modes;
  typename ModeEnergy<K>::Parts parts;
};

template <int K>
void ExpectSameAsTheAlternation(const std::shared_ptr<const Rig>& rig) {
  ModeEnergyCase<K> pose(rig);
  pose.energy.Evaluate(*pose.model, pose.modes.data(), pose.alternation.blend(),
                       pose.alternation.rotations(), &pose.parts);
  double nearness = 0;
  const double expected = pose.alternation.ElasticEnergy(*pose.model, &nearness);
  EXPECT_GT(expected, 1e-6 * pose.model->energy_scale) << "the pose must be one that costs energy";
  EXPECT_NEAR(pose.parts.energy, expected, 1e-6 * expected);
  AlignedVector<double> transforms(pose.model->row_chunks() * kBlockLanes * K);
  pose.energy.Transforms(*pose.model, pose.alternation.pins(), pose.modes.data(),
                         pose.alternation.targets.data(), &transforms);
  const AlignedVector<double>& plain = pose.alternation.Transforms(*pose.model);
  double largest = 0;
  for (size_t i = 0; i < plain.size(); ++i)
    largest = std::max(largest, std::abs(plain[i]));
  for (size_t i = 0; i < plain.size(); ++i)
    ASSERT_NEAR(transforms[i], plain[i], 1e-5 * largest);
}

TEST(ModeEnergy, EliminatedModes_HaveTheAlternationsEnergyAndTransforms) {
  ExpectSameAsTheAlternation<2>(test::BakeInMemory(test::MakeStretchSquare(8)));
  ExpectSameAsTheAlternation<3>(test::BakeInMemory(test::MakeBendCylinder(12, 16)));
}

// d/dt E_d(z + t d, B, R(z + t d)) less the same with R(z) held, at z and B far from any optimum.
template <int K>
void ExpectSlopeOfDifferences(const std::shared_ptr<const Rig>& rig) {
  ModeEnergyCase<K> pose(rig);
  const PoseModel& model = *pose.model;
  std::mt19937 engine(5);
  for (int round = 0; round < 10; ++round) {
    AlignedVector<double> blend(model.chunks() * kBlockLanes), modes = pose.modes;
    for (int i = 0; i < model.num_blocks; ++i)
      blend[static_cast<size_t>(i)] = 1.0 / model.num_shapes;
    const AlignedVector<double> away = pose.Direction(0.2 * round, &engine);
    for (size_t i = 0; i < modes.size(); ++i)
      modes[i] += away[i];
    AlignedVector<double> rotations = pose.alternation.rotations(), slope(modes.size());
    pose.energy.FitRotations(model, modes.data(), &rotations);
    pose.energy.SlopeThroughRotations(model, modes.data(), blend, rotations, slope.data());
    const AlignedVector<double> direction = pose.Direction(1, &engine);
    double expected = 0, along = 0, squared = 0;
    for (size_t i = 0; i < modes.size(); ++i) {
      along += slope[i] * direction[i];
      squared += slope[i] * slope[i];
    }
    const double step = 1e-5;
    for (double sign : {1.0, -1.0}) {
      AlignedVector<double> moved = modes, fitted = rotations;
      for (size_t i = 0; i < modes.size(); ++i)
        moved[i] += sign * step * direction[i];
      pose.energy.FitRotations(model, moved.data(), &fitted);
      pose.energy.Evaluate(model, moved.data(), blend, fitted, &pose.parts);
      expected += sign * pose.parts.energy / (2 * step);
      pose.energy.Evaluate(model, moved.data(), blend, rotations, &pose.parts);
      expected -= sign * pose.parts.energy / (2 * step);
    }
    EXPECT_GT(std::sqrt(squared), 1e-4 * std::sqrt(model.energy_scale)) << "there is a slope";
    EXPECT_NEAR(along, expected, 1e-6 * (std::abs(expected) + model.energy_scale));
  }
}

// Shape 1 turned by 40 degrees and sheared, so that the rotations of the shapes differ.
bake::RawCharacter Sheared(bake::RawCharacter raw) {
  Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  turn(0, 1) += 0.8;
  raw.shapes[1] = raw.shapes[1] * turn.transpose();
  return raw;
}

TEST(ModeEnergy, SlopeThroughRotations_IsThatOfFiniteDifferences) {
  ExpectSlopeOfDifferences<2>(test::BakeInMemory(Sheared(test::MakeStretchSquare(8))));
  ExpectSlopeOfDifferences<3>(test::BakeInMemory(Sheared(test::MakeBendCylinder(12, 16))));
}

}  // namespace
}  // namespace limber
