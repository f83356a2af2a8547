// The numbers of a baked character, as they stand in the file: made by the bake, written and read
// through rig_fields.h, checked and frozen by Rig::Create. Plain data; nothing here computes.
//
// Letters as in Wampler 2016 (solve/SYMBOLS.md): k = dimension (2 or 3), H handles, S example
// shapes, G edge groups, n = H*S*(k+1). All lengths are in *rig space*, which the bake chooses so
// that the character is centred and about one unit large:
//     x_mesh = origin + scale * basis * x_rig          (mesh space = the glTF mesh's own space)
// For k = 2 the third rig coordinate is zero and the third column of the basis is the plane's
// normal.
//
// Reduced model. The paper's tensors L~, K~, H appear here factored, so that single precision is
// enough and no energy is ever a difference of large numbers. With J = sqrt(c) A M Phi_1 (weighted
// edges of the whitened modes, J^T J = I) every example's weighted edges split into a part inside
// the span of J, with coordinates K_z, and a rest with Gram matrix F^T F:
//     T^    = phi_0 t + Phi_1 z                 (n x k; t: 1 x k translation, z: r x k modes)
//     E_d   = 1/2 |z - sum_gs B_gs K_z,gs^T R_gs^T|^2 + 1/2 |sum_gs B_gs F_gs R_gs^T|^2
// Rows of T^ are ordered (h, s, i), i = 0..k, the translation last.
#pragma once

#include "core/vec3.h"
#include "core/vector.h"

#include <array>
#include <cstdint>
#include <string>

namespace limber {

// Columns of F (G S k, without rotations G S) that a solver can hold: its square is the largest
// thing there, 1.7 GB at this size.
inline constexpr int64_t kMostRigColumns = 12000;

// Maps rig space to mesh space: x_mesh = origin + scale * basis * x_rig.
struct RigSpace {
  std::array<float, 3> origin = {0, 0, 0};
  float scale = 1;
  std::array<float, 9> basis = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // column-major, orthonormal

  friend bool operator==(const RigSpace&, const RigSpace&) = default;
};

// A point of the character that input moves (pinned), or that only adds freedom (not pinned).
struct RigHandle {
  String name;
  bool pinned = true;
  uint32_t vertex = 0;      // the solve vertex (below SkinMesh::num_solve_vertices) that it holds
  int32_t node = -1;        // the glTF node that stands for it, -1 for none
  Vec3 rest_position = {};  // mesh space, on the first example shape

  friend bool operator==(const RigHandle&, const RigHandle&) = default;
};

// The reduced model; each table row-major with the shape in brackets, sizes as above.
struct RigTables {
  int32_t dimension = 3;         // k
  int32_t num_groups = 0;        // G
  int32_t num_modes = 0;         // r: whitened energy modes, r <= n - 1
  int32_t residual_rank = 0;     // rank of F
  int32_t num_single_modes = 0;  // r1 <= H*(k+1) - 1: modes of the models of one shape (for D)
  bool has_rotations = true;     // false: baked for the formulation without rotations only
  RigSpace space;
  Vector<RigHandle> handles;   // H of them
  Vector<String> shape_names;  // S of them, in the order of the example shapes

  Vector<float> mode_transforms;  // [n][1 + r]: phi_0 | Phi_1
  Vector<float> handle_modes;     // [H][1 + r]: row of M at the handle's vertex, times Phi
  Vector<float> mode_edges;       // [G][S][k][r]: K_z
  Vector<float> residual_factor;  // [rank][G*S*k]: F, columns (g, s, axis);
                                  // without rotations [rank][G*S]: F^T F is then the Gram
                                  // matrix of whole shapes, traces over axes taken
  // One FAST model (Jacobson et al. 2012) for each example shape, of which D is made. With
  // m = r1 + k, the energy of group g is E_g = |U [z; -R^T]|^2, U upper triangular, packed by rows.
  Vector<float> single_handle_modes;   // [S][H][1 + r1]
  Vector<float> single_edges;          // [S][G][k][r1]
  Vector<float> single_group_factors;  // [S][G][m*(m+1)/2]

  // Since version 2 of the format; each empty where the file is of version 1.
  // The transforms of those models: phi_0 | Phi_1 as in mode_transforms, rows (h, i). A point with
  // weights w and position p on shape s has the modes sum_hi w_h [p 1]_i row(s, h, i).
  Vector<float> single_mode_transforms;  // [S][H*(k+1)][1 + r1]
  // How far apart two handles can be without stretching any example: the length of the shortest
  // path over the surface between their vertices, the largest over the example shapes; symmetric,
  // zero on the diagonal and where no path leads (no limit). As exact as geometry/geodesic.h says.
  Vector<float> handle_reach;  // [H][H], >= 0

  int num_handles() const { return static_cast<int>(handles.size()); }

  int num_shapes() const { return static_cast<int>(shape_names.size()); }

  int num_transform_rows() const { return num_handles() * num_shapes() * (dimension + 1); }  // n
};

}  // namespace limber
