#include "editor_tools/animation/animated_bar.h"

#include "core/vector.h"
#include "import/file_output.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kNumRings = 17;

size_t NumComponents(const std::string& type) {
  static const std::map<std::string, size_t> kComponents = {
      {"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  return kComponents.at(type);
}

Json Description(int component_type, size_t num_numbers, const std::string& type) {
  return {{"componentType", component_type},
          {"count", num_numbers / NumComponents(type)},
          {"type", type}};
}

void Append(const Eigen::Vector3d& v, Vector<float>* numbers) {
  for (int axis = 0; axis < 3; ++axis)
    numbers->push_back(static_cast<float>(v[axis]));
}

Vector<uint16_t> BarTriangles() {
  Vector<uint16_t> triangles;
  for (int ring = 0; ring + 1 < kNumRings; ++ring) {
    for (int side = 0; side < 4; ++side) {
      const int a = 4 * ring + side, b = 4 * ring + (side + 1) % 4;
      for (const int corner : {a, a + 4, b, b, a + 4, b + 4})
        triangles.push_back(static_cast<uint16_t>(corner));
    }
  }
  return triangles;
}

// Joints and weights, in one set or spread over two.
void AddInfluences(const BarOptions& options, GltfParts* parts, Json* attributes) {
  Vector<uint16_t> joints[2];
  Vector<float> weights[2];
  for (const Eigen::Vector3d& p : BarPositions()) {
    const auto middle = static_cast<float>(MiddleWeight(p)) * options.weight_sum;
    const float root = options.weight_sum - middle;
    const size_t other = options.two_sets ? 1 : 0;
    const size_t place = options.two_sets ? 0 : 1;
    std::array<std::array<float, 4>, 2> w = {};
    std::array<std::array<uint16_t, 4>, 2> j = {};
    w[0][0] = root;
    w[other][place] = middle;
    if (middle > 0) j[other][place] = 1;
    for (size_t set = 0; set < 2; ++set) {
      weights[set].insert(weights[set].end(), w[set].begin(), w[set].end());
      joints[set].insert(joints[set].end(), j[set].begin(), j[set].end());
    }
  }
  for (size_t set = 0; set < (options.two_sets ? 2u : 1u); ++set) {
    (*attributes)["JOINTS_" + std::to_string(set)] = parts->AddShorts(joints[set], "VEC4");
    (*attributes)["WEIGHTS_" + std::to_string(set)] = parts->AddFloats(weights[set], "VEC4");
  }
}

Json BarTargets(const BarOptions& options, GltfParts* parts) {
  Json targets = Json::array();
  for (const int axis : {0, 2}) {
    Vector<float> offsets;
    for (const Eigen::Vector3d& p : BarPositions()) {
      Eigen::Vector3d offset = Eigen::Vector3d::Zero();
      offset[axis] = 0.5 * p[axis];
      Append(options.to_mesh.linear() * offset, &offsets);
    }
    targets.push_back({{"POSITION", parts->AddPositions(offsets)}});
  }
  return targets;
}

// The world place of the joints at bind: the armature's, and root and middle in it.
Eigen::Affine3d ArmatureTransform() {
  Eigen::Affine3d armature = Eigen::Affine3d::Identity();
  armature.translate(Eigen::Vector3d(0.5, 0, -1));
  armature.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  return armature;
}

size_t AddInverseBind(const BarOptions& options, GltfParts* parts) {
  Vector<float> numbers;
  for (const double height : {0.0, 1.0}) {
    Eigen::Affine3d joint = Eigen::Affine3d::Identity();
    joint.translate(Eigen::Vector3d(0, height, 0));
    const Eigen::Matrix4d inverse = (joint.inverse() * options.to_mesh.inverse()).matrix();
    for (int i = 0; i < 16; ++i)
      numbers.push_back(i % 4 == 3 ? (i == 15 ? 1.0f : 0.0f) : float(inverse.data()[i]));
  }
  return parts->AddFloats(numbers, "MAT4");
}

}  // namespace

size_t GltfParts::Add(const void* data, size_t num_bytes, Json accessor) {
  bin.resize((bin.size() + 3) / 4 * 4);
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", num_bytes}});
  const auto* bytes = static_cast<const uint8_t*>(data);
  bin.insert(bin.end(), bytes, bytes + num_bytes);
  accessor["bufferView"] = json["bufferViews"].size() - 1;
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}

size_t GltfParts::AddFloats(const Vector<float>& numbers, const std::string& type) {
  Json accessor = Description(5126, numbers.size(), type);
  // Animation inputs need their bounds; they do no harm to other scalars.
  if (type == "SCALAR") {
    accessor["min"] = Json::array({*std::min_element(numbers.begin(), numbers.end())});
    accessor["max"] = Json::array({*std::max_element(numbers.begin(), numbers.end())});
  }
  return Add(numbers.data(), 4 * numbers.size(), std::move(accessor));
}

size_t GltfParts::AddPositions(const Vector<float>& numbers) {
  Json accessor = Description(5126, numbers.size(), "VEC3");
  Vector<float> low(numbers.begin(), numbers.begin() + 3), high = low;
  for (size_t i = 0; i < numbers.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], numbers[i]);
    high[i % 3] = std::max(high[i % 3], numbers[i]);
  }
  accessor["min"] = low;
  accessor["max"] = high;
  return Add(numbers.data(), 4 * numbers.size(), std::move(accessor));
}

