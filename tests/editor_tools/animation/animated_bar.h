// A bar with two joints and a clip, made in code: every pose of it is known in closed form.
#pragma once

#include "core/vector.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>

namespace limber::test {

// A glTF that grows accessor by accessor.
struct GltfParts {
  nlohmann::ordered_json json;
  Vector<uint8_t> bin;

  // Each returns the index of the accessor. type: "SCALAR", "VEC3", ...
  size_t AddFloats(const Vector<float>& numbers, const std::string& type);
  size_t AddPositions(const Vector<float>& numbers);  // VEC3 with bounds
  size_t AddShorts(const Vector<uint16_t>& numbers, const std::string& type);
  size_t AddNormalisedShorts(const Vector<int16_t>& numbers, const std::string& type);

  Vector<uint8_t> Glb() const;
  void Write(const std::filesystem::path& file) const;

 private:
  size_t Add(const void* data, size_t num_bytes, nlohmann::ordered_json accessor);
};

struct BarOptions {
  // mesh space = to_mesh * world at bind: FBX files bring 100 (centimetres) and a turn of axes.
  Eigen::Affine3d to_mesh = Eigen::Affine3d::Identity();
  bool two_sets = false;     // weights spread over JOINTS_0 and JOINTS_1
  float weight_sum = 1;      // of each vertex
  bool has_targets = false;  // two morph targets: "wide" (x) and "deep" (z)
};

// A square tube along y from 0 to 2, four vertices a ring, half as thick as wide. Joint "root" is
// at the origin below a turned and shifted node, joint "middle" its child at y = 1. Vertices below
// 0.75 follow root, above 1.25 middle, linearly between. The clip "Bend" (0 to 1 s, linear) turns
// middle about z by kBendAngle. Nodes: 0 armature, 1 root, 2 middle, 3 the mesh, itself shifted
// (which glTF ignores).
GltfParts MakeAnimatedBar(const BarOptions& options = {});

inline constexpr double kBendAngle = 1.2;  // radians
inline constexpr int kBarRootNode = 1, kBarMiddleNode = 2, kBarMeshNode = 3;

// World position at bind of each vertex, and its share of the joint "middle".
Vector<Eigen::Vector3d> BarPositions();
double MiddleWeight(const Eigen::Vector3d& position);

// Adds a channel with a sampler of its own to an animation; the path's values as they are.
void AddChannel(GltfParts* parts, size_t animation, int node, const std::string& path,
                const Vector<float>& times, const Vector<float>& values,
                const std::string& interpolation = "LINEAR");

}  // namespace limber::test
