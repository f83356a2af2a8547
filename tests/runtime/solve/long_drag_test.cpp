// Thousands of frames of whatever a player does: nothing breaks, nothing drifts, nothing jumps.
#include "runtime/solve/solved_character.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "support/counting_allocator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <thread>

namespace limber {
namespace {

constexpr int kFrames = 10000;

// Targets that wander: each coordinate a sum of slow waves with frequencies and phases of its own.
class Wanderer {
 public:
  Wanderer(const Rig& rig, unsigned seed, float reach) : rig_(rig), reach_(reach * rig.diagonal()) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<float> phase(0, 6.28f), speed(0.004f, 0.03f);
    for (int i = 0; i < rig.num_handles() * 3 * kWaves; ++i) {
      phases_.push_back(phase(engine));
      speeds_.push_back(speed(engine));
    }
  }

  Vec3 At(int handle, float frame) const {
    Vec3 target = rig_.tables().handles[static_cast<size_t>(handle)].rest_position;
    const int axes = rig_.dimension();
    for (int axis = 0; axis < axes; ++axis) {
      for (int wave = 0; wave < kWaves; ++wave) {
        const auto i = static_cast<size_t>((handle * 3 + axis) * kWaves + wave);
        target[axis] +=
            reach_ / kWaves * (std::sin(phases_[i] + frame * speeds_[i]) - std::sin(phases_[i]));
      }
    }
    return target;
  }

 private:
  static constexpr int kWaves = 3;
  const Rig& rig_;
  float reach_;
  std::vector<float> phases_, speeds_;
};

struct Case {
  const char* name;
  PoseOptions options;
  bool bake_rotations = true;
  int shapes = 3;
};

std::vector<Case> Cases() {
  std::vector<Case> cases = {{"Rotations", {}, true, 3},     {"HeldRotations", {}, true, 3},
                             {"BakedWithout", {}, false, 3}, {"NoSquareRoots", {}, true, 3},
                             {"UniformBlend", {}, true, 3},  {"OneShape", {}, true, 1}};
  cases[1].options.rotations = cases[2].options.rotations = false;
  cases[3].options.square_roots = false;
  cases[4].options.varying_blend = false;
  return cases;
}

class LongDragTest : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    bake::RawCharacter raw = test::MakeBendCylinder(12, 16);
    raw.shapes.resize(static_cast<size_t>(GetParam().shapes));
    raw.shape_names.resize(static_cast<size_t>(GetParam().shapes));
    bake::BakeOptions options;
    options.rotations = GetParam().bake_rotations;
    rig_ = test::BakeInMemory(raw, options);
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
  }

  PoseState MakeState() const { return PoseState::Create(model_).value(); }

  void SetTargets(const std::function<Vec3(int)>& target, PoseState* state) const {
    for (const int handle : model_->pins->handles)
      ASSERT_TRUE(state->SetTarget(handle, target(handle)).ok());
  }

  void Solve(PoseState* state) const {
    ASSERT_TRUE(state->Solve(GetParam().options, nullptr).ok());
  }

  // Finite transforms; weights of every group not negative, their sum one.
  void ExpectSound(const PoseState& state, int frame) const {
    for (const float value : state.transforms().matrices)
      ASSERT_TRUE(std::isfinite(value)) << "frame " << frame;
    const auto shapes = static_cast<size_t>(rig_->num_shapes());
    for (size_t g = 0; g < static_cast<size_t>(rig_->num_groups()); ++g) {
      double sum = 0;
      for (size_t s = 0; s < shapes; ++s) {
        ASSERT_GE(state.blend_weights()[g * shapes + s], 0) << "frame " << frame;
        sum += state.blend_weights()[g * shapes + s];
      }
      ASSERT_NEAR(sum, 1, 1e-9) << "frame " << frame;
    }
  }

  double LargestMotion(const std::vector<Eigen::Vector3d>& from,
                       const std::vector<Eigen::Vector3d>& to) const {
    double largest = 0;
    for (size_t v = 0; v < from.size(); ++v)
      largest = std::max(largest, (to[v] - from[v]).norm());
    return largest / static_cast<double>(rig_->diagonal());
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
};

