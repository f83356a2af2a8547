#include "cli/output.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;

Status IoError(const fs::path& path, const char* action, int error) {
  return Error(StatusCode::kIoError, "%s: output: cannot %s: %s", path.c_str(), action,
               std::strerror(error));
}

// Writes and flushes to the disk's cache; a full disk shows up here and not later.
Status WriteFile(const fs::path& path, const fs::path& shown, std::string_view content) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return IoError(shown, "open it for writing", errno);
  const bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  const int write_error = errno;
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return {};
  Status status = IoError(shown, "write it", written ? errno : write_error);
  std::error_code ignored;
  fs::remove(path, ignored);
  return status;
}

// The highest of the folders that do not exist yet on the way down to `folder`.
fs::path TopmostMissing(const fs::path& folder) {
  fs::path topmost;
  std::error_code ignored;
  for (fs::path p = folder; !p.empty() && !fs::exists(p, ignored); p = p.parent_path()) {
    topmost = p;
  }
  return topmost;
}

}  // namespace

Result<OutputFolder> OutputFolder::Create(const fs::path& folder) {
  OutputFolder output;
  // Without a trailing slash, so that parent_path() goes up.
  output.folder_ = folder.has_filename() ? folder : folder.parent_path();
  output.topmost_created_ = TopmostMissing(output.folder_);
  std::error_code error;
  fs::create_directories(output.folder_, error);
  if (!error && !fs::is_directory(output.folder_))
    error = std::make_error_code(std::errc::not_a_directory);
  if (error) return IoError(folder, "make the folder", error.value());
  output.staging_ = output.folder_ / (".limber-" + std::to_string(getpid()));
  output.owns_staging_ = true;
  fs::create_directory(output.staging_, error);
  if (error) return IoError(folder, "write into the folder", error.value());
  return output;
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)),
      staging_(std::move(other.staging_)),
      topmost_created_(std::move(other.topmost_created_)),
      names_(std::move(other.names_)),
      owns_staging_(std::exchange(other.owns_staging_, false)) {}

OutputFolder::~OutputFolder() {
  Abandon();
}

void OutputFolder::Abandon() {
  if (!owns_staging_) return;
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  owns_staging_ = false;
  if (topmost_created_.empty()) return;
  // Only empty folders go, and only those that were made here: what others put there meanwhile
  // stays.
  for (fs::path p = folder_; fs::remove(p, ignored) && p != topmost_created_; p = p.parent_path()) {
  }
}

fs::path OutputFolder::Stage(const std::string& name) {
  names_.push_back(name);
  return staging_ / name;
}

Status OutputFolder::Write(const std::string& name, std::string_view content) {
  return WriteFile(Stage(name), folder_ / name, content);
}

Status OutputFolder::Publish() {
  for (const std::string& name : names_) {
    std::error_code error;
    fs::rename(staging_ / name, folder_ / name, error);
    if (error) return IoError(folder_ / name, "put it in its place", error.value());
  }
  topmost_created_.clear();
  Abandon();
  return {};
}

}  // namespace limber::cli
