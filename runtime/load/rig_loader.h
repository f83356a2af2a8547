// From a baked glTF (the LIMBER_mesh_ik extension) to the immutable Rig. Depends on nothing of the
// desk; never crashes on a bad file.
#pragma once

#include "core/status.h"
#include "load/gltf_file.h"
#include "rig/rig.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace limber {

struct RigLoadOptions {
  int rig_index = 0;  // which of the file's rigs
  GltfLimits limits;
};

// Errors, each one line that begins with the file: those of GltfFile::Open and ReadMorphMesh;
// kUnsupported (the file was not baked), kVersionMismatch (baked in a newer format; every older one
// is read), kMeshMismatch (the mesh was changed after the bake), kMalformed and kLimitExceeded (a
// table, by name), kOutOfMemory.
Result<std::shared_ptr<const Rig>> LoadRig(const std::filesystem::path& path,
                                           const RigLoadOptions& options = {});
// From memory; a .glb, or a .gltf whose buffers are inside it. The bytes may go afterwards.
Result<std::shared_ptr<const Rig>> LoadRigFromMemory(std::span<const uint8_t> bytes,
                                                     const std::string& name,
                                                     const RigLoadOptions& options = {});
// From a file that is open already; its limits count, not those of the options.
Result<std::shared_ptr<const Rig>> LoadRig(const GltfFile& file,
                                           const RigLoadOptions& options = {});

// How many rigs the file holds; 0 for a glTF that was not baked.
int CountRigs(const GltfFile& file);

// The node that carries a rig's mesh, -1 when there is none.
int FindRigNode(const GltfFile& file, int rig_index);

}  // namespace limber
