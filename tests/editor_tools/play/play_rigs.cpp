#include "play_rigs.h"

#include "bake/bake.h"
#include "support/test_meshes.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace limber::test {
namespace {

// The rigs are the ground that the tests stand on: without them there is nothing to test.
template <class T>
T OrDie(Result<T> result) {
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.status().message().c_str());
    std::abort();
  }
  return std::move(result).value();
}

std::shared_ptr<const Rig> BakeInCode(const bake::RawCharacter& raw) {
  bake::BakedCharacter baked = OrDie(bake::Bake(raw, raw.marked_handles, {}, {}));
  return OrDie(Rig::Create(raw.name, std::move(baked.tables), std::move(baked.mesh)));
}

}  // namespace

std::shared_ptr<const Rig> BakeCylinder() {
  return BakeInCode(MakeBendCylinder(24, 40));
}

std::shared_ptr<const Rig> BakeCylinderOfVersion1() {
  const bake::RawCharacter raw = MakeBendCylinder(24, 40);
  bake::BakedCharacter baked = OrDie(bake::Bake(raw, raw.marked_handles, {}, {}));
  baked.tables.single_mode_transforms.clear();
  baked.tables.handle_reach.clear();
  return OrDie(Rig::Create(raw.name, std::move(baked.tables), std::move(baked.mesh)));
}

std::shared_ptr<const Rig> BakeSquare() {
  return BakeInCode(MakeStretchSquare(16));
}

}  // namespace limber::test
