// Skinning weights that an artist painted, which the bake then takes instead of computing its own.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/raw_character.h"
#include "load/gltf_file.h"

#include <span>
#include <string>

namespace limber::bake {

struct PaintedWeights {
  Vector<HandleSpec> handles;  // P
  Eigen::MatrixXd weights;     // D x P, draw vertices of the character; not normalised
  Vector<std::string> warnings;
};

// Those of the skin on the character's node (JOINTS_n and WEIGHTS_n): each joint is a handle of its
// node's name, held where it stands at bind, at the vertex nearest to it of those that follow it
// most. Joints that no vertex follows by a tenth are left out, with a warning. raw: as imported
// from `file`. Errors, without the file's name: kNotFound (no skin), those of ReadSkin and
// ReadSkinnedMesh, kNoHandles (no joint is left).
Result<PaintedWeights> WeightsOfSkin(const GltfFile& file, const RawCharacter& raw);

// Those of the vertex colours: handle i's are channel i % 4 (red, green, blue, alpha) of
// COLOR_(i / 4). Errors, without the file's name: kNotFound (a handle without its channel, which is
// named), those of ReadMeshAttribute.
Result<PaintedWeights> WeightsOfColors(const GltfFile& file, const RawCharacter& raw,
                                       std::span<const HandleSpec> handles);

}  // namespace limber::bake
