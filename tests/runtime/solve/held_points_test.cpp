// What is held, and how: pins that come and go, soft targets, handles that are turned, points of
// the skin that are grabbed.
#include "core/rotation_fit.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "support/counting_allocator.h"

#include <Eigen/Geometry>

#include <limits>

namespace limber {
namespace {

using Eigen::Vector3d;

Vector3d ToEigen(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 FromEigen(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Quaternion FromEigen(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

struct Case {
  const char* name;
  int shapes = 3;
  bool is_square = false;  // k = 2; else the cylinder
  bool rotations = true;
};

class HeldPoints : public testing::Test {
 protected:
  void Make(const Case& character) {
    bake::RawCharacter raw =
        character.is_square ? test::MakeStretchSquare(8) : test::MakeBendCylinder(12, 16);
    raw.shapes.resize(static_cast<size_t>(character.shapes));
    raw.shape_names.resize(static_cast<size_t>(character.shapes));
    rig_ = test::BakeInMemory(raw);
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
    moved_ = rig_->FindHandle(character.is_square ? "right" : "top");
    other_ = rig_->FindHandle(character.is_square ? "left" : "bottom");
    options_.rotations = character.rotations;
    options_.iterations = 20000;
    options_.settle_tolerance = 1e-10;
  }

  PoseState MakeState(PoseRoom room = {}) const { return PoseState::Create(model_, room).value(); }

  PoseReport Settle(PoseState* state) const {
    PoseReport report;
    EXPECT_TRUE(state->Solve(options_, &report).ok());
    return report;
  }

  SkinPoint HandlePoint(int handle) const {
    const uint32_t v = rig_->tables().handles[static_cast<size_t>(handle)].vertex;
    return {{v, v, v}, {1, 0, 0}};
  }

  // A triangle's middle, far from the handles.
  SkinPoint SomePoint() const {
    const SkinMesh& mesh = rig_->mesh();
    SkinPoint point;
    for (size_t corner = 0; corner < 3; ++corner)
      point.vertices[corner] =
          mesh.solve_vertex[mesh.triangles[mesh.triangles.size() / 6 * 3 + corner]];
    point.weights = {0.5f, 0.3f, 0.2f};
    return point;
  }

  double Distance(Vec3 a, Vec3 b) const {
    return (ToEigen(a) - ToEigen(b)).norm() / static_cast<double>(rig_->diagonal());
  }

  Vec3 Moved(Vec3 from, double x, double y) const {
    return FromEigen(ToEigen(from) + static_cast<double>(rig_->diagonal()) * Vector3d(x, y, 0));
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
  PoseOptions options_;
  int moved_ = -1, other_ = -1;
};

class HeldPointsTest : public HeldPoints, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override { Make(GetParam()); }
};

// Where R is solved for.
class TurningHeldPointsTest : public HeldPointsTest {};

double LargestDifference(std::span<const float> a, std::span<const float> b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(double{a[i]} - double{b[i]}));
  return largest;
}

TEST_P(HeldPointsTest, Place_IsWhereSkinningPutsThePoint) {
  PoseState state = MakeState();
  ASSERT_TRUE(state.SetTarget(moved_, Moved(state.target(moved_), 0.1, 0.2)).ok());
  Settle(&state);
  const auto q = test::SkinNaively(*rig_, state.transforms());
  const SkinPoint point = SomePoint();
  Vector3d expected = Vector3d::Zero();
  for (size_t i = 0; i < 3; ++i)
    expected += double{point.weights[i]} * q[point.vertices[i]];
  EXPECT_LT((ToEigen(state.Place(point)) - expected).norm(), 1e-6);
  EXPECT_LT(Distance(state.Place(HandlePoint(moved_)), state.target(moved_)), 1e-5);
}

TEST_P(HeldPointsTest, UnpinnedAndPinnedAgain_IsTheSame) {
  PoseState state = MakeState(), untouched = MakeState();
  const Vec3 target = Moved(state.target(moved_), 0.05, 0.15);
  for (PoseState* each : {&state, &untouched})
    ASSERT_TRUE(each->SetTarget(moved_, target).ok());
  ASSERT_TRUE(state.Unpin(moved_).ok());
  EXPECT_FALSE(state.is_pinned(moved_));
  EXPECT_EQ(state.SetTarget(moved_, target).code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(state.Pin(moved_).ok());
  ASSERT_TRUE(state.SetTarget(moved_, target).ok());
  Settle(&state);
  Settle(&untouched);
  EXPECT_EQ(LargestDifference(state.transforms().matrices, untouched.transforms().matrices), 0);
}

// With one handle left the character hangs on it, undeformed.
TEST_P(HeldPointsTest, OneHandleLeft_CostsNothing) {
  PoseState state = MakeState();
  ASSERT_TRUE(state.SetTarget(moved_, Moved(state.target(moved_), 0.2, 0.3)).ok());
  Settle(&state);
  for (int h = 0; h < rig_->num_handles(); ++h) {
    if (h == moved_) continue;
    ASSERT_TRUE(state.Unpin(h).ok());
  }
  const PoseReport report = Settle(&state);
  EXPECT_LT(report.elastic, 1e-4 * double{rig_->diagonal()});
  EXPECT_LT(Distance(state.Place(HandlePoint(moved_)), state.target(moved_)), 1e-5);
}

TEST_P(HeldPointsTest, NothingHeld_IsRefusedAndNamed) {
  PoseState state = MakeState();
  for (int h = 0; h < rig_->num_handles(); ++h)
    ASSERT_TRUE(state.Unpin(h).ok());
  EXPECT_EQ(state.Solve({}, nullptr).code(), StatusCode::kNoHandles);
  ASSERT_TRUE(state.Pin(other_).ok());
  EXPECT_TRUE(state.Solve(options_, nullptr).ok());
}

// A handle takes hold where it is, so nothing moves.
TEST_P(HeldPointsTest, PinWhereItIs_ChangesNothing) {
  PoseState state = MakeState();
  ASSERT_TRUE(state.Unpin(moved_).ok());
  ASSERT_TRUE(state.SetTarget(other_, Moved(state.target(other_), 0.1, 0.05)).ok());
  const double before_energy = Settle(&state).energy;
  const auto before = test::SkinNaively(*rig_, state.transforms());
  ASSERT_TRUE(state.Pin(moved_).ok());
  EXPECT_NEAR(Settle(&state).energy, before_energy, 2e-6 * double{rig_->diagonal()});
  const auto after = test::SkinNaively(*rig_, state.transforms());
  for (size_t v = 0; v < before.size(); ++v)
    EXPECT_LT((after[v] - before[v]).norm(), 1e-4 * double{rig_->diagonal()});
}

TEST_P(HeldPointsTest, SoftTarget_PullsBetweenNothingAndExactly) {
  PoseState state = MakeState();
  const Vec3 target = Moved(state.target(moved_), 0.6, 0.1);
  ASSERT_TRUE(state.SetTarget(moved_, target).ok());
  double last = 1e300;
  for (const float stiffness : {1e-3f, 1e-2f, 1e-1f, 1.0f, 1e1f, 1e2f, 1e4f, 1e6f}) {
    ASSERT_TRUE(state.SetStiffness(moved_, stiffness).ok());
    Settle(&state);
    const double gap = Distance(state.Place(HandlePoint(moved_)), target);
    EXPECT_LT(gap, last) << stiffness;
    last = gap;
  }
  EXPECT_LT(last, 1e-5);
}

// The force of the spring on the point balances the skin: moving the point from its place costs
// more, whichever way. (An exact hold there has the energy of the soft one less the spring's.)
// Without rotations, where there is one minimum.
TEST_F(HeldPoints, SoftTarget_IsTheMinimumOverExactOnes) {
  Make({"HeldRotations", 3, false, false});
  PoseState soft = MakeState();
  const Vec3 target = Moved(soft.target(moved_), 0.5, 0.2);
  const float stiffness = 0.7f;
  ASSERT_TRUE(soft.SetTarget(moved_, target).ok());
  ASSERT_TRUE(soft.SetStiffness(moved_, stiffness).ok());
  options_.lambda = 0;
  options_.square_roots = false;
  const double least = Settle(&soft).energy;
  const Vec3 place = soft.Place(HandlePoint(moved_));
  const auto energy_at = [&](double dx, double dy) {
    PoseState exact = MakeState();
    const Vec3 there = Moved(place, dx, dy);
    EXPECT_TRUE(exact.SetTarget(moved_, there).ok());
    const double gap = Distance(there, target) * double{rig_->diagonal()};
    return Settle(&exact).energy + 0.5 * double{stiffness} * gap * gap;
  };
  EXPECT_NEAR(energy_at(0, 0), least, 1e-4 * least);
  for (const auto& [dx, dy] : {std::pair{0.02, 0.0}, {-0.02, 0.0}, {0.0, 0.02}, {0.0, -0.02}})
    EXPECT_GT(energy_at(dx, dy), least * (1 + 1e-6));
}

TEST_P(HeldPointsTest, Grab_HoldsAnyPointOfTheSkin) {
  PoseState state = MakeState();
  const SkinPoint point = SomePoint();
  Result<int> grab = state.Grab(point);
  ASSERT_TRUE(grab.ok()) << grab.status().message();
  const Vec3 target = Moved(state.Place(point), 0.08, 0.05);
  ASSERT_TRUE(state.SetGrabTarget(*grab, target).ok());
  Settle(&state);
  EXPECT_LT(Distance(state.Place(point), target), 2e-5);
  EXPECT_LT(Distance(state.Place(HandlePoint(moved_)), state.target(moved_)), 2e-5);
  ASSERT_TRUE(state.Release(*grab).ok());
  EXPECT_EQ(state.Release(*grab).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetGrabTarget(*grab, target).code(), StatusCode::kInvalidArgument);
  const Result<int> next = state.Grab(point);
  ASSERT_TRUE(next.ok());
  EXPECT_NE(*next, *grab);
}

// A grab at a handle's vertex is that handle, pinned.
TEST_P(HeldPointsTest, GrabOfAHandlesVertex_IsThePin) {
  PoseState pinned = MakeState(), grabbed = MakeState();
  ASSERT_TRUE(grabbed.Unpin(moved_).ok());
  const Result<int> grab = grabbed.Grab(HandlePoint(moved_));
  ASSERT_TRUE(grab.ok()) << grab.status().message();
  const Vec3 target = Moved(pinned.target(moved_), 0.1, 0.2);
  ASSERT_TRUE(pinned.SetTarget(moved_, target).ok());
  ASSERT_TRUE(grabbed.SetGrabTarget(*grab, target).ok());
  EXPECT_NEAR(Settle(&pinned).energy, Settle(&grabbed).energy, 1e-5 * double{rig_->diagonal()});
  const auto a = test::SkinNaively(*rig_, pinned.transforms());
  const auto b = test::SkinNaively(*rig_, grabbed.transforms());
  for (size_t v = 0; v < a.size(); ++v)
    EXPECT_LT((a[v] - b[v]).norm(), 1e-4 * double{rig_->diagonal()});
}

// Targets and the rotation that a rigid motion asks for cost nothing and give that motion.
TEST_P(TurningHeldPointsTest, RotationThatFitsTheTargets_TurnsTheWholeCharacter) {
  PoseState state = MakeState();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
  const Vector3d centre = ToEigen(state.target(moved_));
  for (int h = 0; h < rig_->num_handles(); ++h) {
    if (!state.is_pinned(h)) continue;
    const Vector3d target = centre + turn * (ToEigen(state.target(h)) - centre);
    ASSERT_TRUE(state.SetTarget(h, FromEigen(target)).ok());
  }
  ASSERT_TRUE(state.SetRotation(moved_, FromEigen(turn)).ok());
  const PoseReport report = Settle(&state);
  EXPECT_LT(report.elastic, 1e-4 * double{rig_->diagonal()});
  const auto q = test::SkinNaively(*rig_, state.transforms());
  for (uint32_t v = 0; v < q.size(); ++v) {
    const Vector3d expected = centre + turn * (test::ShapePosition(*rig_, 0, v) - centre);
    EXPECT_LT((q[v] - expected).norm(), 2e-4 * double{rig_->diagonal()});
  }
  // Turned otherwise it costs something.
  const Eigen::Quaterniond more(Eigen::AngleAxisd(1.0, Vector3d::UnitZ()));
  ASSERT_TRUE(state.SetRotation(moved_, FromEigen(more)).ok());
  EXPECT_GT(Settle(&state).elastic, 1e-2 * double{rig_->diagonal()});
}

// Orientation alone is asked for: an example that stretches the patch comes back all the same.
TEST_F(HeldPoints, RotationThatAnExampleHas_LeavesTheExampleAsItIs) {
  Make({"Square", 3, true});
  for (int shape = 0; shape < rig_->num_shapes(); ++shape) {
    PoseState state = MakeState();
    for (int h = 0; h < rig_->num_handles(); ++h) {
      if (!state.is_pinned(h)) continue;
      const uint32_t vertex = rig_->tables().handles[static_cast<size_t>(h)].vertex;
      const Vector3d target = test::ShapePosition(*rig_, shape, vertex);
      ASSERT_TRUE(state.SetTarget(h, FromEigen(target)).ok());
      ASSERT_TRUE(state.SetRotation(h, Quaternion()).ok());
    }
    Settle(&state);
    const auto q = test::SkinNaively(*rig_, state.transforms());
    for (uint32_t v = 0; v < q.size(); ++v) {
      EXPECT_LT((q[v] - test::ShapePosition(*rig_, shape, v)).norm(),
                1e-3 * double{rig_->diagonal()});
    }
  }
}

// With R = I nothing but the turn itself changes from call to call.
TEST_F(HeldPoints, RotationsThatFollowEachOther_WithRHeld_EndAsTheLastAlone) {
  Make({"HeldRotations", 3, false, false});
  PoseState dragged = MakeState(), fresh = MakeState();
  const auto turn = [](double angle) {
    return FromEigen(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())));
  };
  options_.lambda = 0.1f;  // and a target at which shapes mix, in proportions that the turn changes
  for (PoseState* state : {&dragged, &fresh})
    ASSERT_TRUE(state->SetTarget(moved_, {0.5f, 1.6f, 0.1f}).ok());
  for (const double angle : {0.1, 0.3, -0.4, 0.5}) {
    ASSERT_TRUE(dragged.SetRotation(moved_, turn(angle)).ok());
    Settle(&dragged);
  }
  ASSERT_TRUE(fresh.SetRotation(moved_, turn(0.5)).ok());
  const double energy = Settle(&fresh).energy;
  ASSERT_GT(energy, 1e-3 * double{rig_->diagonal()});
  EXPECT_NEAR(Settle(&dragged).energy, energy, 1e-5 * energy);
  const auto a = test::SkinNaively(*rig_, dragged.transforms());
  const auto b = test::SkinNaively(*rig_, fresh.transforms());
  for (size_t v = 0; v < a.size(); ++v)
    EXPECT_LT((a[v] - b[v]).norm(), 1e-4 * double{rig_->diagonal()});
}

TEST_P(TurningHeldPointsTest, RotationOfAHandle_TurnsTheSkinAroundIt) {
  PoseState state = MakeState();
  // About the cylinder's axis: a twist, or the square's normal.
  const Vector3d axis = GetParam().is_square ? Vector3d::UnitZ() : Vector3d::UnitY();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, axis));
  ASSERT_TRUE(state.SetRotation(moved_, FromEigen(turn)).ok());
  Settle(&state);
  const auto q = test::SkinNaively(*rig_, state.transforms());
  const uint32_t centre = HandlePoint(moved_).vertices[0];
  // The vertices nearest to the handle, seen from it.
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const Vector3d from = test::ShapePosition(*rig_, 0, centre);
  for (uint32_t v = 0; v < q.size(); ++v) {
    const Vector3d rest = test::ShapePosition(*rig_, 0, v) - from;
    if (rest.norm() > 0.15 * double{rig_->diagonal()}) continue;
    sum += rest * (q[v] - q[centre]).transpose();
  }
  const Eigen::AngleAxisd found(FitRotation<3>(sum));
  EXPECT_GT(found.axis().dot(axis), 0.9);
  EXPECT_NEAR(found.angle(), 0.5, 0.2);
  // And back.
  ASSERT_TRUE(state.ClearRotation(moved_).ok());
  const PoseReport report = Settle(&state);
  EXPECT_LT(report.elastic, 1e-4 * double{rig_->diagonal()});
}

// Everything turned and moved together is the same pose turned and moved.
TEST_P(TurningHeldPointsTest, RigidMotionOfAllThatIsHeld_IsARigidMotionOfThePose) {
  PoseState here = MakeState(), there = MakeState();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.4, Vector3d::UnitZ()));
  const Vector3d shift(0.3, -0.2, 0);
  const auto carried = [&](Vec3 x) { return FromEigen(turn * ToEigen(x) + shift); };
  const Eigen::Quaterniond bend(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  const SkinPoint point = SomePoint();
  const Result<int> grab_here = here.Grab(point, 3.0f), grab_there = there.Grab(point, 3.0f);
  ASSERT_TRUE(grab_here.ok() && grab_there.ok());
  const Vec3 pulled = Moved(here.Place(point), 0.1, 0.1),
             to = Moved(here.target(moved_), 0.05, 0.1);
  ASSERT_TRUE(here.SetGrabTarget(*grab_here, pulled).ok());
  ASSERT_TRUE(there.SetGrabTarget(*grab_there, carried(pulled)).ok());
  ASSERT_TRUE(here.SetTarget(moved_, to).ok());
  ASSERT_TRUE(there.SetTarget(moved_, carried(to)).ok());
  ASSERT_TRUE(there.SetTarget(other_, carried(here.target(other_))).ok());
  ASSERT_TRUE(here.SetRotation(moved_, FromEigen(bend)).ok());
  ASSERT_TRUE(there.SetRotation(moved_, FromEigen(turn * bend)).ok());
  for (int h = 0; h < rig_->num_handles(); ++h) {
    if (h != moved_ && h != other_) {
      ASSERT_TRUE(here.Unpin(h).ok());
      ASSERT_TRUE(there.Unpin(h).ok());
    }
  }
  const double energy = Settle(&here).energy;
  EXPECT_NEAR(Settle(&there).energy, energy, 1e-4 * energy);
  const auto a = test::SkinNaively(*rig_, here.transforms());
  const auto b = test::SkinNaively(*rig_, there.transforms());
  for (size_t v = 0; v < a.size(); ++v)
    EXPECT_LT((turn * a[v] + shift - b[v]).norm(), 1e-3 * double{rig_->diagonal()});
}

