// A real character from its source file through bake, file and loader, for tests of the whole.
#pragma once

#include "core/vector.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"
#include "support/temporary_folder.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace limber::test {

using Points = Vector<Eigen::Vector3d>;  // [V] solve vertices, mesh space

// The horse's reference and its four poses, packed as NAME.glb in the folder. Fails the test on
// error.
std::filesystem::path PackHorse(const TemporaryFolder& folder, const std::string& name);

class AccuracyCharacter {
 public:
  // Imports a glTF, chooses `num_handles` handles, bakes, writes, loads. Fails the test on error.
  // The baked file stays in pictures/ of the build folder (see real_characters.sh).
  static std::optional<AccuracyCharacter> Make(const std::filesystem::path& source, int num_handles,
                                               bool rotations);

  const Rig& rig() const { return *rig_; }

  PoseState& state() { return *state_; }

  const PoseOptions& options() const { return options_; }  // of every frame of a drag

  Points Shape(int shape) const;
  int FindShape(const std::string& name) const;  // fails the test when there is none
  Points Deformed() const;

  // Moves all handles in equal steps along straight lines to where `goal` has them.
  void DragTo(const Points& goal, int steps, const std::function<void()>& after_frame = {});
  // Writes every frame that DragTo made so far beside the baked file, for `limber render`.
  void KeepFrames() const;
  // Alternates until at rest, at most `most` times.
  PoseReport Settle(int most);

  // Root mean square distance of the deformed mesh from `goal`, in percent of the diagonal.
  double RmsPercent(const Points& goal) const;

  // For drags: everything finite, no edge longer than `longest` times its longest in any example
  // (edges below a thousandth of the diagonal apart), no vertex further than `jump` of the diagonal
  // from where it was a frame ago.
  void ExpectSound(double longest, double jump);

 private:
  void RecordFrame();

  std::shared_ptr<const Rig> rig_;
  std::optional<PoseState> state_;
  PoseOptions options_;
  Vector<std::pair<uint32_t, uint32_t>> edges_;
  Vector<double> edge_length_;  // longest over the examples
  Points last_;
  std::filesystem::path baked_file_;
  std::string frames_;  // JSON so far
};

}  // namespace limber::test
