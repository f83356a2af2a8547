// One glTF mesh with morph targets as draw vertices: all its primitives one after the other.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "core/vector.h"
#include "load/gltf_file.h"
#include "rig/skin_mesh.h"

#include <cstdint>
#include <string>

namespace limber {

// D draw vertices; mesh space; as stored, nothing welded. Triangle strips and fans have become
// triangles; primitives of points and lines are left out (a warning says so).
struct GltfMorphMesh {
  std::string name;  // the mesh's own name, or "mesh 3"
  int mesh = -1;
  Vector<Vec3> positions;            // [D]
  Vector<Vector<Vec3>> targets;      // [T][D] offsets from positions
  Vector<std::string> target_names;  // [T], from extras.targetNames, else "target_0"...
  Vector<uint32_t> triangles;        // 3 each; corners may repeat (degenerate triangles)
  Vector<SkinPrimitive> primitives;
  // Of the base mesh. Empty where the file has none; where only some primitives have normals the
  // others get smooth ones; tangents that some vertices lack are left out altogether.
  Vector<Vec3> normals;     // [D], unit
  Vector<float> tangents;   // [4 * D]
  Vector<float> texcoords;  // [2 * D], the first set; zero in primitives that have none
  // The source's own vertex order (attribute _LIMBER_SOURCE); else that of the draw vertices.
  Vector<uint32_t> source_vertex;  // [D]
  uint32_t num_source_vertices = 0;
  Vector<std::string> warnings;

  uint32_t num_vertices() const { return static_cast<uint32_t>(positions.size()); }
};

// Errors, each beginning with the file's name: kInvalidArgument (no such mesh), kNoExamples (no
// morph target), kMalformed (unequal numbers of targets, numbers out of range or not finite),
// kLimitExceeded, kOutOfMemory.
Result<GltfMorphMesh> ReadMorphMesh(const GltfFile& file, int mesh);

// Concatenates one attribute over the primitives of `mesh`, `components` floats for each draw
// vertex. Errors: kNotFound when a primitive lacks it, else as ReadFloats; without the file's name.
Result<Vector<float>> ReadMeshAttribute(const GltfFile& file, const GltfMorphMesh& mesh,
                                        const std::string& attribute, int components);

// Identifies what a bake depends on: vertex count, triangles, positions and targets as decoded
// floats (64-bit FNV-1a). 16 hexadecimal digits. Compressing, re-indexing or editing the mesh
// changes it; materials, names and transforms do not.
std::string HashMesh(const GltfMorphMesh& mesh);

}  // namespace limber
