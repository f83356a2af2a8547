// Text of a hostile file inside messages: one line, of bounded length, without control characters.
#include "core/vector.h"
#include "load/gltf_file.h"
#include "load/gltf_mesh.h"
#include "load/rig_loader.h"
#include "runtime/load/small_gltf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

// `head`, then c two hundred thousand times.
std::string Long(std::string head, char c) {
  head.append(200000, c);
  return head;
}

const std::string kEvil = Long("x\n\x1B[31merror: all is lost\r\t", 'y');

void ExpectHarmless(const Status& status, const char* what) {
  ASSERT_FALSE(status.ok()) << what;
  const std::string& text = status.message();
  EXPECT_LT(text.size(), 600u) << what;
  EXPECT_TRUE(std::none_of(text.begin(), text.end(),
                           [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
      << what << ": " << text.substr(0, 1000);
  EXPECT_EQ(text.rfind("test.gltf: ", 0), 0u) << what << ": " << text.substr(0, 1000);
}

Status ReadAll(const SmallGltf& gltf) {
  const auto file = gltf.Parse();
  if (!file.ok()) return file.status();
  if (const auto mesh = ReadMorphMesh(*file, 0); !mesh.ok()) return mesh.status();
  return LoadRig(*file).status();
}

TEST(Message, TextOfTheFile_CannotBreakTheLine) {
  struct Case {
    const char* what;
    std::function<void(Json*)> bend;
  };

  const Case cases[] = {
      {"asset version", [](Json* j) { (*j)["asset"]["version"] = kEvil; }},
      {"required extension", [](Json* j) { (*j)["extensionsRequired"] = {kEvil}; }},
      {"buffer URI", [](Json* j) { (*j)["buffers"][0]["uri"] = kEvil; }},
      {"buffer URI that leads out", [](Json* j) { (*j)["buffers"][0]["uri"] = "../" + kEvil; }},
      {"attribute", [](Json* j) { (*j)["meshes"][0]["primitives"][0]["attributes"][kEvil] = 99; }},
      {"attribute's value",
       [](Json* j) { (*j)["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = kEvil; }},
      {"child", [](Json* j) { (*j)["nodes"][0]["children"] = {kEvil}; }},
      {"array for a child",
       [](Json* j) { (*j)["nodes"][0]["children"] = {Json(Vector<int>(100000, 7))}; }},
      {"mesh without targets",
       [](Json* j) {
         (*j)["meshes"][0]["name"] = kEvil;
         (*j)["meshes"][0]["primitives"][0].erase("targets");
       }},
      {"format version", [](Json* j) { (*j)["extensions"]["LIMBER_mesh_ik"]["version"] = kEvil; }},
  };
  for (const Case& c : cases) {
    SmallGltf gltf;
    c.bend(&gltf.json);
    ExpectHarmless(ReadAll(gltf), c.what);
  }
}

TEST(Message, TextOfTheRig_CannotBreakTheLine) {
  const Json good = {
      {"name", "r"},
      {"mesh", {{"vertices", 3}, {"solveVertices", 3}, {"hash", kEvil}}},
      {"dimension", 3},
      {"groups", 1},
      {"modes", 1},
      {"singleModes", 1},
      {"residualRank", 1},
      {"space", {{"origin", {0, 0, 0}}, {"scale", 1}, {"basis", {1, 0, 0, 0, 1, 0, 0, 0, 1}}}},
      {"handles", {{{"name", kEvil}, {"vertex", 0}, {"position", {0, 0, 0}}}}},
      {"shapes", {{{"name", kEvil}}}},
      {"tables", Json::object()}};
  const auto status_with = [&good](const char* member, const Json& value) {
    SmallGltf gltf;
    Json rig = good;
    if (*member != '\0') rig[Json::json_pointer(member)] = value;
    gltf.json["extensions"]["LIMBER_mesh_ik"] = {{"version", 1}, {"rigs", {rig}}};
    gltf.json["nodes"][0]["extensions"]["LIMBER_mesh_ik"] = {{"rig", 0}};
    gltf.json["meshes"][0]["name"] = kEvil;
    return ReadAll(gltf);
  };
  const Status changed = status_with("", {});
  ExpectHarmless(changed, "mesh name and hash");
  EXPECT_EQ(changed.code(), StatusCode::kMeshMismatch) << changed.message();
  ExpectHarmless(status_with("/groups", kEvil), "text for a number");
  ExpectHarmless(status_with("/groups", Json(Vector<int>(100000, 7))), "array for a number");
  ExpectHarmless(status_with("/rotations", kEvil), "text for a Boolean");
  ExpectHarmless(status_with("/tables", Json{{kEvil, 1}}), "name of a table");
}

TEST(Message, JsonThatIsNone_IsNotRepeatedAtLength) {
  const std::string text = Long(R"({"asset": {"version": ")", 'y');
  ExpectHarmless(ParseText(text).status(), "string without an end");
  ExpectHarmless(ParseText("{\"a\": \"\x1B[2J\"}").status(), "control character");
  ExpectHarmless(ParseText(Long("{\"a\": ", '1').append("x}")).status(), "number");
}

}  // namespace
}  // namespace limber::test
