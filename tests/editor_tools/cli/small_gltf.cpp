#include "small_gltf.h"

#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace limber::test {
namespace {

using Json = nlohmann::json;
using Points = Vector<std::array<float, 3>>;

// Collects binary data, and the accessors that describe it.
struct Builder {
  Json accessors = Json::array(), views = Json::array();
  std::string bin;

  int Add(const void* data, size_t num_bytes, Json accessor, int target) {
    while (bin.size() % 4 != 0)
      bin += '\0';
    views.push_back(
        {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", num_bytes}, {"target", target}});
    bin.append(static_cast<const char*>(data), num_bytes);
    accessor["bufferView"] = views.size() - 1;
    accessors.push_back(accessor);
    return static_cast<int>(accessors.size()) - 1;
  }

  int AddPoints(const Points& points) {
    std::array<float, 3> low = points[0], high = points[0];
    for (const auto& p : points) {
      for (size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    return Add(points.data(), points.size() * 12,
               {{"componentType", 5126},
                {"type", "VEC3"},
                {"count", points.size()},
                {"min", low},
                {"max", high}},
               34962);
  }

  int AddIndices(const Vector<uint32_t>& indices) {
    return Add(indices.data(), indices.size() * 4,
               {{"componentType", 5125}, {"type", "SCALAR"}, {"count", indices.size()}}, 34963);
  }
};

void AppendChunk(uint32_t type, std::string content, char padding, std::string* glb) {
  while (content.size() % 4 != 0)
    content += padding;
  const uint32_t header[2] = {static_cast<uint32_t>(content.size()), type};
  glb->append(reinterpret_cast<const char*>(header), 8);
  *glb += content;
}

}  // namespace

std::string SmallGltf::ToGlb() const {
  Builder builder;
  const int position = builder.AddPoints(positions);
  Json target_list = Json::array();
  for (const Points& target : targets) {
    target_list.push_back({{"POSITION", builder.AddPoints(target)}});
  }
  Json primitive = {{"attributes", {{"POSITION", position}}},
                    {"indices", builder.AddIndices(indices)},
                    {"targets", target_list}};
  Json primitives = {primitive};
  if (has_second_primitive) {
    primitive["targets"] = Json(Vector<Json>(
        target_list.begin(), target_list.begin() + static_cast<long>(targets_of_second)));
    primitives.push_back(primitive);
  }
  const Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "limber test"}}},
                     {"scene", 0},
                     {"scenes", {{{"nodes", {0}}}}},
                     {"nodes", {{{"mesh", 0}, {"name", "bar"}}}},
                     {"meshes", {{{"name", "bar"}, {"primitives", primitives}}}},
                     {"accessors", builder.accessors},
                     {"bufferViews", builder.views},
                     {"buffers", {{{"byteLength", builder.bin.size()}}}}};
  std::string glb("glTF\2\0\0\0\0\0\0\0", 12);
  AppendChunk(0x4E4F534A, gltf.dump(), ' ', &glb);
  AppendChunk(0x004E4942, builder.bin, '\0', &glb);
  const auto size = static_cast<uint32_t>(glb.size());
  std::memcpy(glb.data() + 8, &size, 4);
  return glb;
}

SmallGltf MakeBar(int length) {
  SmallGltf bar;
  for (int x = 0; x <= length; ++x) {
    for (int corner = 0; corner < 4; ++corner) {
      const float y = corner == 1 || corner == 2 ? 1.0f : 0.0f;
      const float z = corner >= 2 ? 1.0f : 0.0f;
      bar.positions.push_back({static_cast<float>(x), y, z});
    }
  }
  const auto quad = [&bar](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    bar.indices.insert(bar.indices.end(), {a, b, c, a, c, d});
  };
  const auto last = static_cast<uint32_t>(4 * length);
  for (uint32_t ring = 0; ring < last; ring += 4) {
    for (uint32_t corner = 0; corner < 4; ++corner) {
      const uint32_t next = (corner + 1) % 4;
      quad(ring + corner, ring + next, ring + 4 + next, ring + 4 + corner);
    }
  }
  quad(3, 2, 1, 0);
  quad(last, last + 1, last + 2, last + 3);
  Points bent, puffed;
  for (const auto& p : bar.positions) {
    const float along = p[0] / static_cast<float>(length);
    bent.push_back({0, 0.5f * static_cast<float>(length) * along * along, 0});
    const float swell = std::sin(3.14159265f * along);
    puffed.push_back({-0.2f * p[0], swell * (p[1] - 0.5f), swell * (p[2] - 0.5f)});
  }
  bar.targets = {bent, puffed};
  return bar;
}

}  // namespace limber::test
