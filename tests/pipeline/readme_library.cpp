// The README's "library in twenty lines", compiled and run by readme_test.cpp. What stands between
// the two marks is in the README word for word; a test compares them.
#include "readme_library.h"

// [the README's lines begin]
#include "load/rig_loader.h"
#include "skin/cpu_skinner.h"
#include "solve/pose_solver.h"

limber::Status RaiseHandle(const char* baked_file, const char* name, DrawFunction draw) {
  auto rig = limber::LoadRig(baked_file);       // immutable; shared by all characters of this kind
  if (!rig.ok()) return rig.status();           // one line that names file, place and reason
  auto pose = limber::PoseState::Create(*rig);  // one for each character
  if (!pose.ok()) return pose.status();
  auto skinner = limber::CpuSkinner::Create((*rig)->mesh(), (*rig)->tables().space);
  if (!skinner.ok()) return skinner.status();

  const int handle = (*rig)->FindHandle(name);
  for (int frame = 1; frame <= 60; ++frame) {
    limber::Vec3 target = pose->target(handle);
    target.y += 0.005f * (*rig)->diagonal();
    LIMBER_RETURN_IF_ERROR(pose->SetTarget(handle, target));  // mesh space
    limber::PoseReport report;
    LIMBER_RETURN_IF_ERROR(pose->Solve({}, &report));  // warm: starts where it ended
    LIMBER_RETURN_IF_ERROR(skinner->Skin(pose->transforms()));
    draw(skinner->result());  // positions, normals, tangents: views, nothing was allocated
  }
  return {};
}

// [the README's lines end]
