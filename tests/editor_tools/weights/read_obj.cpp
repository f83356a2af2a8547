#include "editor_tools/weights/read_obj.h"

#include "core/vector.h"

#include <fstream>
#include <sstream>
#include <string>

namespace limber::test {

ObjMesh ReadObj(const std::filesystem::path& file) {
  std::ifstream stream(file);
  Vector<double> coordinates;
  ObjMesh mesh;
  std::string line, word;
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      for (double x = 0; words >> x;)
        coordinates.push_back(x);
    } else if (word == "f") {
      Vector<uint32_t> corners;
      while (words >> word)
        corners.push_back(static_cast<uint32_t>(std::stoul(word)) - 1);
      for (size_t i = 2; i < corners.size(); ++i) {
        mesh.triangles.insert(mesh.triangles.end(), {corners[0], corners[i - 1], corners[i]});
      }
    }
  }
  mesh.points = Eigen::Map<geometry::PointMatrix>(
      coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
  return mesh;
}

}  // namespace limber::test
