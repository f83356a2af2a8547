// glTF -> RawCharacter: one mesh node with its morph targets, and the nodes marked as handles.
#pragma once

#include "core/status.h"
#include "import/raw_character.h"
#include "load/gltf_file.h"

#include <filesystem>
#include <string>

namespace limber::bake {

struct ImportOptions {
  // The mesh node: its name, or its index in decimal. Empty: the only node whose mesh has morph
  // targets.
  std::string node;
  // Whether the base mesh is an example shape itself (the first one, "base"). Without it the first
  // target is at rest, and normals are computed from it: those of the file belong to the base.
  bool include_base = true;
  // The vertex attribute that says how stiff the surface is; empty: see ReadVertexStiffness.
  std::string stiffness;
};

// The mesh in its own (node-local) space. A node marked with extras {"limber_handle": true} or
// {"limber_handle": {"pinned": false}} becomes a wish for a handle of the node's name, at the
// node's position brought into mesh space. Errors, one line each that begins with the file: those
// of GltfFile::Open, ReadMorphMesh and ReadVertexStiffness; kNotFound (no such node),
// kInvalidArgument (several candidates, all listed), kNoExamples, kMalformed (a mark that is not
// understood, a transform that cannot be inverted).
Result<RawCharacter> ImportGltf(const std::filesystem::path& path,
                                const ImportOptions& options = {});
// The same from a file that is open already.
Result<RawCharacter> ImportGltf(const GltfFile& file, const ImportOptions& options = {});

}  // namespace limber::bake
