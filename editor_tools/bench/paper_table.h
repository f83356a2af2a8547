// Table 1 of the paper (Wampler 2016), and characters of its sizes.
#pragma once

#include "core/status.h"
#include "import/raw_character.h"

#include <filesystem>
#include <span>
#include <string>

namespace limber::bench {

struct PaperRow {
  const char* name;
  int dimension;  // k
  int vertices;   // |P|
  int shapes;     // |S|
  int handles;    // |H|
  bool rotations;
  double precompute;   // seconds
  double alternation;  // seconds, of one
};

// In the paper's order.
std::span<const PaperRow> PaperTable();

struct PaperCharacter {
  bake::RawCharacter raw;
  bool is_the_papers = false;  // else made in code, with its handles marked
};

// The row's own mesh with as many of its shapes, where the data folder has it (horse/horse_ref.obj
// and its first poses, characters/lion-poses.glb, characters/head-poses.glb); else, and without
// a folder (empty), one made in code of the same k, |S| and |H| and nearly the same |P|. Errors of
// the files that are there: those of import.
Result<PaperCharacter> CharacterOf(const PaperRow& row, const std::filesystem::path& data);

// Whether the folder has any of the paper's meshes.
bool HasPaperMeshes(const std::filesystem::path& data);

}  // namespace limber::bench
