// Figures 2 and 8 of the paper as statements about numbers: the shipped square, dragged by its
// right handle, under our energy and under those that the paper compares it with. The pictures of
// the same drags are made by content/figures/make_figures.sh.
#include "bake/bake.h"
#include "core/vector.h"
#include "import/import_gltf.h"
#include "pipeline/single_shape_oracle.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace limber {
namespace {

constexpr int kSquare = 0, kPuffed = 1, kThinned = 2;
constexpr double kWidths[] = {1, 1.6, 2.4};  // of the three shapes: red, green, blue

// One frame, settled.
struct Pose {
  double x = 0;           // of the right handle
  Eigen::Vector3d blend;  // mean of B over the groups
  double spread = 0;      // largest distance of a group's B from the first group's
  double elastic = 0;
};

PoseOptions Ours(float lambda, bool rotations) {
  PoseOptions options;
  options.iterations = 150;
  options.lambda = lambda;
  options.rotations = rotations;
  return options;
}

// Eq. 2: with one blend for all and no roots, eq. 10 is E_d(q, blend(P, b)) + lambda d.b. As lambda
// grows, b goes to the vertex of the simplex with the least d_s = min_q E_d(q, p_s), and q to that
// minimiser, which is the joint minimum of sum_s b_s E_d(q, p_s) over q and b.
PoseOptions EnergyInterpolation(bool rotations) {
  PoseOptions options = Ours(1e6f, rotations);
  options.varying_blend = false;
  options.square_roots = false;
  return options;
}

// Eq. 3 with a linear blend.
PoseOptions LinearShapeSpace() {
  PoseOptions options = Ours(0, false);
  options.varying_blend = false;
  return options;
}

class FiguresTest : public testing::Test {
 protected:
  void SetUp() override {
    Result<bake::RawCharacter> raw =
        bake::ImportGltf(LIMBER_SOURCE_DIR "/content/characters/square.glb");
    ASSERT_TRUE(raw.ok()) << raw.status().message();
    Load(std::move(raw).value());
  }

  void Load(bake::RawCharacter raw) {
    raw_ = std::move(raw);
    rig_ = test::BakeInMemory(raw_);
    ASSERT_NE(rig_, nullptr);
    state_.emplace(PoseState::Create(rig_).value());
  }

  Pose PoseAt(double x, const PoseOptions& options) {
    EXPECT_TRUE(state_->SetTarget(rig_->FindHandle("right"), {static_cast<float>(x), 0, 0}).ok());
    PoseReport report;
    EXPECT_TRUE(state_->Solve(options, &report).ok());
    Pose pose{x, Eigen::Vector3d::Zero(), 0, report.elastic};
    const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> blend(
        state_->blend_weights().data(), 3, rig_->num_groups());
    pose.blend = blend.rowwise().mean();
    pose.spread = (blend.colwise() - blend.col(0)).cwiseAbs().maxCoeff();
    return pose;
  }

  // From `from` to `to` in steps of `step`.
  Vector<Pose> Drag(double from, double to, double step, const PoseOptions& options) {
    const auto steps = static_cast<int>(std::lround(std::abs(to - from) / step));
    Vector<Pose> poses;
    for (int i = 0; i <= steps; ++i)
      poses.push_back(PoseAt(from + (to - from) * i / steps, options));
    return poses;
  }

  static double LargestStep(const Vector<Pose>& poses) {
    double largest = 0;
    for (size_t i = 1; i < poses.size(); ++i) {
      largest = std::max(largest, (poses[i].blend - poses[i - 1].blend).cwiseAbs().maxCoeff());
    }
    return largest;
  }

