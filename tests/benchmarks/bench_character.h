// Characters of any size for the benchmarks: shapes, handles and paths like those of real ones, but
// made in code, so that every number of vertices, handles and shapes can be had.
#pragma once

#include "import/raw_character.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"

#include <memory>
#include <vector>

namespace limber::bench {

struct CharacterSize {
  int vertices = 4000;  // at least so many; the surface has 4 n^2 + 2 for some n
  int handles = 9, shapes = 6;
  int groups = 0;  // 0: twice the number of handles

  friend auto operator<=>(const CharacterSize&, const CharacterSize&) = default;
};

// A closed bumpy surface with smooth example shapes that bend, twist and swell it, and handles
// spread over it, all pinned.
bake::RawCharacter MakeRawCharacter(const CharacterSize& size);

// The character baked, with weights that cost nothing in place of the bounded biharmonic ones:
// what is measured after the bake does not depend on how good they are. Made once for each size.
// Ends the program where the bake fails: there is nothing to measure then.
std::shared_ptr<const Rig> BakedCharacter(const CharacterSize& size);

// Targets of one frame, [H], mesh space: the handles go from example shape to example shape and
// round again, while each sways on its own, so that the active shapes change along the way.
std::vector<std::vector<Vec3>> DragPath(const Rig& rig, int num_frames);

// Sets every handle's target.
void SetTargets(const std::vector<Vec3>& targets, PoseState* pose);

// Ends the program with the message of a failure: a benchmark has nobody to hand it to.
void ExitUnless(const Status& status);

}  // namespace limber::bench
