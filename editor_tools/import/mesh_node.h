// Which node of a glTF is meant: by its name or number, or because it is the only one that will do.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <cstddef>
#include <string>

namespace limber::bake {

// The node's name, or "node_7" where it has none.
std::string NodeName(const GltfFile& file, size_t node);

// The nodes that carry a mesh, in the file's order.
Vector<size_t> MeshNodes(const GltfFile& file);

// Node names with their numbers as they stand in messages: "a" (1), "b" (4), ...
std::string ListNodes(const GltfFile& file, const Vector<size_t>& which);

// The mesh node that `wanted` names, by its name or its index in decimal. Errors, without the
// file's name: kNotFound (none of the file's mesh nodes, which are listed), kInvalidArgument
// (several of that name).
Result<int> FindNamedMeshNode(const GltfFile& file, const std::string& wanted);

}  // namespace limber::bake
