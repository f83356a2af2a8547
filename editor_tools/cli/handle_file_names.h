// Names of files that are about one handle each.
#pragma once

#include "rig/rig_tables.h"

#include <string>
#include <vector>

namespace limber::cli {

// For each handle its name as part of a file's name: what file systems may refuse becomes '_'
// (UTF-8 stays), long names are cut, and a name that an earlier handle has, in whatever case, gets
// the handle's number. No two are the same.
std::vector<std::string> HandleFileNames(const std::vector<RigHandle>& handles);

}  // namespace limber::cli