  bake::RawCharacter raw_;
  std::shared_ptr<const Rig> rig_;
  std::optional<PoseState> state_;
};

// The mix of the two examples whose widths lie around x.
Eigen::Vector3d PiecewiseLinear(double x) {
  Eigen::Vector3d blend = Eigen::Vector3d::Zero();
  const int left = x < kWidths[1] ? kSquare : kPuffed;
  const double share =
      std::clamp((x - kWidths[left]) / (kWidths[left + 1] - kWidths[left]), 0.0, 1.0);
  blend[left] = 1 - share;
  blend[left + 1] = share;
  return blend;
}

TEST_F(FiguresTest, Square_HasThePapersWidths) {
  for (int s = 0; s < 3; ++s) {
    const Pose pose = PoseAt(kWidths[s], Ours(0.5f, true));
    EXPECT_NEAR(pose.blend[s], 1, 1e-6) << kWidths[s];
    EXPECT_LT(pose.elastic, 1e-5);
  }
}

// Figure 2c. Another way to the same choice and the same pose: each shape by itself, on the full
// mesh. In double, because the shipped file's rounded coordinates add modes of their own.
TEST_F(FiguresTest, EnergyInterpolation_IsTheSingleShapeOfLeastEnergy) {
  Load(test::MakeStretchSquare(20));
  for (const bool rotations : {false, true}) {
    const test::SingleShapeOracle oracle(raw_, *rig_, rotations);
    for (int i = 0; i < 24; ++i) {
      const double x = 0.65 + 0.1 * i;
      const Pose pose = PoseAt(x, EnergyInterpolation(rotations));
      Vector<test::SingleShapeOracle::Answer> answers;
      Vector<double> energies;
      for (int s = 0; s < 3; ++s) {
        answers.push_back(oracle.Solve(s, {static_cast<float>(x), 0, 0}));
        energies.push_back(answers.back().energy);
      }
      const auto best = std::min_element(energies.begin(), energies.end()) - energies.begin();
      EXPECT_NEAR(pose.blend[best], 1, 1e-9) << "at " << x << ", shape " << best;
      const auto& nearest = answers[static_cast<size_t>(best)];
      EXPECT_NEAR(pose.elastic, std::sqrt(nearest.energy), 1e-4 * pose.elastic) << "at " << x;
      const Vector<Eigen::Vector3d> q = test::SkinNaively(*rig_, state_->transforms());
      double furthest = 0;
      for (Eigen::Index v = 0; v < nearest.q.rows(); ++v) {
        const Eigen::Vector2d at = q[static_cast<size_t>(v)].head<2>();
        furthest = std::max(furthest, (at - nearest.q.row(v).transpose()).norm());
      }
      EXPECT_LT(furthest, 1e-3) << "at " << x;
    }
  }
}

// However small the drag's step: one shape in full, then another.
TEST_F(FiguresTest, EnergyInterpolation_JumpsFromShapeToShape) {
  for (const double step : {0.01, 0.002}) {
    const Vector<Pose> poses = Drag(1, 2.6, step, EnergyInterpolation(true));
    EXPECT_NEAR(LargestStep(poses), 1, 1e-6);
    for (const Pose& pose : poses)
      EXPECT_NEAR(pose.blend.maxCoeff(), 1, 1e-6) << "at " << pose.x;
    EXPECT_GT(poses.back().blend[kThinned], 0.5);
  }
}

// Figure 2d: on the way out nothing of the puffed shape, half and half in the middle.
TEST_F(FiguresTest, LinearShapeSpace_IgnoresThePuffedShape) {
  for (const Pose& pose : Drag(1, 2.4, 0.01, LinearShapeSpace())) {
    EXPECT_LT(pose.blend[kPuffed], 1e-4) << "at " << pose.x;
    EXPECT_LT(pose.elastic, 1e-5) << "at " << pose.x;
    EXPECT_NEAR(pose.blend[kThinned], (pose.x - 1) / 1.4, 1e-4) << "at " << pose.x;
  }
  for (const Pose& pose : Drag(2.4, 1, 0.01, LinearShapeSpace()))
    EXPECT_LT(pose.blend[kPuffed], 0.1) << "on the way back, at " << pose.x;
}

// The optimum is a whole segment of blends; which one is found depends on where the drag comes
// from.
TEST_F(FiguresTest, LinearShapeSpace_IsAmbiguous) {
  const Pose puffed = PoseAt(1.6, Ours(0.5f, false));
  ASSERT_GT(puffed.blend[kPuffed], 0.999);
  const Pose from_puffed = PoseAt(1.6, LinearShapeSpace());
  EXPECT_GT(from_puffed.blend[kPuffed], 0.999);
  EXPECT_LT(from_puffed.elastic, 1e-5);
  state_->ResetToRest();
  const Pose from_rest = PoseAt(1.6, LinearShapeSpace());
  EXPECT_LT(from_rest.blend[kPuffed], 1e-3);
  EXPECT_LT(from_rest.elastic, 1e-5);
}

// Figures 2a, 2b and 8: every shape is used where it belongs, and the way back is the way out.
TEST_F(FiguresTest, Ours_UsesEveryShapeAndHasNoHysteresis) {
  const struct {
    float lambda;
    bool rotations;
  } panels[] = {{0.5f, false}, {10, false}, {0.01f, false}, {0.5f, true}};

  for (const auto& panel : panels) {
    const PoseOptions options = Ours(panel.lambda, panel.rotations);
    // Away from the round numbers, where two answers cost the same.
    const Vector<Pose> out = Drag(0.603, 3.003, 0.01, options);
    Vector<Pose> back = Drag(3.003, 0.603, 0.01, options);
    std::reverse(back.begin(), back.end());
    for (size_t i = 0; i < out.size(); ++i) {
      EXPECT_LT((out[i].blend - back[i].blend).cwiseAbs().maxCoeff(), 1e-3)
          << "lambda " << panel.lambda << ", rotations " << panel.rotations << ", at " << out[i].x;
    }
    for (int s = 0; s < 3; ++s)
      EXPECT_GT(PoseAt(kWidths[s], options).blend[s], 1 - 1e-5);
    EXPECT_GT(out.front().blend[kSquare], 1 - 1e-6);
    EXPECT_GT(out.back().blend[kThinned], 1 - 1e-6);
  }
}

// Figure 8, bottom left.
TEST_F(FiguresTest, SmallLambda_IsPiecewiseLinearAndContinuous) {
  for (const double step : {0.01, 0.001}) {
    const Vector<Pose> poses = Drag(1, 2.4, step, Ours(0.01f, false));
    for (const Pose& pose : poses) {
      EXPECT_LT((pose.blend - PiecewiseLinear(pose.x)).cwiseAbs().maxCoeff(), 0.005)
          << "at " << pose.x;
    }
    EXPECT_LT(LargestStep(poses), 1.05 * step / 0.6) << "step " << step;
  }
}

// Figure 8, top right: nearest shape but for a narrow ramp half way between two.
TEST_F(FiguresTest, LargeLambda_IsNearlyPiecewiseConstant) {
  for (const Pose& pose : Drag(1, 2.4, 0.01, Ours(10, false))) {
    if (std::abs(pose.x - 1.3) < 0.025 || std::abs(pose.x - 2) < 0.025) continue;
    EXPECT_GT(pose.blend.maxCoeff(), 0.99) << "at " << pose.x;
  }
}

// Figures 2a and 2b. Half way between two examples the mix is what the widths ask for. Near an
// example eq. 10 costs least at the example itself, stretched (square_test.cpp proves it), and
// where a mix becomes cheaper the weights move by up to a quarter at once: the paper's energy with
// roots is continuous only where it is strictly convex (section 4).
TEST_F(FiguresTest, Ours_MovesByNoMoreThanAQuarterAtOnce) {
  for (const bool rotations : {false, true}) {
    state_->ResetToRest();
    const Vector<Pose> poses = Drag(1, 2.6, 0.01, Ours(0.5f, rotations));
    EXPECT_LT(LargestStep(poses), 0.26) << "rotations " << rotations;
    for (const Pose& pose : poses) {
      if (std::abs(pose.x - 1.3) > 0.15 && std::abs(pose.x - 2) > 0.2) continue;
      EXPECT_LT((pose.blend - PiecewiseLinear(pose.x)).cwiseAbs().maxCoeff(), 1e-3)
          << "rotations " << rotations << ", at " << pose.x;
    }
  }
}

// Strictly convex, so continuous: the curves' steps shrink with the drag's.
TEST_F(FiguresTest, OursWithoutRoots_IsContinuous) {
  PoseOptions options = Ours(0.5f, false);
  options.square_roots = false;
  for (const double step : {0.01, 0.001}) {
    state_->ResetToRest();
    EXPECT_LT(LargestStep(Drag(1, 2.6, step, options)), 4 * step) << "step " << step;
  }
}

}  // namespace
}  // namespace limber
