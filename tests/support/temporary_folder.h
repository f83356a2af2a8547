// A fresh folder for one test, removed with all it holds at the end.
#pragma once

#include <filesystem>

namespace limber::test {

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The folder of shared test data (README there); empty where it is absent. Looked for in the
// environment variable LIMBER_DATA_DIR, then beside the checkout as ../shared/data.
std::filesystem::path SharedDataFolder();

}  // namespace limber::test