TEST_P(LongDragTest, WanderingTargets_StaySoundAndAllocateNothing) {
  PoseState state = MakeState();
  const Wanderer wanderer(*rig_, 3, 0.4f);
  SetTargets([&](int handle) { return wanderer.At(handle, 0); }, &state);
  Solve(&state);
  int64_t allocations = 0;
  for (int frame = 1; frame < kFrames; ++frame) {
    const int64_t before = test::AllocationCount();
    for (const int handle : model_->pins->handles)
      (void)state.SetTarget(handle, wanderer.At(handle, static_cast<float>(frame)));
    (void)state.Solve(GetParam().options, nullptr);
    allocations += test::AllocationCount() - before;
    ExpectSound(state, frame);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(allocations, 0);
}

// Ten sizes away, all on one point, back: finite throughout, and afterwards as if it had not been.
TEST_P(LongDragTest, FarAndCoincidingTargets_LeaveNoTrace) {
  PoseState state = MakeState(), fresh = MakeState();
  const Wanderer far(*rig_, 5, 10.0f);
  for (int frame = 0; frame < 1000; ++frame) {
    SetTargets([&](int handle) { return far.At(handle, static_cast<float>(frame)); }, &state);
    Solve(&state);
    ExpectSound(state, frame);
    if (HasFatalFailure()) return;
  }
  const Vec3 point = rig_->tables().handles[0].rest_position;
  for (int frame = 0; frame < 200; ++frame) {
    SetTargets([&](int) { return point; }, &state);
    Solve(&state);
    ExpectSound(state, frame);
    if (HasFatalFailure()) return;
  }
  state.ResetToRest();
  const auto was = test::SkinNaively(*rig_, fresh.transforms());
  EXPECT_EQ(LargestMotion(was, test::SkinNaively(*rig_, state.transforms())), 0);
}

// At rest a character rests: after it has settled, thousands of frames do not move it.
TEST_P(LongDragTest, TargetsThatDoNotMove_NoDrift) {
  PoseState state = MakeState();
  const Wanderer wanderer(*rig_, 7, 0.3f);
  for (int frame = 0; frame < 200; ++frame) {
    SetTargets([&](int handle) { return wanderer.At(handle, static_cast<float>(frame)); }, &state);
    Solve(&state);
  }
  for (int frame = 0; frame < 5000; ++frame)
    Solve(&state);
  const auto settled = test::SkinNaively(*rig_, state.transforms());
  for (int frame = 0; frame < 5000; ++frame)
    Solve(&state);
  EXPECT_LT(LargestMotion(settled, test::SkinNaively(*rig_, state.transforms())), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Modes, LongDragTest, testing::ValuesIn(Cases()),
                         [](const auto& tested) { return std::string(tested.param.name); });

// FNV-1a of everything that a frame gives, over a session of drags, jumps and resets.
uint64_t HashOfSession(const std::shared_ptr<const PoseModel>& model) {
  PoseState state = PoseState::Create(model).value();
  const Wanderer wanderer(*model->rig, 11, 0.5f);
  uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i)
      hash = (hash ^ bytes[i]) * 1099511628211ull;
  };
  for (int frame = 0; frame < 400; ++frame) {
    if (frame % 150 == 149) state.ResetToRest();
    const int place = frame % 40 == 39 ? frame * 17 : frame;  // now and then a jump
    for (const int handle : model->pins->handles)
      (void)state.SetTarget(handle, wanderer.At(handle, static_cast<float>(place)));
    (void)state.Solve({}, nullptr);
    const std::span<const float> matrices = state.transforms().matrices;
    add(matrices.data(), matrices.size_bytes());
    add(state.blend_weights().data(), state.blend_weights().size_bytes());
  }
  return hash;
}

TEST(SessionHash, AgainAndOnManyThreads_IsTheSame) {
  const std::shared_ptr<const Rig> rig = test::BakeInMemory(test::MakeBendCylinder(12, 16));
  ASSERT_NE(rig, nullptr);
  const std::shared_ptr<const PoseModel> model = PoseModel::Create(rig).value();
  const uint64_t expected = HashOfSession(model);
  EXPECT_EQ(HashOfSession(PoseModel::Create(rig).value()), expected);
  std::vector<uint64_t> hashes(5);
  std::vector<std::thread> threads;
  for (uint64_t& hash : hashes)
    threads.emplace_back([&hash, &model] { hash = HashOfSession(model); });
  for (std::thread& thread : threads)
    thread.join();
  for (const uint64_t hash : hashes)
    EXPECT_EQ(hash, expected);
}

}  // namespace
}  // namespace limber
