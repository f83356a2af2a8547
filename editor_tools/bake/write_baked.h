// Writes a baked character: the source glTF with the LIMBER_mesh_ik extension added (specification
// in content/extension/LIMBER_mesh_ik).
#pragma once

#include "bake/bake.h"
#include "core/status.h"
#include "import/raw_character.h"

#include <cstddef>
#include <filesystem>

namespace limber::bake {

// Whether WriteBaked could store a bake of `raw` with that many handles: everything that can be
// known before minutes of work. Reads the source with its images, writes nothing. Errors: those of
// WriteBaked, but for what only the bake itself decides (the size of its tables); kLimitExceeded
// (more handles than a baked file may have).
Status CheckBeforeBake(const std::filesystem::path& source, const RawCharacter& raw,
                       size_t num_handles, const std::filesystem::path& out);

// source: the glTF that `raw` was imported from, unchanged since. out: .glb, or .gltf with its data
// inside; both self-contained, replaced by rename, and proved to load before that. Everything else
// of the source survives; the rig of an earlier bake of the same mesh is replaced. Handles without
// a node get one below the mesh node, at rest position. Same input, same bytes. Errors, beginning
// with the file: those of GltfFile::Open and GltfPatch; kInvalidArgument (an extension of `out`
// other than the two, a source that does not fit `raw`), kVersionMismatch (baked in another format
// before), kIoError.
Status WriteBaked(const std::filesystem::path& source, const RawCharacter& raw,
                  const BakedCharacter& baked, const std::filesystem::path& out);

}  // namespace limber::bake
