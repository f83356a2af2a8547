// Linear functions of the transforms that can be held: points of the skin, and the directions of a
// handle's axes, k of which make its rotation. For each, all that solving needs to know, worked out
// once when the row is filled.
#pragma once

#include "core/aligned_vector.h"
#include "core/status.h"
#include "rig/rig.h"
#include "rig/skin_point.h"

#include <vector>

namespace limber {

// Views into a table of rows, or null where the rig has one shape (single).
struct HeldRow {
  double translation = 1;            // a: 1 for a point of the skin, 0 for a direction
  const double* modes = nullptr;     // C: r
  const double* loads = nullptr;     // K_z C^T: G*S*k
  const double* response = nullptr;  // Phi_1 C^T: n
  const double* single = nullptr;    // C of the models of one shape: [S][r1 + k padded]
};

// The directions are measured at this distance from the handle, so that a compliance weighs the
// same for a position and for a rotation.
inline constexpr double kAxisLength = 0.1;  // rig units

class HeldRowTable {
 public:
  HeldRowTable(const Rig& rig, size_t capacity);

  size_t capacity() const { return translations_.size(); }

  size_t bytes() const;  // held in tables

  HeldRow row(size_t at) const;

  // Each costs r (n + G S k) multiply-adds, tens of microseconds for a few handles and shapes;
  // nothing is allocated. The rig is the one of construction.
  //
  // The handle's vertex.
  void FillHandle(const Rig& rig, size_t at, int handle);
  // A point of the skin. Its vertices are below the mesh's number. Where there are several shapes
  // it needs RigTables::single_mode_transforms.
  void FillPoint(const Rig& rig, size_t at, const SkinPoint& point);
  // Rows at to at + k - 1: kAxisLength times the images of the rig's axes under the transform that
  // the handle has with all shapes together, as if each shape stood there turned like the first.
  void FillAxes(const Rig& rig, size_t at, int handle);

 private:
  void FillFromCoefficients(const Rig& rig, size_t at);
  void FillProducts(const RigTables& tables, size_t at);

  size_t num_modes_, num_loads_, num_transforms_, single_stride_, single_size_;
  std::vector<double> translations_;  // [rows]
  AlignedVector<double> modes_, loads_, response_, single_;
  std::vector<double> coefficients_;  // a row of M: n, scratch
  std::vector<double> turns_;         // [S][k][k], scratch
};

}  // namespace limber
