// Moments of a glTF's animation -> morph targets of the mesh that it deforms (`limber pack
// --clip`).
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace limber::bake {

struct PackClipOptions {
  std::string clip;      // name or number; empty: the file's only one
  std::string node;      // the mesh node's name or number; empty: the only one that it deforms
  Vector<double> times;  // seconds; or
  int count = 0;         // that many moments spread over the clip (clip_moments.h)
  // Takes the horizontal travel of the skeleton's root joint (world x and z, against the pose
  // without animation) out of the shapes.
  bool in_place = false;
};

struct PackClipSummary {
  std::string clip;
  double clip_seconds = 0;
  bool loops = false;  // the clip's end has the shape of its start
  std::string node;
  size_t num_vertices = 0;
  size_t num_old_targets = 0;
  Vector<std::string> shape_names;  // one for each moment
  Vector<std::string> warnings;
};

// Each moment becomes a morph target: the mesh as it is drawn then - morph targets by their
// weights, then linear blend skinning - in mesh space of the bind pose, as displacements of
// positions and, where a primitive has them, normals. A moment in the bind pose displaces nothing;
// the motion of the skeleton's root is part of the shape. The file keeps its skin, its clips and
// all else; its own morph targets come before the new ones. out: .glb, or .gltf with its data
// inside; both replaced by rename. Same input, same bytes. Errors, one line each that begins with
// the file: those of GltfFile::Open, FindAnimationClip, ReadAnimationClip, FindNamedMeshNode,
// ReadSkin, ReadSkinnedMesh, CheckMoments, SpreadMoments, AppendTargets and GltfPatch;
// kInvalidArgument (no node that the clip deforms, several of them, a mesh that is baked already,
// an `out` of another kind of file, in_place without a skin), kMalformed (a vertex that comes to be
// at no finite place), kLimitExceeded (more targets than a bake reads), kIoError.
Result<PackClipSummary> PackClip(const std::filesystem::path& source,
                                 const PackClipOptions& options, const std::filesystem::path& out);

}  // namespace limber::bake
