// A baked character dressed in data: weights, edge groups, blend weights as its only texture.
#pragma once

#include "core/vector.h"
#include "inspect/data_colors.h"
#include "rig/rig.h"
#include "viewer/character_model.h"

#include <span>

namespace limber::inspect {

struct ColoredCharacter {
  SkinMesh mesh;
  viewer::MaterialSet materials;
  RigSpace space;
  int dimension = 3;

  // Valid while this lives and stays where it is.
  viewer::CharacterSource Source() const;
};

// Each vertex by its weight of one handle (ScaleColor), with a line at each tenth.
ColoredCharacter ColorByWeight(const Rig& rig, int handle);

// Each triangle in one colour, that of the group that most of its corners are in; on a tie the
// first corner's. vertex_group: [V], in [0, group_colors.size()).
ColoredCharacter ColorByGroup(const Rig& rig, std::span<const int> vertex_group,
                              const Vector<Color>& group_colors);

// What each group shows of the examples: their colours mixed by its blend weights. blend_weights:
// [G][S]; example_colors: S.
Vector<Color> MixedByBlendWeights(std::span<const double> blend_weights,
                                  const Vector<Color>& example_colors);

}  // namespace limber::inspect