// Holding, turning, grabbing and letting go in the middle of a game.
TEST_P(HeldPointsTest, Changes_AllocateNothing) {
  PoseState state = MakeState();
  const SkinPoint point = SomePoint();
  const auto play = [&] {
    const int grab = state.Grab(point, 5.0f).value();
    (void)state.SetGrabTarget(grab, Moved(state.Place(point), 0.1, 0));
    (void)state.SetRotation(moved_, {0, 0, 0.1f, 1});
    (void)state.SetStiffness(moved_, 20);
    (void)state.Solve({1, 0.5f, GetParam().rotations}, nullptr);
    (void)state.Unpin(other_);
    (void)state.Solve({1, 0.5f, GetParam().rotations}, nullptr);
    (void)state.Pin(other_);
    (void)state.Release(grab);
    (void)state.ClearRotation(moved_);
    (void)state.SetStiffness(moved_, kHeldExactly);
    (void)state.Solve({1, 0.5f, GetParam().rotations}, nullptr);
  };
  play();
  const int64_t before = test::AllocationCount();
  play();
  EXPECT_EQ(test::AllocationCount(), before);
}

TEST_P(HeldPointsTest, Nonsense_IsRefused) {
  PoseState state = MakeState({1, 1});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(state.Pin(-1).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.Unpin(99).code(), StatusCode::kInvalidArgument);
  for (const float stiffness : {nan, 0.0f, -1.0f, 1e-9f, 1e20f})
    EXPECT_EQ(state.SetStiffness(moved_, stiffness).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetRotation(moved_, {0, 0, 0, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetRotation(moved_, {0, nan, 0, 1}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.Grab({{1u << 30, 0, 0}, {1, 0, 0}}).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(state.Grab({{0, 0, 0}, {nan, 0, 0}}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.Grab({{0, 0, 0}, {3, 0, 0}}).status().code(), StatusCode::kInvalidArgument);
  const Result<int> grab = state.Grab(SomePoint());
  ASSERT_TRUE(grab.ok());
  EXPECT_EQ(state.Grab(SomePoint()).status().code(), StatusCode::kLimitExceeded);
  EXPECT_EQ(state.SetGrabTarget(*grab, {0, nan, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetGrabTarget(*grab + 1, {}).code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(state.SetRotation(moved_, {}).ok());
  EXPECT_EQ(state.SetRotation(other_, {}).code(), StatusCode::kLimitExceeded);
  EXPECT_EQ(PoseState::Create(model_, {-1, 0}).status().code(), StatusCode::kInvalidArgument);
}

// Two grabs of one point that pull apart meet in the middle, and nothing breaks.
TEST_P(HeldPointsTest, GrabsThatContradictEachOther_MeetInTheMean) {
  PoseState state = MakeState();
  const SkinPoint point = SomePoint();
  const Vec3 place = state.Place(point);
  for (const double x : {0.1, -0.1}) {
    const Result<int> grab = state.Grab(point);
    ASSERT_TRUE(grab.ok());
    ASSERT_TRUE(state.SetGrabTarget(*grab, Moved(place, x, 0.1)).ok());
  }
  Settle(&state);
  EXPECT_LT(Distance(state.Place(point), Moved(place, 0, 0.1)), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Characters, TurningHeldPointsTest,
                         testing::Values(Case{"Cylinder"}, Case{"OneShape", 1},
                                         Case{"Square", 3, true}),
                         [](const auto& each) { return each.param.name; });
INSTANTIATE_TEST_SUITE_P(Characters, HeldPointsTest,
                         testing::Values(Case{"Cylinder"}, Case{"OneShape", 1},
                                         Case{"HeldRotations", 3, false, false},
                                         Case{"Square", 3, true}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace limber
