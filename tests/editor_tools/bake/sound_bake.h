// What every bake has to be, whatever it is made of.
#pragma once

#include "import/raw_character.h"

#include <span>

namespace limber::test {

// Bakes and expects: weights within their bounds that sum to one, handles with weight one at their
// own vertex, finite tables, the same numbers a second time, a rig that loads, the first example
// back where handles are at rest, and finite positions where they are in the other examples.
void ExpectSoundBake(const bake::RawCharacter& raw, std::span<const bake::HandleSpec> handles);

}  // namespace limber::test
