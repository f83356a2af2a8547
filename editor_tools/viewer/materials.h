// What the viewer draws of glTF materials: base colour, normal map, alpha mode, double-sidedness.
//
// Read straight from the file's JSON, images decoded by stb_image (PNG and JPEG) under size caps.
// Whatever cannot be read (KTX, WebP, a missing file) leaves its texture out, with a warning: a
// character is always drawn.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "viewer/image.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace limber::viewer {

enum class AlphaMode { kOpaque, kMask, kBlend };

struct MaterialTexture {
  int image = -1;  // in MaterialSet::images, -1 for none
  bool repeat_u = true, repeat_v = true;
  bool nearest = false;  // magnification filter
};

struct Material {
  std::array<float, 4> base_color = {1, 1, 1, 1};  // linear
  MaterialTexture base_color_texture, normal_texture;
  float normal_scale = 1;
  float roughness = 0.6f, metallic = 0;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;
  // For colours that carry data; no glTF file asks for them.
  float shading = 1;      // how much of the light shows: 0 none, as if unlit, 1 all
  bool contours = false;  // a thin dark line at each tenth of the texture coordinate u
};

struct MaterialSet {
  Vector<Material> materials;  // in the file's order
  Vector<Image> images;        // those in use, decoded
  Vector<std::string> warnings;
};

// The material of primitives without one: matt clay.
Material DefaultMaterial();

// `path`: .glb or .gltf. A file without materials gives an empty set.
// Errors: kNotFound, kMalformed, kLimitExceeded; never for a broken image.
Result<MaterialSet> ReadMaterials(const std::filesystem::path& path);

}  // namespace limber::viewer
