#include "drive/rig_hash.h"

#include "core/vector.h"

#include <cstring>

namespace limber {
namespace {

template <class T>
uint64_t HashTable(uint64_t hash, const Vector<T>& table) {
  return HashBytes(hash, std::as_bytes(std::span(table)));
}

}  // namespace

uint64_t HashBytes(uint64_t hash, std::span<const std::byte> bytes) {
  constexpr uint64_t kPrime = 0x100000001b3;
  while (!bytes.empty()) {
    uint64_t word = 0;
    const size_t count = bytes.size() < sizeof(word) ? bytes.size() : sizeof(word);
    std::memcpy(&word, bytes.data(), count);
    hash = (hash ^ word) * kPrime;
    bytes = bytes.subspan(count);
  }
  return hash;
}

uint64_t HashRig(const Rig& rig) {
  const RigTables& t = rig.tables();
  const int32_t counts[4] = {t.dimension, t.num_groups, t.num_handles(), t.num_shapes()};
  uint64_t hash = HashBytes(kHashStart, std::as_bytes(std::span(counts)));
  for (const RigHandle& handle : t.handles) {
    hash = HashBytes(hash, std::as_bytes(std::span(handle.name)));
    const float rest[4] = {handle.rest_position.x, handle.rest_position.y, handle.rest_position.z,
                           handle.pinned ? 1.0f : 0.0f};
    hash = HashBytes(hash, std::as_bytes(std::span(rest)));
  }
  hash = HashTable(hash, t.handle_modes);
  hash = HashTable(hash, t.mode_transforms);
  return HashTable(hash, t.residual_factor);
}

uint64_t HashPose(const SkinTransforms& transforms) {
  const float origin[3] = {transforms.origin.x, transforms.origin.y, transforms.origin.z};
  return HashBytes(HashBytes(kHashStart, std::as_bytes(std::span(origin))),
                   std::as_bytes(transforms.matrices));
}

}  // namespace limber
