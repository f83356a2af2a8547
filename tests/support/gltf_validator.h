// The Khronos glTF validator as the tests run it (tests/validate_gltf.mjs).
#pragma once

#include <filesystem>

namespace limber::test {

enum class ValidatorState {
  kReady,
  kMissing,  // npm install --prefix tests
  kBlind,    // it is there, but finds no fault with a bad file
};

// Tries it on a bad file that is written into `folder`.
ValidatorState FindGltfValidator(const std::filesystem::path& folder);

// Whether the validator has no error, warning or unexpected remark; what it says goes to stdout.
bool IsValidGltf(const std::filesystem::path& file);

}  // namespace limber::test
