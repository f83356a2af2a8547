// Which colour each edge group gets.
#pragma once

#include "core/vector.h"
#include "inspect/data_colors.h"
#include "rig/skin_mesh.h"

#include <span>

namespace limber::inspect {

// A colour of Palette(num_groups) for each group, no two the same, exchanged between groups until
// those that share a triangle differ well (in Oklab). vertex_group: [V], in [0, num_groups).
Vector<Color> GroupColors(const SkinMesh& mesh, std::span<const int> vertex_group, int num_groups);

}  // namespace limber::inspect