size_t GltfParts::AddShorts(const Vector<uint16_t>& numbers, const std::string& type) {
  return Add(numbers.data(), 2 * numbers.size(), Description(5123, numbers.size(), type));
}

size_t GltfParts::AddNormalisedShorts(const Vector<int16_t>& numbers, const std::string& type) {
  Json accessor = Description(5122, numbers.size(), type);
  accessor["normalized"] = true;
  return Add(numbers.data(), 2 * numbers.size(), std::move(accessor));
}

Vector<uint8_t> GltfParts::Glb() const {
  Json whole = json;
  whole["buffers"] = Json::array({{{"byteLength", (bin.size() + 3) / 4 * 4}}});
  return bake::AssembleGlb(whole.dump(), bin).value();
}

void GltfParts::Write(const std::filesystem::path& file) const {
  const Vector<uint8_t> bytes = Glb();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

Vector<Eigen::Vector3d> BarPositions() {
  constexpr std::array<std::array<double, 2>, 4> kRing = {
      {{0.2, 0.1}, {0.2, -0.1}, {-0.2, -0.1}, {-0.2, 0.1}}};
  Vector<Eigen::Vector3d> positions;
  for (int ring = 0; ring < kNumRings; ++ring) {
    for (const auto& [x, z] : kRing)
      positions.emplace_back(x, 2.0 * ring / (kNumRings - 1), z);
  }
  return positions;
}

double MiddleWeight(const Eigen::Vector3d& position) {
  return std::clamp((position.y() - 0.75) / 0.5, 0.0, 1.0);
}

void AddChannel(GltfParts* parts, size_t animation, int node, const std::string& path,
                const Vector<float>& times, const Vector<float>& values,
                const std::string& interpolation) {
  const std::string type = path == "rotation" ? "VEC4" : path == "weights" ? "SCALAR" : "VEC3";
  const size_t input = parts->AddFloats(times, "SCALAR");
  const size_t output = parts->AddFloats(values, type);
  Json& json = parts->json["animations"][animation];
  json["samplers"].push_back(
      {{"input", input}, {"output", output}, {"interpolation", interpolation}});
  json["channels"].push_back(
      {{"sampler", json["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

GltfParts MakeAnimatedBar(const BarOptions& options) {
  GltfParts parts;
  parts.json = {{"asset", {{"version", "2.0"}}},
                {"scene", 0},
                {"scenes", Json::array({{{"nodes", {0, 3}}}})},
                {"bufferViews", Json::array()},
                {"accessors", Json::array()}};
  Vector<float> positions, normals;
  for (const Eigen::Vector3d& p : BarPositions()) {
    Append(options.to_mesh * p, &positions);
    Append((options.to_mesh.linear() * Eigen::Vector3d(p.x(), 0, p.z())).normalized(), &normals);
  }
  Json attributes = {{"POSITION", parts.AddPositions(positions)},
                     {"NORMAL", parts.AddFloats(normals, "VEC3")}};
  AddInfluences(options, &parts, &attributes);
  Json primitive = {{"attributes", attributes},
                    {"indices", parts.AddShorts(BarTriangles(), "SCALAR")}};
  Json mesh = {{"name", "bar"}, {"primitives", Json::array({primitive})}};
  if (options.has_targets) {
    mesh["primitives"][0]["targets"] = BarTargets(options, &parts);
    mesh["weights"] = {0.0, 0.0};
    mesh["extras"] = {{"targetNames", {"wide", "deep"}}};
  }
  parts.json["meshes"] = Json::array({mesh});
  const Eigen::Affine3d armature = ArmatureTransform();
  const Eigen::Quaterniond turn(armature.rotation());
  const Eigen::Vector3d place = armature.translation();
  parts.json["nodes"] =
      Json::array({{{"name", "armature"},
                    {"children", {1}},
                    {"translation", {place.x(), place.y(), place.z()}},
                    {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}}},
                   {{"name", "root"}, {"children", {2}}},
                   {{"name", "middle"}, {"translation", {0, 1, 0}}},
                   {{"name", "Bar"}, {"mesh", 0}, {"skin", 0}, {"translation", {7, 7, 7}}}});
  parts.json["skins"] =
      Json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", AddInverseBind(options, &parts)}}});
  parts.json["animations"] = Json::array({{{"name", "Bend"}}});
  AddChannel(&parts, 0, kBarMiddleNode, "rotation", {0, 1},
             {0, 0, 0, 1, 0, 0, static_cast<float>(std::sin(kBendAngle / 2)),
              static_cast<float>(std::cos(kBendAngle / 2))});
  return parts;
}

}  // namespace limber::test
