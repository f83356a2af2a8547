// The characters of editor_tools/bench, baked and remembered, for benchmarks that have nobody to
// hand an error to.
#pragma once

#include "bench/drag_path.h"
#include "bench/made_character.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"

#include <memory>
#include <vector>

namespace limber::bench {

// The character baked with weights that cost nothing (bench/quick_bake.h). Ends the program where
// the bake fails: there is nothing to measure then.
std::shared_ptr<const Rig> BakeCharacter(const CharacterSize& size);

// The same, made once for each size.
std::shared_ptr<const Rig> BakedCharacter(const CharacterSize& size);

// Ends the program with the message of a failure.
void ExitUnless(const Status& status);

}  // namespace limber::bench
