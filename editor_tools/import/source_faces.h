// The faces of a packed OBJ: polygons, in the source's order and vertex numbers.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/import_obj.h"
#include "load/gltf_file.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>

namespace limber::bake {

struct SourceFaces {
  uint32_t num_vertices = 0;  // of the source, those that no face uses included
  Vector<uint32_t> sizes;     // corners of each face
  Vector<uint32_t> corners;   // source vertices, all faces one after the other
};

// What the glTF's mesh was packed from; for a glTF that was not packed, its triangles. Errors:
// those of ReadMorphMesh.
Result<SourceFaces> ReadSourceFaces(const GltfFile& file, int mesh);

// How polygons are cut: fans, each from the first corner that gives no triangle turned against the
// polygon (concave quads), else from corner 0.
struct FanTriangles {
  Vector<uint32_t> corners;  // 3 each: numbers into ObjMesh::corners
  Vector<uint32_t> starts;   // of each face: the corner that its fan turns about
};

FanTriangles CutIntoFans(const ObjMesh& mesh);

// What the mesh's extras remember of the cut; null when all faces are triangles.
nlohmann::ordered_json DescribeFaces(const ObjMesh& mesh, const FanTriangles& fans);

}  // namespace limber::bake
