// Linear functions of the transforms that can be held: points of the skin, and the axes of a
// handle's patch of skin, which together make its orientation. For each, all that solving needs to
// know, worked out once when the row is filled.
//
// The patch of a handle are the vertices that follow it more than anything else. With omega its
// weights there, its axes a_i and moments m_i are those of sum_v omega_v (p_v - p_h)(p_v - p_h)^T
// on the first shape, and the image of axis i is
//     F_i(q) = sum_v omega_v (a_i . (p_v - p_h)) / m_i (q_v - q_h),
// the least-squares affine map of the patch: F_i = a_i at rest. A flat patch has one axis less.
#pragma once

#include "core/aligned_vector.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/rig.h"
#include "rig/skin_point.h"

#include <array>

namespace limber {

// Views into a table of rows, or null where the rig has one shape (single).
struct HeldRow {
  double translation = 1;            // a: 1 for a point of the skin, 0 for a direction
  const double* modes = nullptr;     // C: r
  const double* loads = nullptr;     // K_z C^T: G*S*k
  const double* response = nullptr;  // Phi_1 C^T: n
  const double* single = nullptr;    // C of the models of one shape: [S][r1 + k padded]
};

// Axes have this length, so that a compliance weighs the same for a position and for a rotation.
inline constexpr double kAxisLength = 0.1;  // rig units

// The axes that a handle's patch has, each of kAxisLength: [count][k] in the first shape.
struct PatchAxes {
  size_t count = 0;
  std::array<double, 9> axes = {};
};

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
  // The images of the axes of a handle's patch, in as many rows from `at` on (at most k). Costs
  // O(V (k^2 + H S)) more.
  PatchAxes FillAxes(const Rig& rig, size_t at, int handle);

 private:
  void AddVertex(const Rig& rig, size_t vertex, double factor);
  void FillFromCoefficients(const Rig& rig, size_t at);
  void FillProducts(const RigTables& tables, size_t at);

  size_t num_modes_, num_loads_, num_transforms_, single_stride_, single_size_;
  Vector<double> translations_;  // [rows]
  AlignedVector<double> modes_, loads_, response_, single_;
  Vector<double> coefficients_;  // a row of M: n, scratch
};

}  // namespace limber
