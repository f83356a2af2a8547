// A glTF with a bit of everything, and bakes with random tables of the right sizes: the writer and
// the loader need no solver to be tested.
#pragma once

#include "bake/bake.h"
#include "core/vector.h"
#include "import/raw_character.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>

namespace limber::test {

// Two primitives (one indexed with a texture, one not), two morph targets, a seam, a skin, an
// animation, an external buffer and image, nulls, empty objects and unknown extensions, and one
// node marked as a handle below a scaled and turned node. Writes source.gltf and what lies beside
// it into `folder`; returns its path.
std::filesystem::path WriteRichSource(const std::filesystem::path& folder);

// A plain .glb without anything that a validator remarks on.
std::filesystem::path WritePlainSource(const std::filesystem::path& folder);

struct SyntheticOptions {
  int num_handles = 5;  // more than four: two weight attributes
  int num_groups = 3;
  bool rotations = true;
  int residual_rank = 2;
  uint32_t seed = 1;
};

// Random tables; weights with rows of sum one; draw vertices welded where all shapes coincide.
// Handles that raw marks come first.
bake::BakedCharacter MakeSyntheticBake(const bake::RawCharacter& raw,
                                       const SyntheticOptions& options);

Vector<uint8_t> ReadBytes(const std::filesystem::path& path);
// The JSON of a .glb or .gltf.
nlohmann::ordered_json ReadGltfJson(const std::filesystem::path& path);

}  // namespace limber::test
