// Reading files whose sizes and places are hostile until checked.
#pragma once

#include "core/status.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace limber {

// The whole of a file of at most max_bytes; nothing is read or allocated for a larger one. Errors,
// without the path: kNotFound, kIoError, kLimitExceeded, kOutOfMemory.
Result<std::vector<uint8_t>> ReadFileBytes(const std::filesystem::path& path, uint64_t max_bytes);

// The first num_bytes of a file, which may be longer. Errors as above, and kMalformed where it is
// shorter; its size is looked at before anything is allocated.
Result<std::vector<uint8_t>> ReadFileStart(const std::filesystem::path& path, uint64_t num_bytes);

// Where `relative` (RelativePathOfUri) really lies once every link is followed: somewhere under
// `folder`, which may itself be reached through links. A link to a file elsewhere is refused like a
// "..": what a character names comes from the character's own folder, whoever unpacked it. Errors,
// without the path: kNotFound, kIoError, kUnsupported (a link leads out).
Result<std::filesystem::path> ResolveInFolder(const std::filesystem::path& folder,
                                              const std::string& relative);

}  // namespace limber
