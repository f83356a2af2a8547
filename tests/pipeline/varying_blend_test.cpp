// Figure 7 of the paper as a statement about numbers: two parts of a shipped character, each asked
// for an example of its own, get it when blend weights vary over the character, and do not when one
// blend has to do for all.
#include "core/vector.h"
#include "import/import_gltf.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr double kNear = 0.02;  // of the diagonal

class VaryingBlendTest : public testing::Test {
 protected:
  void SetUp() override {
    const Result<bake::RawCharacter> raw =
        bake::ImportGltf(LIMBER_SOURCE_DIR "/content/characters/fox.glb");
    ASSERT_TRUE(raw.ok()) << raw.status().message();
    rig_ = test::BakeInMemory(*raw);
    ASSERT_NE(rig_, nullptr);
    state_.emplace(PoseState::Create(rig_).value());
  }

  int FindShape(const std::string& name) const {
    const Vector<String>& names = rig_->tables().shape_names;
    const auto found = std::find(names.begin(), names.end(), String(name));
    EXPECT_NE(found, names.end()) << name;
    return static_cast<int>(found - names.begin());
  }

  // From rest: the handle goes to where the example has it, in even steps, while others rest.
  void Drag(const Vector<std::pair<std::string, int>>& handle_and_shape,
            const PoseOptions& options) {
    state_->ResetToRest();
    constexpr int kSteps = 8;
    for (int step = 1; step <= kSteps; ++step) {
      for (const auto& [name, shape] : handle_and_shape) {
        const int handle = rig_->FindHandle(name);
        const RigHandle& table = rig_->tables().handles[static_cast<size_t>(handle)];
        const Eigen::Vector3d from = test::ShapePosition(*rig_, 0, table.vertex);
        const Eigen::Vector3d to = test::ShapePosition(*rig_, shape, table.vertex);
        const Eigen::Vector3f at = (from + (to - from) * step / kSteps).cast<float>();
        ASSERT_TRUE(state_->SetTarget(handle, {at.x(), at.y(), at.z()}).ok());
      }
      ASSERT_TRUE(state_->Solve(options, nullptr).ok());
    }
  }

  // Root mean square distance from the example, of the vertices that mostly follow the handle, in
  // parts of the character's diagonal.
  double DistanceNear(const std::string& handle_name, int shape) const {
    const SkinMesh& mesh = rig_->mesh();
    const auto handle = static_cast<size_t>(rig_->FindHandle(handle_name));
    const Vector<Eigen::Vector3d> q = test::SkinNaively(*rig_, state_->transforms());
    double sum = 0;
    int count = 0;
    for (uint32_t v = 0; v < mesh.num_solve_vertices; ++v) {
      if (mesh.weights[size_t{v} * static_cast<size_t>(mesh.num_handles) + handle] < 0.5f) continue;
      sum += (q[v] - test::ShapePosition(*rig_, shape, v)).squaredNorm();
      ++count;
    }
    EXPECT_GT(count, 10);
    return std::sqrt(sum / count) / static_cast<double>(rig_->diagonal());
  }

  std::shared_ptr<const Rig> rig_;
  std::optional<PoseState> state_;
};

TEST_F(VaryingBlendTest, HeadAndTail_TakeTwoExamplesAtOnce) {
  const int curl = FindShape("curl"), stretch = FindShape("stretch"), bend = FindShape("bend_left");
  using Choice = Vector<std::pair<std::string, int>>;
  for (const Choice& choice :
       {Choice{{"head", stretch}, {"tail_tip", curl}},
        Choice{{"head", bend}, {"hand_left", bend}, {"hand_right", bend}, {"tail_tip", curl}}}) {
    const int head_shape = choice.front().second;
    PoseOptions options;
    options.iterations = 30;
    Drag(choice, options);
    const double tail = DistanceNear("tail_tip", curl);
    EXPECT_LT(DistanceNear("head", head_shape), kNear) << "shape " << head_shape;
    EXPECT_LT(tail, kNear) << "shape " << head_shape;
    options.varying_blend = false;
    Drag(choice, options);
    EXPECT_GT(DistanceNear("tail_tip", curl), 5 * kNear) << "shape " << head_shape;
  }
}

}  // namespace
}  // namespace limber
