#include "support/gltf_validator.h"

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

namespace limber::test {
namespace {

constexpr int kValid = 0, kInvalid = 1, kNotInstalled = 2, kNoSuchCommand = 127;

// Exit code of the validator.
int Validate(const std::filesystem::path& file) {
  const std::string command =
      "node '" LIMBER_SOURCE_DIR "/tests/validate_gltf.mjs' '" + file.string() + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

ValidatorState FindGltfValidator(const std::filesystem::path& folder) {
  const std::filesystem::path bad = folder / "bad.gltf";
  std::ofstream(bad) << R"({"asset": {"version": "2.0"}, "scene": 3})";
  const int code = Validate(bad);
  if (code == kNotInstalled || code == kNoSuchCommand) return ValidatorState::kMissing;
  return code == kInvalid ? ValidatorState::kReady : ValidatorState::kBlind;
}

bool IsValidGltf(const std::filesystem::path& file) {
  return Validate(file) == kValid;
}

}  // namespace limber::test
