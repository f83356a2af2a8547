#include "import/file_output.h"

#include "core/vector.h"
#include "load/glb_container.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <string>

namespace limber::bake {
namespace {

void AppendU32(uint64_t value, Vector<uint8_t>* bytes) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes->push_back(static_cast<uint8_t>(value >> shift));
}

uint64_t Padded(uint64_t size) {
  return (size + 3) / 4 * 4;
}

// For mkstemp. In the same folder, so that renaming never crosses a file system.
std::string TemporaryName(const std::filesystem::path& path) {
  return path.string() + ".XXXXXX";
}

Status IoError(const std::filesystem::path& path, const char* what, int error) {
  return Error(StatusCode::kIoError, "%s: %s: %s", path.string().c_str(), what,
               std::strerror(error));
}

Status WriteAll(int descriptor, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return Status(StatusCode::kIoError, std::strerror(errno));
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  if (::fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS) {
    return Status(StatusCode::kIoError, std::strerror(errno));
  }
  return {};
}

}  // namespace

Result<Vector<uint8_t>> AssembleGlb(std::string_view json, std::span<const uint8_t> bin) {
  const uint64_t json_bytes = Padded(json.size()), bin_bytes = Padded(bin.size());
  const uint64_t total = 12 + 8 + json_bytes + (bin.empty() ? 0 : 8 + bin_bytes);
  if (total > std::numeric_limits<uint32_t>::max()) {
    return Error(StatusCode::kLimitExceeded, "%llu bytes do not fit a GLB, whose limit is 4 GiB",
                 static_cast<unsigned long long>(total));
  }
  Vector<uint8_t> bytes;
  bytes.reserve(total);
  AppendU32(kGlbMagic, &bytes);
  AppendU32(2, &bytes);
  AppendU32(total, &bytes);
  AppendU32(json_bytes, &bytes);
  AppendU32(kGlbJsonChunk, &bytes);
  bytes.insert(bytes.end(), json.begin(), json.end());
  bytes.resize(20 + json_bytes, ' ');
  if (!bin.empty()) {
    AppendU32(bin_bytes, &bytes);
    AppendU32(kGlbBinChunk, &bytes);
    bytes.insert(bytes.end(), bin.begin(), bin.end());
    bytes.resize(total, 0);
  }
  return bytes;
}

Status CheckOutputPlace(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(path, ignored) || !path.has_filename()) {
    return Error(StatusCode::kIoError, "%s: output: is a folder; name a file", path.c_str());
  }
  if (!fs::is_directory(folder, ignored)) {
    return Error(StatusCode::kIoError, "%s: output: there is no folder %s; make it first",
                 path.c_str(), folder.c_str());
  }
  std::string temporary = TemporaryName(path);
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) return IoError(path, "output: no file can be made there", errno);
  ::close(descriptor);
  ::unlink(temporary.c_str());
  return {};
}

Status CheckKeepsInputs(const std::filesystem::path& path,
                        std::span<const std::filesystem::path> inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code ignored;  // a file that is not there is not overwritten
    if (!std::filesystem::equivalent(path, input, ignored)) continue;
    return Error(StatusCode::kInvalidArgument,
                 "%s: output: it would overwrite the input %s; name another file", path.c_str(),
                 input.c_str());
  }
  return {};
}

Status WriteFileAtomically(const std::filesystem::path& path, std::span<const uint8_t> bytes) {
  std::string temporary = TemporaryName(path);
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) return IoError(path, "cannot be written", errno);
  Status status = WriteAll(descriptor, bytes);
  // mkstemp lets only the owner read; a result is as readable as any other new file.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor, static_cast<mode_t>(0666) & ~mask);
  if (::close(descriptor) != 0 && status.ok()) {
    status = Status(StatusCode::kIoError, std::strerror(errno));
  }
  if (status.ok() && ::rename(temporary.c_str(), path.c_str()) != 0) {
    status = Status(StatusCode::kIoError, std::strerror(errno));
  }
  if (!status.ok()) {
    ::unlink(temporary.c_str());
    return status.WithContext(path.string() + ": cannot be written");
  }
  return {};
}

}  // namespace limber::bake
