#include "load/file_bytes.h"

#include "core/out_of_memory.h"

#include <algorithm>
#include <fstream>

namespace limber {
namespace {

namespace fs = std::filesystem;

Result<uint64_t> RegularFileSize(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return Error(StatusCode::kNotFound, "no such file");
  if (!fs::is_regular_file(status)) return Error(StatusCode::kIoError, "not a regular file");
  const uint64_t size = fs::file_size(path, error);
  if (error) return Status(StatusCode::kIoError, error.message());
  return size;
}

// The caller has checked the size.
Result<std::vector<uint8_t>> ReadBytes(const fs::path& path, uint64_t num_bytes) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Error(StatusCode::kIoError, "cannot be opened; check its permissions");
  std::vector<uint8_t> bytes(num_bytes);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(num_bytes));
  if (static_cast<uint64_t>(stream.gcount()) != num_bytes) {
    return Error(StatusCode::kIoError, "reading stopped after %lld of %llu bytes",
                 static_cast<long long>(stream.gcount()),
                 static_cast<unsigned long long>(num_bytes));
  }
  return bytes;
}

}  // namespace

Result<std::vector<uint8_t>> ReadFileBytes(const fs::path& path, uint64_t max_bytes) {
  return CatchOutOfMemory("", [&]() -> Result<std::vector<uint8_t>> {
    Result<uint64_t> size = RegularFileSize(path);
    if (!size.ok()) return size.status();
    if (*size > max_bytes) {
      return Error(StatusCode::kLimitExceeded, "%llu bytes, the limit is %llu",
                   static_cast<unsigned long long>(*size),
                   static_cast<unsigned long long>(max_bytes));
    }
    return ReadBytes(path, *size);
  });
}

Result<std::vector<uint8_t>> ReadFileStart(const fs::path& path, uint64_t num_bytes) {
  return CatchOutOfMemory("", [&]() -> Result<std::vector<uint8_t>> {
    Result<uint64_t> size = RegularFileSize(path);
    if (!size.ok()) return size.status();
    if (*size < num_bytes) {
      return Error(StatusCode::kMalformed,
                   "%llu bytes are declared and %llu are there; the file is truncated",
                   static_cast<unsigned long long>(num_bytes),
                   static_cast<unsigned long long>(*size));
    }
    return ReadBytes(path, num_bytes);
  });
}

Result<fs::path> ResolveInFolder(const fs::path& folder, const std::string& relative) {
  return CatchOutOfMemory("", [&]() -> Result<fs::path> {
    std::error_code error;
    const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) return Status(StatusCode::kIoError, error.message());
    fs::path found = fs::canonical(root / relative, error);
    if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) {
      return Error(StatusCode::kNotFound, "no such file");
    }
    if (error) return Status(StatusCode::kIoError, error.message());
    if (std::mismatch(root.begin(), root.end(), found.begin(), found.end()).first != root.end()) {
      return Error(StatusCode::kUnsupported,
                   "a link leads out of the glTF's own folder; copy the file there, or export as "
                   "one .glb");
    }
    return found;
  });
}

}  // namespace limber
