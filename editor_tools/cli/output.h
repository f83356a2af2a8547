// A folder of results that appears whole or not at all. (Single files: import/file_output.h.)
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace limber::cli {

// A folder that a command fills. Files are made in a staging folder inside it and moved to their
// places by Publish, all at once; until then, and when Publish is never called, the folder is as it
// was (and absent if it was absent).
class OutputFolder {
 public:
  static Result<OutputFolder> Create(const std::filesystem::path& folder);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  // Where to write the file that will be folder/name.
  std::filesystem::path Stage(const std::string& name);
  Status Write(const std::string& name, std::string_view content);
  // Moves every staged file to its place, over an older file of that name.
  Status Publish();

  const std::filesystem::path& path() const { return folder_; }

 private:
  OutputFolder() = default;
  void Abandon();

  std::filesystem::path folder_, staging_;
  std::filesystem::path topmost_created_;  // removed again when nothing is published
  Vector<std::string> names_;
  bool owns_staging_ = false;
};

}  // namespace limber::cli
