// Who may include whom: the direction of data (source -> bake -> load -> solve -> skin -> draw) as
// a table, and the code that holds a tree of sources against it.
#pragma once

#include "core/vector.h"

#include <filesystem>
#include <string>

namespace limber::test {

struct IncludeReport {
  int num_files = 0, num_includes = 0;
  Vector<std::string> violations;  // "<file>:<line>: <reason>", one line each
};

// Reads every C and C++ file below source_folder/runtime and source_folder/editor_tools.
IncludeReport CheckIncludes(const std::filesystem::path& source_folder);

// All sources below `folder` with one of the extensions (".h"), sorted, for rules about files.
Vector<std::filesystem::path> SourcesBelow(const std::filesystem::path& folder,
                                           const Vector<std::string>& extensions);

}  // namespace limber::test
