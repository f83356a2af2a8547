#include "import/source_faces.h"

#include "core/vector.h"
#include "load/gltf_mesh.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFacesKey[] = "limber_faces";

Eigen::Vector3d PositionOf(const ObjMesh& mesh, uint32_t corner) {
  const std::array<double, 3>& p = mesh.positions[mesh.corners[corner].position];
  return {p[0], p[1], p[2]};
}

// Twice the polygon's area vector (Newell): twice the sum of the signed areas of any fan.
Eigen::Vector3d AreaVector(const ObjMesh& mesh, uint32_t first, uint32_t size) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = PositionOf(mesh, first);
  for (uint32_t i = 1; i + 1 < size; ++i) {
    sum += (PositionOf(mesh, first + i) - origin).cross(PositionOf(mesh, first + i + 1) - origin);
  }
  return sum;
}

bool FanIsUpright(const ObjMesh& mesh, uint32_t first, uint32_t size, uint32_t start,
                  const Eigen::Vector3d& area) {
  const Eigen::Vector3d hub = PositionOf(mesh, first + start);
  for (uint32_t i = 1; i + 1 < size; ++i) {
    const Eigen::Vector3d a = PositionOf(mesh, first + (start + i) % size) - hub;
    const Eigen::Vector3d b = PositionOf(mesh, first + (start + i + 1) % size) - hub;
    if (a.cross(b).dot(area) < 0) return false;
  }
  return true;
}

// The sizes and fan starts that the extras hold; false when they do not describe the triangles.
bool ReadFaces(const Json& mesh, size_t num_triangles, Vector<uint32_t>* sizes,
               Vector<uint32_t>* starts) {
  const auto extras = mesh.find("extras");
  if (extras == mesh.end() || !extras->is_object()) return false;
  const auto faces = extras->find(kFacesKey);
  if (faces == extras->end() || !faces->is_object()) return false;
  const auto read = [&](const char* key, Vector<uint32_t>* numbers) {
    const auto it = faces->find(key);
    if (it == faces->end() || !it->is_array()) return false;
    for (const Json& number : *it) {
      if (!number.is_number_unsigned() || number.get<uint64_t>() > num_triangles + 2) return false;
      numbers->push_back(number.get<uint32_t>());
    }
    return true;
  };
  if (!read("sizes", sizes)) return false;
  if (!faces->contains("starts")) starts->assign(sizes->size(), 0);  // all fans begin at corner 0
  if (faces->contains("starts") && !read("starts", starts)) return false;
  if (sizes->size() != starts->size()) return false;
  uint64_t total = 0;
  for (size_t f = 0; f < sizes->size(); ++f) {
    if ((*sizes)[f] < 3 || (*starts)[f] >= (*sizes)[f]) return false;
    total += (*sizes)[f] - 2;
  }
  return total == num_triangles;
}

}  // namespace

FanTriangles CutIntoFans(const ObjMesh& mesh) {
  // Trying all starts is quadratic in the face's size: a disc of thousands of corners is left
  // alone.
  constexpr uint32_t kLargestSearched = 64;
  FanTriangles fans;
  uint32_t first = 0;
  for (const uint32_t size : mesh.face_sizes) {
    uint32_t start = 0;
    if (size > 3 && size <= kLargestSearched) {
      const Eigen::Vector3d area = AreaVector(mesh, first, size);
      while (start < size && !FanIsUpright(mesh, first, size, start, area))
        ++start;
      if (start == size) start = 0;
    }
    for (uint32_t i = 1; i + 1 < size; ++i) {
      for (const uint32_t corner : {0u, i, i + 1}) {
        fans.corners.push_back(first + (start + corner) % size);
      }
    }
    fans.starts.push_back(start);
    first += size;
  }
  return fans;
}

Json DescribeFaces(const ObjMesh& mesh, const FanTriangles& fans) {
  const bool only_triangles = std::all_of(mesh.face_sizes.begin(), mesh.face_sizes.end(),
                                          [](uint32_t size) { return size == 3; });
  if (only_triangles) return nullptr;
  Json faces = {{"sizes", mesh.face_sizes}};
  const bool all_begin_at_zero = std::all_of(fans.starts.begin(), fans.starts.end(),
                                             [](uint32_t start) { return start == 0; });
  if (!all_begin_at_zero) faces["starts"] = fans.starts;
  return {{kFacesKey, std::move(faces)}};
}

Result<SourceFaces> ReadSourceFaces(const GltfFile& file, int mesh) {
  Result<GltfMorphMesh> read = ReadMorphMesh(file, mesh);
  if (!read.ok()) return read.status();
  const size_t num_triangles = read->triangles.size() / 3;
  SourceFaces faces;
  faces.num_vertices = read->num_source_vertices;
  Vector<uint32_t> starts;
  if (!ReadFaces(file.json()["meshes"][static_cast<size_t>(mesh)], num_triangles, &faces.sizes,
                 &starts)) {
    faces.sizes.assign(num_triangles, 3);
    starts.assign(num_triangles, 0);
  }
  size_t triangle = 0;
  for (size_t f = 0; f < faces.sizes.size(); ++f) {
    const uint32_t size = faces.sizes[f];
    // Corner `start + i` of the polygon, in the order in which the fan met them.
    Vector<uint32_t> fan = {read->triangles[3 * triangle], read->triangles[3 * triangle + 1]};
    for (uint32_t i = 0; i + 2 < size; ++i, ++triangle) {
      fan.push_back(read->triangles[3 * triangle + 2]);
    }
    for (uint32_t i = 0; i < size; ++i) {
      faces.corners.push_back(read->source_vertex[fan[(i + size - starts[f]) % size]]);
    }
  }
  return faces;
}

}  // namespace limber::bake
