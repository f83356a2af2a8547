// Tells one bake from another.
#pragma once

#include "rig/rig.h"
#include "skin/skin_transforms.h"

#include <cstdint>
#include <span>

namespace limber {

// 64-bit FNV-1a over words of eight bytes, what is left over as one word.
uint64_t HashBytes(uint64_t hash, std::span<const std::byte> bytes);
inline constexpr uint64_t kHashStart = 0xcbf29ce484222325;

// Of what the solver reads: handles, shapes, tables.
uint64_t HashRig(const Rig& rig);

// Of a pose as skinning sees it.
uint64_t HashPose(const SkinTransforms& transforms);

}  // namespace limber
