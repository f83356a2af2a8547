// A series of OBJ files of one topology -> one glTF with morph targets (`limber pack`).
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/import_obj.h"

#include <filesystem>
#include <span>
#include <string>

namespace limber::bake {

struct PackOptions {
  std::string name;  // of the mesh and its node; empty: the base file's stem
};

// The base becomes the mesh, each shape a morph target named after its file's stem. The glTF
// remembers the source: each vertex's number in _LIMBER_SOURCE, polygons in the mesh's extras
// (source_faces.h), so that results come back in the base's own vertex and face order. Vertices are
// split where texture coordinates or normals differ; normals are computed where the base has none.
// Errors: those of ReadObj; kInvalidArgument (a shape whose vertex count or faces differ from the
// base's, naming both counts; no shape), kIoError.
Status PackObj(const std::filesystem::path& base, std::span<const std::filesystem::path> shapes,
               const PackOptions& options, const std::filesystem::path& output);

// The same from meshes in memory: the bytes of the .glb. shape_names: one for each shape.
Result<Vector<uint8_t>> PackMeshes(const ObjMesh& base, std::span<const ObjMesh> shapes,
                                   std::span<const std::string> shape_names,
                                   const std::string& name);

}  // namespace limber::bake
