// Names of files that are about one handle each.
#pragma once

#include "core/vector.h"
#include "rig/rig_tables.h"

#include <string>

namespace limber::cli {

// For each handle its name as part of a file's name: what file systems may refuse becomes '_'
// (UTF-8 stays), long names are cut, and a name that an earlier handle has, in whatever case, gets
// the handle's number. No two are the same.
Vector<std::string> HandleFileNames(const Vector<RigHandle>& handles);

}  // namespace limber::cli
