// The mesh side of a character: what skinning, picking and drawing read. Plain data.
//
// Two kinds of vertices. A *draw vertex* is a vertex of the glTF's primitives (all primitives of
// the mesh one after the other); vertices split at UV seams and hard edges are different draw
// vertices. A *solve vertex* is a welded one: draw vertices that lie on the same point in every
// example shape share it, so a seam cannot crack. Skinning runs over solve vertices.
#pragma once

#include "core/vec3.h"
#include "core/vector.h"

#include <cstdint>
#include <string>

namespace limber {

struct SkinPrimitive {
  uint32_t first_vertex = 0, num_vertices = 0;  // draw vertices
  uint32_t first_triangle = 0, num_triangles = 0;
  int32_t gltf_primitive = 0;  // index within the glTF mesh
  int32_t material = -1;       // glTF material, -1 for the default one
};

struct SkinMesh {
  uint32_t num_solve_vertices = 0;  // V
  uint32_t num_draw_vertices = 0;   // D
  int32_t num_handles = 0, num_shapes = 0;

  Vector<float> weights;          // [V][H]: W, rows sum to one
  Vector<Vec3> shape_positions;   // [S][V], rig space
  Vector<uint32_t> solve_vertex;  // [D]: draw vertex -> solve vertex
  Vector<uint32_t> triangles;     // [3 * num_triangles] draw vertices, counter-clockwise
  Vector<SkinPrimitive> primitives;

  Vector<Vec3> rest_normals;    // [D] mesh space, unit; computed where the file has none
  Vector<float> rest_tangents;  // [4 * D] xyz and handedness; empty where the file has neither
                                // tangents nor texture coordinates
  Vector<float> texcoords;      // [2 * D], first set; empty where the file has none

  // The source's own vertex order (that of a packed OBJ): [D], each below num_source_vertices.
  Vector<uint32_t> source_vertex;
  uint32_t num_source_vertices = 0;

  uint32_t num_triangles() const { return static_cast<uint32_t>(triangles.size() / 3); }
};

}  // namespace limber
