// The numbers of a rig's tables, however the file holds them: as floats, packed, or in the shorter
// forms that stand for a table.
#pragma once

#include "core/status.h"
#include "load/gltf_file.h"
#include "load/rig_json.h"

namespace limber {

// Fills the tables of *rig, whose counts and table_accessors are read, from a file of that version.
// Errors: kMalformed, kLimitExceeded, kOutOfMemory; messages begin with "tables.NAME".
Status ReadRigTables(const GltfFile& file, int version, RigJson* rig);

}  // namespace limber
