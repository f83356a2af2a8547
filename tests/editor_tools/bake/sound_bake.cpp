#include "editor_tools/bake/sound_bake.h"

#include "bake/bake.h"
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace limber::test {
namespace {

void ExpectFinite(const Vector<float>& numbers, const char* what) {
  EXPECT_TRUE(std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); }))
      << what;
}

void ExpectSoundWeights(const bake::BakedCharacter& baked) {
  const SkinMesh& mesh = baked.mesh;
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  for (size_t v = 0; v < mesh.num_solve_vertices; ++v) {
    double sum = 0;
    for (size_t h = 0; h < num_handles; ++h) {
      const double weight = mesh.weights[v * num_handles + h];
      ASSERT_TRUE(weight >= 0 && weight <= 1 + 1e-6) << "vertex " << v << ": " << weight;
      sum += weight;
    }
    ASSERT_NEAR(sum, 1, 1e-6) << "vertex " << v;
  }
  for (size_t h = 0; h < num_handles; ++h)
    EXPECT_EQ(mesh.weights[baked.tables.handles[h].vertex * num_handles + h], 1.0f);
}

// Handles at rest bring the first example back, others something finite near the character.
void ExpectPoses(const std::shared_ptr<const Rig>& rig) {
  auto state = PoseState::Create(rig);
  ASSERT_TRUE(state.ok()) << state.status().message();
  const double size = rig->diagonal();
  for (int shape = 0; shape < rig->tables().num_shapes(); ++shape) {
    for (int h = 0; h < rig->num_handles(); ++h) {
      if (!state->is_pinned(h)) continue;
      const Eigen::Vector3d at =
          ShapePosition(*rig, shape, rig->tables().handles[size_t(h)].vertex);
      ASSERT_TRUE(state->SetTarget(h, {float(at.x()), float(at.y()), float(at.z())}).ok());
    }
    PoseOptions options;
    options.iterations = 300;
    ASSERT_TRUE(state->Solve(options, nullptr).ok());
    const auto points = SkinNaively(*rig, state->transforms());
    for (uint32_t v = 0; v < points.size(); ++v) {
      ASSERT_TRUE(points[v].allFinite()) << "shape " << shape << ", vertex " << v;
      if (shape > 0) continue;
      ASSERT_LT((points[v] - ShapePosition(*rig, 0, v)).norm(), 1e-3 * size)
          << "vertex " << v << " at rest";
    }
  }
}

}  // namespace

void ExpectSoundBake(const bake::RawCharacter& raw, std::span<const bake::HandleSpec> handles) {
  auto baked = bake::Bake(raw, handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  ExpectSoundWeights(*baked);
  ExpectFinite(baked->tables.mode_edges, "modeEdges");
  ExpectFinite(baked->tables.residual_factor, "residualFactor");
  ExpectFinite(baked->tables.single_group_factors, "singleGroupFactors");
  const auto again = bake::Bake(raw, handles, {}, {});
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->tables.mode_edges, baked->tables.mode_edges);
  EXPECT_EQ(again->mesh.weights, baked->mesh.weights);
  auto rig = Rig::Create(raw.name, std::move(baked->tables), std::move(baked->mesh));
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  ExpectPoses(*rig);
}

}  // namespace limber::test
