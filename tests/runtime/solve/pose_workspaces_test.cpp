// States that borrow their scratch memory give what states of their own give, in less memory.
#include "solve/pose_workspaces.h"

#include "bench/made_character.h"
#include "bench/quick_bake.h"
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "support/counting_allocator.h"

#include <cmath>
#include <functional>
#include <thread>

namespace limber {
namespace {

class PoseWorkspacesTest : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    rig_ = test::BakeInMemory(GetParam() ? test::MakeStretchSquare(9)
                                         : test::MakeBendCylinder(12, 16));
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
    workspaces_ = std::make_shared<PoseWorkspaces>(model_, PoseRoom());
    first_ = model_->pinned_handles.front();
    last_ = model_->pinned_handles.back();
  }

  PoseState Own() const { return PoseState::Create(model_).value(); }

  PoseState Borrowing() const { return PoseState::Create(workspaces_).value(); }

  // A wobble of the last handle that differs by `phase`.
  void SetTarget(int frame, float phase, PoseState* state) const {
    const float t = 0.1f * static_cast<float>(frame) + phase, size = 0.3f * rig_->diagonal();
    const Vec3 rest = rig_->tables().handles[static_cast<size_t>(last_)].rest_position;
    const float z = rig_->dimension() == 2 ? 0 : 0.3f * size * std::sin(3 * t);
    ASSERT_TRUE(state
                    ->SetTarget(last_, {rest.x + size * std::sin(t),
                                        rest.y + size * std::cos(2 * t), rest.z + z})
                    .ok());
  }

