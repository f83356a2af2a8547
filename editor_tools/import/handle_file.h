// The handle file of `limber bake --handles`:
//   {"handles": [{"name": "tail", "vertex": 123},
//                {"name": "knee", "position": [x, y, z], "free": true}]}
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/handle_spec.h"

#include <filesystem>
#include <string_view>

namespace limber::bake {

// Vertex numbers count from 0 in the source's order; positions are in mesh space. Whether they
// exist is checked later, against the mesh. Errors, naming file and element: kNotFound, kIoError,
// kMalformed (not JSON, an unknown member, a wrong type, both or neither of vertex and position),
// kNoHandles (an empty list).
Result<Vector<HandleSpec>> ReadHandleFile(const std::filesystem::path& path);
Result<Vector<HandleSpec>> ParseHandles(std::string_view text, const std::string& name);

}  // namespace limber::bake
