// One mesh with its example shapes as it came from a file: nothing welded, nothing derived.
// Positions are in mesh space, in double (sums over many targets lose nothing).
#pragma once

#include "core/vector.h"
#include "import/handle_spec.h"
#include "rig/skin_mesh.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace limber::bake {

// Row-major so that a row is a point.
using PointMatrix = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct RawCharacter {
  std::string file;  // as the user named it, for messages
  std::string name;  // of the mesh or node
  int node = -1;     // glTF node that carries the mesh
  int mesh = -1;     // glTF mesh

  Vector<std::string> shape_names;  // S; [0] is the base unless it was left out
  Vector<PointMatrix> shapes;       // S of D x 3, draw vertices, mesh space
  Vector<uint32_t> triangles;       // 3 per triangle, draw vertices
  Vector<SkinPrimitive> primitives;
  Vector<Vec3> normals;            // D or empty: as in the file, of the base mesh
  Vector<float> tangents;          // 4 * D or empty
  Vector<float> texcoords;         // 2 * D or empty
  Vector<float> stiffness;         // D or empty: factors (vertex_stiffness.h)
  Vector<uint32_t> source_vertex;  // D: the source's own vertex order
  uint32_t num_source_vertices = 0;

  Vector<HandleSpec> marked_handles;  // nodes whose extras mark them as handles
  // D x H: weights that an artist painted, for the handles that the character is baked with, in
  // their order; rows need not sum to one. Without rows: the bake computes them.
  Eigen::MatrixXd painted_weights;
  Vector<std::string> warnings;  // one line each, for people

  int num_draw_vertices() const { return shapes.empty() ? 0 : static_cast<int>(shapes[0].rows()); }
};

}  // namespace limber::bake
