// A character as the generators make it: one mesh of several primitives, its example shapes, its
// handles and its picture. Everything is in mesh space: y up, facing +z, the ground at y = 0.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace limber::content {

using Eigen::Vector2d;
using Eigen::Vector3d;

// 8-bit sRGB with straight alpha, rows from the top, as glTF's texture coordinates count them.
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;  // 4 * width * height
};

struct Material {
  std::string name;
  double roughness = 0.7;
  bool double_sided = false;
  bool alpha_cut = false;  // alphaMode MASK at 0.5
};

// Triangles of one material. `first_vertex` and `num_vertices` give its own run of the character's
// vertices; `triangles` count from the start of that run.
struct Primitive {
  uint32_t first_vertex = 0, num_vertices = 0;
  std::vector<uint32_t> triangles;  // 3 per triangle, counter-clockwise seen from outside
  int material = 0;
};

struct Shape {
  std::string name;
  std::vector<Vector3d> positions;  // one per vertex of the character
};

struct Handle {
  std::string name;
  uint32_t vertex = 0;
  bool pinned = true;
};

struct Character {
  std::string name;
  std::vector<Shape> shapes;  // [0] is the rest shape
  std::vector<Vector3d> normals;
  std::vector<Vector2d> texcoords;
  std::vector<Primitive> primitives;
  std::vector<Material> materials;
  Image picture;  // base colour of all materials
  std::vector<Handle> handles;
};

// The vertex of the rest shape nearest to `position`; the lowest number where several tie.
uint32_t NearestVertex(const Character& character, const Vector3d& position);

// Rounds every position to a multiple of 2^-16: rest, shapes and their differences are then exact
// in float, and the last bits of another C library's sine do not reach the files.
void RoundPositions(Character* character);

}  // namespace limber::content
