// A hand's handle does not move the other hand.
#include "bake/bake.h"
#include "import/import_gltf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

namespace limber::bake {
namespace {

TEST(LocalWeights, OfOneLimbOfTheDragonlet_AreNotFeltAtOthers) {
  const std::string file = std::string(LIMBER_SOURCE_DIR) + "/content/characters/dragonlet.glb";
  const Result<RawCharacter> raw = ImportGltf(file, {});
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const Result<BakedCharacter> baked = Bake(*raw, raw->marked_handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  const SkinMesh& mesh = baked->mesh;
  const auto handle = [&](std::string_view name) {
    for (int h = 0; h < mesh.num_handles; ++h) {
      if (baked->tables.handles[size_t(h)].name == name) return h;
    }
    ADD_FAILURE() << name;
    return 0;
  };
  const auto weight = [&](uint32_t v, int h) {
    return mesh.weights[size_t{v} * size_t(mesh.num_handles) + size_t(h)];
  };
  const std::pair<const char*, const char*> apart[] = {
      {"hand_left", "hand_right"}, {"hand_right", "hand_left"}, {"ear_left", "foot_right"},
      {"foot_left", "ear_right"},  {"tail_tip", "hand_left"},   {"ear_right", "tail_tip"}};
  for (const auto& [limb, other] : apart) {
    const int own = handle(limb), others = handle(other);
    int count = 0;
    float largest = 0;
    for (uint32_t v = 0; v < mesh.num_solve_vertices; ++v) {
      if (weight(v, own) < 0.7f) continue;
      ++count;
      largest = std::max(largest, weight(v, others));
    }
    EXPECT_GT(count, 20) << limb;
    EXPECT_LT(largest, 1e-5f) << "at " << limb << " of " << other;
  }
}

}  // namespace
}  // namespace limber::bake
