// Characters of any size for measuring: shapes and handles like those of real ones, but made in
// code, so that every number of vertices, handles and shapes can be had.
#pragma once

#include "import/raw_character.h"

namespace limber::bench {

struct CharacterSize {
  int vertices = 4000;  // nearly so many (made_surface.h)
  int handles = 9, shapes = 6;
  int groups = 0;     // 0: twice the number of handles
  int dimension = 3;  // 2: planar

  friend auto operator<=>(const CharacterSize&, const CharacterSize&) = default;
};

// A closed bumpy surface, or a bumpy disc, with smooth example shapes that bend, twist and swell
// it, and handles spread over it, all pinned: its marked handles.
bake::RawCharacter MakeRawCharacter(const CharacterSize& size);

}  // namespace limber::bench