  static void ExpectSame(const PoseState& own, const PoseState& borrowing, int frame) {
    const auto one = own.transforms().matrices, other = borrowing.transforms().matrices;
    ASSERT_TRUE(std::equal(one.begin(), one.end(), other.begin())) << "frame " << frame;
    const auto blend = own.blend_weights(), lent = borrowing.blend_weights();
    ASSERT_TRUE(std::equal(blend.begin(), blend.end(), lent.begin())) << "frame " << frame;
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
  std::shared_ptr<PoseWorkspaces> workspaces_;
  int first_ = -1, last_ = -1;
};

// Three states take turns on one alternation, each beside one of its own.
TEST_P(PoseWorkspacesTest, StatesInTurn_GiveTheBitsOfTheirOwn) {
  Vector<PoseState> own, borrowing;
  for (int i = 0; i < 3; ++i) {
    own.push_back(Own());
    borrowing.push_back(Borrowing());
  }
  PoseReport mine, lent;
  for (int frame = 0; frame < 120; ++frame) {
    for (size_t i = 0; i < own.size(); ++i) {
      PoseOptions options;
      options.iterations = 1 + frame % 3;
      options.square_roots = frame / 40 != 1;
      SetTarget(frame, static_cast<float>(i), &own[i]);
      SetTarget(frame, static_cast<float>(i), &borrowing[i]);
      ASSERT_TRUE(own[i].Solve(options, &mine).ok());
      ASSERT_TRUE(borrowing[i].Solve(options, frame % 2 == 0 ? &lent : nullptr).ok());
      ExpectSame(own[i], borrowing[i], frame);
      if (frame % 2 == 0) {
        EXPECT_EQ(mine.energy, lent.energy);
      }
    }
  }
  own[0].ResetToRest();
  borrowing[0].ResetToRest();
  ExpectSame(own[0], borrowing[0], -1);
}

// Everything that may hold a character, on and off, with smoothing and a stretch limit.
TEST_P(PoseWorkspacesTest, ChangingHolds_GiveTheBitsOfTheirOwn) {
  PoseState own = Own(), borrowing = Borrowing(), other = Borrowing();
  int grab[2] = {-1, -1};
  const auto both = [&](const std::function<Status(PoseState*, int*)>& call) {
    const Status one = call(&own, &grab[0]), two = call(&borrowing, &grab[1]);
    EXPECT_EQ(one.code(), two.code()) << one.message();
    EXPECT_TRUE(one.ok()) << one.message();
  };
  for (int frame = 0; frame < 160; ++frame) {
    if (frame == 20) both([&](PoseState* s, int*) { return s->SetStiffness(last_, 30); });
    if (frame == 40)
      both([&](PoseState* s, int*) { return s->SetRotation(first_, {0, 0, 0.2f, 1}, 10); });
    if (frame == 60) {
      both([&](PoseState* s, int* id) {
        const Result<int> made = s->Grab({{0, 0, 0}, {1, 0, 0}}, 50);
        if (made.ok()) *id = *made;
        return made.status();
      });
    }
    if (frame == 80) both([&](PoseState* s, int*) { return s->ClearRotation(first_); });
    if (frame == 100) both([&](PoseState* s, int* id) { return s->Release(*id); });
    if (frame == 120)
      both([&](PoseState* s, int*) { return s->SetStiffness(last_, kHeldExactly); });
    PoseOptions options;
    options.stretch_limit = frame / 30 % 2 == 1 ? 1.1 : 0;
    options.smoothing = frame / 25 % 2 == 1 ? 0.05 : 0;
    options.time_step = 1.0 / 60;
    SetTarget(frame, 0, &own);
    SetTarget(frame, 0, &borrowing);
    SetTarget(frame, 1, &other);
    ASSERT_TRUE(other.Solve({}, nullptr).ok());
    ASSERT_TRUE(own.Solve(options, nullptr).ok());
    ASSERT_TRUE(borrowing.Solve(options, nullptr).ok());
    ExpectSame(own, borrowing, frame);
  }
}

// Without rotations the convex step keeps its matrices from frame to frame, which a lent one
// cannot: the sums then run in another order.
TEST_P(PoseWorkspacesTest, WithoutRotations_AgreeToRounding) {
  PoseState own = Own(), borrowing = Borrowing();
  PoseOptions options;
  options.rotations = false;
  for (int frame = 0; frame < 60; ++frame) {
    SetTarget(frame, 0, &own);
    SetTarget(frame, 0, &borrowing);
    ASSERT_TRUE(own.Solve(options, nullptr).ok());
    ASSERT_TRUE(borrowing.Solve(options, nullptr).ok());
    const auto one = own.blend_weights(), other = borrowing.blend_weights();
    for (size_t i = 0; i < one.size(); ++i)
      ASSERT_NEAR(one[i], other[i], 1e-6) << "frame " << frame;
  }
}

TEST_P(PoseWorkspacesTest, ManyThreads_GiveTheSameBits) {
  constexpr int kFrames = 150;
  const auto play = [&](float phase, PoseState* state) {
    for (int frame = 0; frame < kFrames; ++frame) {
      SetTarget(frame, phase, state);
      EXPECT_TRUE(state->Solve({}, nullptr).ok());
    }
  };
  PoseState a = Borrowing(), b = Borrowing(), c = Borrowing(), expected = Own();
  std::thread one([&] { play(1, &a); }), two([&] { play(1, &b); });
  play(1, &c);
  one.join();
  two.join();
  play(1, &expected);
  ExpectSame(expected, a, kFrames);
  ExpectSame(expected, b, kFrames);
  ExpectSame(expected, c, kFrames);
}

TEST_P(PoseWorkspacesTest, SteadyFrames_AllocateNothing) {
  PoseState one = Borrowing(), two = Borrowing();
  ASSERT_TRUE(one.SetStiffness(last_, 30).ok());
  PoseOptions options;
  options.smoothing = options.time_step = 0.02;
  options.stretch_limit = 1.2;
  ASSERT_TRUE(one.Solve(options, nullptr).ok() && two.Solve(options, nullptr).ok());
  const int64_t before = test::AllocationCount();
  for (int frame = 0; frame < 20; ++frame) {
    SetTarget(frame, 0, &one);
    (void)one.Unpin(first_);
    (void)one.Solve(options, nullptr);
    (void)one.Pin(first_);
    (void)one.Solve(options, nullptr);
    (void)two.Solve(options, nullptr);
  }
  EXPECT_EQ(test::AllocationCount() - before, 0);
}

TEST_P(PoseWorkspacesTest, WrongRoom_IsRefused) {
  PoseRoom room;
  room.grabs = PoseRoom().grabs + 1;
  EXPECT_EQ(PoseState::Create(workspaces_, room).status().code(), StatusCode::kInvalidArgument);
  room = {};
  room.guaranteed = true;
  EXPECT_EQ(PoseState::Create(workspaces_, room).status().code(), StatusCode::kInvalidArgument);
  room = {};
  room.rotations = -1;
  EXPECT_EQ(PoseState::Create(workspaces_, room).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(PoseState::Create(std::shared_ptr<PoseWorkspaces>()).status().code(),
            StatusCode::kInvalidArgument);
}

INSTANTIATE_TEST_SUITE_P(Characters, PoseWorkspacesTest, testing::Bool(), [](const auto& tested) {
  return std::string(tested.param ? "Square" : "Cylinder");
});

// The `face` of the benchmarks: nine handles, six shapes.
TEST(PoseWorkspacesMemory, OfAFace_IsWithin64KiBACharacter) {
  const bake::RawCharacter raw = bench::MakeRawCharacter({800, 9, 6});
  auto baked = bench::BakeQuickly(raw, raw.marked_handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  const auto rig = Rig::Create("face", std::move(baked->tables), std::move(baked->mesh));
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  const auto workspaces =
      std::make_shared<PoseWorkspaces>(PoseModel::Create(*rig).value(), PoseRoom());
  const PoseState first = PoseState::Create(workspaces).value();
  const int64_t before = test::AllocatedBytes();
  const PoseState second = PoseState::Create(workspaces).value();
  const int64_t bytes = test::AllocatedBytes() - before;
  std::printf("a character at the size of a face: %lld bytes\n", static_cast<long long>(bytes));
  EXPECT_GT(bytes, 20 * 1024);
  EXPECT_LE(bytes, 64 * 1024);
}

}  // namespace
}  // namespace limber
