// Who may include whom: the direction of data (source -> bake -> load -> solve -> skin -> draw) as
// a table, and the code that holds a tree of sources against it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace limber::test {

struct IncludeReport {
  int num_files = 0, num_includes = 0;
  std::vector<std::string> violations;  // "<file>:<line>: <reason>", one line each
};

// Reads every C and C++ file below source_folder/runtime and source_folder/editor_tools.
IncludeReport CheckIncludes(const std::filesystem::path& source_folder);

// All sources below `folder` with one of the extensions (".h"), sorted, for rules about files.
std::vector<std::filesystem::path> SourcesBelow(const std::filesystem::path& folder,
                                                const std::vector<std::string>& extensions);

}  // namespace limber::test
