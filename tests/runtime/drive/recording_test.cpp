// What was recorded is what is replayed; damaged recordings are refused by byte.
#include "core/vector.h"
#include "drive/input_recorder.h"
#include "drive/input_replay.h"
#include "drive/rig_hash.h"
#include "drive_fixture.h"

#include <random>

namespace limber::test {
namespace {

constexpr int kFrames = 40;

class Recording : public ::testing::Test {
 protected:
  void SetUp() override {
    rig_ = LoadTube();
    ASSERT_NE(rig_, nullptr);
  }

  PoseState MakeState() const {
    auto state = PoseState::Create(rig_);
    EXPECT_TRUE(state.ok());
    return std::move(*state);
  }

  // Asks and records it, as the C interface does.
  void Ask(InputEvent event, PoseState* state, InputRecorder* recorder) {
    int grab = 0;
    const Status asked = ApplyInput(event, state, &grab);
    ASSERT_TRUE(asked.ok()) << asked.message();
    if (event.kind == InputKind::kGrab) event.index = last_grab_ = grab;
    if (event.kind == InputKind::kSolve) {
      event.iterations = event.options.iterations;
      event.pose_hash = HashPose(state->transforms());
      hashes_.push_back(event.pose_hash);
    }
    recorder->Add(event);
  }

  InputEvent Event(InputKind kind, int index, float number = 0) {
    InputEvent event;
    event.kind = kind;
    event.index = index;
    event.number = number;
    return event;
  }

  // Forty frames in which everything happens that can be asked.
  Vector<uint8_t> Record() {
    PoseState state = MakeState();
    InputRecorder recorder({HashRig(*rig_), PoseRoom()});
    const int right = rig_->FindHandle("right"), middle = rig_->FindHandle("middle_top");
    for (int frame = 0; frame < kFrames; ++frame) {
      InputEvent target = Event(InputKind::kTarget, right);
      const Vec3 rest = rig_->tables().handles[static_cast<size_t>(right)].rest_position;
      target.position = {rest.x, rest.y + 0.02f * static_cast<float>(frame), rest.z};
      Ask(target, &state, &recorder);
      if (frame == 5) Ask(Event(InputKind::kUnpin, middle), &state, &recorder);
      if (frame == 9) {
        InputEvent turn = Event(InputKind::kRotation, right, 10);
        turn.rotation = {0, 0.1f, 0, 0.995f};
        Ask(turn, &state, &recorder);
      }
      if (frame == 12) {
        InputEvent grab = Event(InputKind::kGrab, 0, kHeldExactly);
        grab.point.vertices = {100, 101, 120};
        grab.point.weights = {0.25f, 0.25f, 0.5f};
        Ask(grab, &state, &recorder);
        InputEvent pull = Event(InputKind::kGrabTarget, last_grab_);
        pull.position = {0, 0.4f, 0.1f};
        Ask(pull, &state, &recorder);
      }
      if (frame == 20) Ask(Event(InputKind::kRelease, last_grab_), &state, &recorder);
      if (frame == 22) Ask(Event(InputKind::kStiffness, right, 50), &state, &recorder);
      if (frame == 23) Ask(Event(InputKind::kWeight, right, 2), &state, &recorder);
      if (frame == 25) Ask(Event(InputKind::kClearRotation, right), &state, &recorder);
      if (frame == 28) Ask(Event(InputKind::kPin, middle), &state, &recorder);
      if (frame == 35) Ask(Event(InputKind::kResetToRest, 0), &state, &recorder);
      InputEvent solve;
      solve.options.iterations = frame < 15 ? 1 : 3;
      solve.options.smoothing = frame > 30 ? 0.05 : 0;
      solve.options.time_step = 1.0 / 60;
      Ask(solve, &state, &recorder);
    }
    return {recorder.bytes().begin(), recorder.bytes().end()};
  }

  // The first failure, or success at the end.
  Status ReplayAll(std::span<const uint8_t> bytes, int* frames, int* different) {
    auto replay = InputReplay::Create(*rig_, bytes);
    if (!replay.ok()) return replay.status();
    PoseState state = MakeState();
    for (*frames = *different = 0;; ++*frames) {
      bool same = false;
      const Result<bool> more = ReplayFrame(&*replay, &state, &same);
      if (!more.ok()) return more.status();
      if (!*more) return {};
      *different += same ? 0 : 1;
    }
  }

  std::shared_ptr<const Rig> rig_;
  Vector<uint64_t> hashes_;
  int last_grab_ = -1;
};

TEST_F(Recording, Replayed_HasTheSameBits) {
  const Vector<uint8_t> bytes = Record();
  ASSERT_EQ(hashes_.size(), size_t{kFrames});
  for (size_t i = 1; i < 30; ++i)
    ASSERT_NE(hashes_[i], hashes_[i - 1]) << "nothing moved";
  int frames = 0, different = 0;
  const Status status = ReplayAll(bytes, &frames, &different);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(frames, kFrames);
  EXPECT_EQ(different, 0);
  EXPECT_LT(bytes.size(), 50u * kFrames);
}

TEST_F(Recording, AnotherTarget_IsNoticed) {
  Vector<uint8_t> bytes = Record();
  // The first event's y, behind head (8 + 8 + 9), kind and handle.
  bytes[25 + 1 + 4 + 4 + 3] ^= 0x3F;  // 0 becomes 0.5
  int frames = 0, different = 0;
  EXPECT_TRUE(ReplayAll(bytes, &frames, &different).ok());
  EXPECT_GT(different, 0);
}

TEST_F(Recording, CutAnywhere_EndsAtAnEventOrIsRefused) {
  const Vector<uint8_t> bytes = Record();
  int whole = 0, refused = 0;
  for (size_t size = 0; size < bytes.size(); size += 3) {
    int frames = 0, different = 0;
    const Status status = ReplayAll(std::span(bytes).first(size), &frames, &different);
    EXPECT_EQ(different, 0);
    (status.ok() ? whole : refused) += 1;
    if (status.ok()) continue;
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << status.message();
    EXPECT_NE(status.message().find("byte"), std::string::npos);
  }
  EXPECT_GT(whole, 5);
  EXPECT_GT(refused, 100);
}

TEST_F(Recording, DamagedAnywhere_NeverCrashes) {
  const Vector<uint8_t> bytes = Record();
  std::mt19937 random(3);
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    Vector<uint8_t> damaged = bytes;
    for (int i = 0; i < 3; ++i)
      damaged[random() % 700] = static_cast<uint8_t>(random());
    int frames = 0, different = 0;
    refused += ReplayAll(damaged, &frames, &different).ok() ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
}

TEST_F(Recording, OtherBakesAndOtherFiles_AreRefusedByName) {
  Vector<uint8_t> bytes = Record();
  const auto square = LoadRig(std::string(LIMBER_SOURCE_DIR) + "/content/baked/v3/square.glb");
  ASSERT_TRUE(square.ok());
  EXPECT_EQ(InputReplay::Create(**square, bytes).status().code(), StatusCode::kMeshMismatch);
  bytes[7] = '7';
  EXPECT_EQ(InputReplay::Create(*rig_, bytes).status().code(), StatusCode::kVersionMismatch);
  bytes[0] = 'X';
  EXPECT_EQ(InputReplay::Create(*rig_, bytes).status().code(), StatusCode::kMalformed);
  EXPECT_EQ(InputReplay::Create(*rig_, {}).status().code(), StatusCode::kMalformed);
}

}  // namespace
}  // namespace limber::test
