// The immutable Rig: everything about a baked character that its instances share. Made once by
// the loader or straight from the bake, then read by any number of threads without a lock.
#pragma once

#include "core/memory_source.h"
#include "core/status.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"

#include <memory>
#include <string_view>

namespace limber {

class Rig : public NewFromSource {
 public:
  // Checks every size, index and number of both parts against each other and freezes them: all
  // numbers finite, the weights of every vertex a sum of one (to within 1e-4), no reach negative.
  // The tables that version 1 of the format had not may be empty. Errors: kMalformed, kNoHandles
  // (none pinned), kDegenerate (no extent), kLimitExceeded, kOutOfMemory; the message names the
  // table and the element, expected and found. `name` is for messages and logs.
  static Result<std::shared_ptr<const Rig>> Create(std::string name, RigTables tables,
                                                   SkinMesh mesh);

  const String& name() const { return name_; }

  const RigTables& tables() const { return tables_; }

  const SkinMesh& mesh() const { return mesh_; }

  int dimension() const { return tables_.dimension; }

  int num_handles() const { return tables_.num_handles(); }

  int num_shapes() const { return tables_.num_shapes(); }

  int num_groups() const { return tables_.num_groups; }

  // Diagonal of the first example shape's bounding box, in mesh units: the size that tolerances
  // are relative to.
  float diagonal() const { return diagonal_; }

  // The handle of that name, -1 if there is none.
  int FindHandle(std::string_view handle_name) const;

  // Rig space to mesh space and back.
  Vec3 ToMesh(Vec3 x_rig) const;
  Vec3 ToRig(Vec3 x_mesh) const;

 private:
  Rig() = default;

  String name_;
  RigTables tables_;
  SkinMesh mesh_;
  float diagonal_ = 0;
};

}  // namespace limber
