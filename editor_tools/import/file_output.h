// Writing files so that nothing half-written is ever seen, and assembling GLBs.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace limber::bake {

// Header, JSON chunk (padded with spaces) and, unless it is empty, a binary chunk (padded with
// zeros). Errors: kLimitExceeded beyond GLB's 4 GiB.
Result<Vector<uint8_t>> AssembleGlb(std::string_view json, std::span<const uint8_t> bin);

// Whether WriteFileAtomically could write there now: its folder exists, takes a file beside `path`
// (one is made and removed), and `path` is no folder. Errors: kIoError, beginning with the path.
Status CheckOutputPlace(const std::filesystem::path& path);

// Refuses (kInvalidArgument) a `path` that is the same file as one of `inputs`, under whatever
// name.
Status CheckKeepsInputs(const std::filesystem::path& path,
                        std::span<const std::filesystem::path> inputs);

// Writes beside `path`, flushes to the disk, then renames: readers see the old file or the new one,
// and a failure leaves the old one. Errors: kIoError, beginning with the path.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const uint8_t> bytes);

}  // namespace limber::bake
