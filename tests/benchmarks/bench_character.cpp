#include "benchmarks/bench_character.h"

#include "bench/quick_bake.h"

#include <cstdio>
#include <cstdlib>
#include <map>

namespace limber::bench {

std::shared_ptr<const Rig> BakeCharacter(const CharacterSize& size) {
  const bake::RawCharacter raw = MakeRawCharacter(size);
  bake::BakeOptions options;
  options.num_groups = size.groups;
  auto baked = BakeQuickly(raw, raw.marked_handles, options, {});
  ExitUnless(baked.status());
  auto rig = Rig::Create(raw.name, std::move(baked->tables), std::move(baked->mesh));
  ExitUnless(rig.status());
  return *rig;
}

void ExitUnless(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "limber_benchmarks: %s\n", status.message().c_str());
  std::exit(1);
}

std::shared_ptr<const Rig> BakedCharacter(const CharacterSize& size) {
  static std::map<CharacterSize, std::shared_ptr<const Rig>> made;
  std::shared_ptr<const Rig>& rig = made[size];
  if (rig == nullptr) rig = BakeCharacter(size);
  return rig;
}

}  // namespace limber::bench
