// A glTF mesh as skinning needs it: vertices, morph targets, joints and weights of each primitive.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/raw_character.h"
#include "load/gltf_file.h"

#include <cstdint>
#include <string>

namespace limber::bake {

struct MorphOffsets {
  PointMatrix positions, normals;  // V x 3; without rows where the target has none
};

struct SkinnedPrimitive {
  PointMatrix positions;         // V x 3, mesh space of the bind pose
  PointMatrix normals;           // V x 3 as stored, or no rows
  Vector<MorphOffsets> targets;  // T, or none at all
  // Of vertex v the entries I * v ... I * v + I - 1; both empty without a skin.
  size_t num_influences = 0;     // I
  Vector<uint32_t> joints;       // places in the skin's list of joints
  Vector<double> joint_weights;  // each vertex's sum to one

  size_t num_vertices() const { return static_cast<size_t>(positions.rows()); }
};

struct SkinnedMesh {
  size_t num_targets = 0;               // T
  Vector<SkinnedPrimitive> primitives;  // all of the glTF's, in its order
  Vector<std::string> warnings;         // one line each, for people

  size_t num_vertices() const;
};

// num_joints: of the skin; 0: the mesh has none, joints and weights are not looked at. root_joint:
// whom vertices follow that have no weight (a warning counts them). Errors, without the file's
// name: those of ReadFloats; kMalformed (unequal numbers of targets; with a skin: no joints or
// weights, a joint that is not in the skin, a negative weight), kLimitExceeded.
Result<SkinnedMesh> ReadSkinnedMesh(const GltfFile& file, int mesh, size_t num_joints,
                                    size_t root_joint);

}  // namespace limber::bake
