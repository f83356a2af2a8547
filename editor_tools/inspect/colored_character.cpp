#include "inspect/colored_character.h"

#include "core/vector.h"

#include <algorithm>

namespace limber::inspect {
namespace {

constexpr float kShading = 0.4f;  // shows the form and leaves the colours readable

// One matt material with that texture, for all triangles.
ColoredCharacter Dressed(const Rig& rig, viewer::Image texture) {
  ColoredCharacter character;
  character.mesh = rig.mesh();
  character.space = rig.tables().space;
  character.dimension = rig.tables().dimension;
  viewer::Material material = viewer::DefaultMaterial();
  material.base_color = {1, 1, 1, 1};
  material.base_color_texture.image = 0;
  material.base_color_texture.repeat_u = material.base_color_texture.repeat_v = false;
  material.roughness = 1;
  material.shading = kShading;
  material.double_sided = true;
  character.materials.materials = {material};
  character.materials.images = {std::move(texture)};
  SkinPrimitive all;
  all.num_vertices = character.mesh.num_draw_vertices;
  all.num_triangles = character.mesh.num_triangles();
  all.material = 0;
  character.mesh.primitives = {all};
  return character;
}

// Every corner of every triangle a draw vertex of its own, so that a triangle can have one colour.
void SplitTriangles(SkinMesh* mesh) {
  const SkinMesh welded = *mesh;
  mesh->solve_vertex.clear();
  mesh->rest_normals.clear();
  mesh->source_vertex.clear();
  mesh->rest_tangents.clear();
  for (const uint32_t corner : welded.triangles) {
    mesh->solve_vertex.push_back(welded.solve_vertex[corner]);
    mesh->rest_normals.push_back(welded.rest_normals[corner]);
    mesh->source_vertex.push_back(static_cast<uint32_t>(mesh->source_vertex.size()));
  }
  mesh->num_draw_vertices = static_cast<uint32_t>(welded.triangles.size());
  mesh->num_source_vertices = mesh->num_draw_vertices;
  for (uint32_t i = 0; i < mesh->num_draw_vertices; ++i)
    mesh->triangles[i] = i;
  mesh->primitives[0].num_vertices = mesh->num_draw_vertices;
}

int GroupOfTriangle(int a, int b, int c) {
  return b == c ? b : a;
}

}  // namespace

viewer::CharacterSource ColoredCharacter::Source() const {
  return {&mesh, space, dimension, materials};
}

ColoredCharacter ColorByWeight(const Rig& rig, int handle) {
  ColoredCharacter character = Dressed(rig, ScaleStrip());
  character.materials.materials[0].contours = true;
  SkinMesh& mesh = character.mesh;
  mesh.texcoords.clear();
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  for (const uint32_t v : mesh.solve_vertex) {
    mesh.texcoords.push_back(mesh.weights[v * num_handles + static_cast<size_t>(handle)]);
    mesh.texcoords.push_back(0.5f);
  }
  return character;
}

ColoredCharacter ColorByGroup(const Rig& rig, std::span<const int> vertex_group,
                              const Vector<Color>& group_colors) {
  ColoredCharacter character = Dressed(rig, Swatches(group_colors));
  SkinMesh& mesh = character.mesh;
  SplitTriangles(&mesh);
  mesh.texcoords.clear();
  const auto count = static_cast<float>(group_colors.size());
  const auto group_of = [&](size_t corner) { return vertex_group[mesh.solve_vertex[corner]]; };
  for (size_t first = 0; first < mesh.solve_vertex.size(); first += 3) {
    const int group = GroupOfTriangle(group_of(first), group_of(first + 1), group_of(first + 2));
    for (int corner = 0; corner < 3; ++corner) {
      mesh.texcoords.push_back((static_cast<float>(group) + 0.5f) / count);
      mesh.texcoords.push_back(0.5f);
    }
  }
  return character;
}

Vector<Color> MixedByBlendWeights(std::span<const double> blend_weights,
                                  const Vector<Color>& example_colors) {
  const size_t num_shapes = example_colors.size();
  Vector<Color> mixed(blend_weights.size() / std::max<size_t>(num_shapes, 1), Color{});
  for (size_t i = 0; i < blend_weights.size(); ++i) {
    for (size_t channel = 0; channel < 3; ++channel)
      mixed[i / num_shapes][channel] += blend_weights[i] * example_colors[i % num_shapes][channel];
  }
  return mixed;
}

}  // namespace limber::inspect
