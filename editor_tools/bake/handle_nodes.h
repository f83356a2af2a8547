// The nodes that stand for handles in a baked glTF, so that every tool can animate them.
#pragma once

#include "core/vector.h"
#include "rig/rig_tables.h"

#include <nlohmann/json_fwd.hpp>

namespace limber::bake {

// Gives each handle a node and writes its number into (*handles)[i].node: the one it came from;
// else one marked as a handle of the same name; else a new one below the mesh node, at the rest
// position, marked so that the next bake finds it. Nodes that an earlier bake made (old_rig, null
// for none) and that no handle needs any more are removed where nothing else refers to them, else
// unmarked. stiffness: [H], that of HandleSpec. root: the glTF's JSON.
void PlaceHandleNodes(const nlohmann::ordered_json& old_rig, int mesh_node,
                      const Vector<double>& stiffness, Vector<RigHandle>* handles,
                      nlohmann::ordered_json* root);

}  // namespace limber::bake
