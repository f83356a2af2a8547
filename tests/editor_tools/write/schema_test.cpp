// What the writer writes is what the extension's published schema says, no more and no less.
#include "bake/write_baked.h"
#include "core/vector.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "rig/rig_fields.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kSchemas = LIMBER_SOURCE_DIR "/content/extension/LIMBER_mesh_ik/schema";

bool HasType(const Json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  return type == "array" ? value.is_array() : value.is_object();
}

// The part of JSON Schema that these schemas use; unknown properties are findings too.
class SchemaChecker {
 public:
  void Check(const Json& value, Json schema, const std::string& place) {
    if (schema.contains("$ref"))
      schema = ReadGltfJson(kSchemas / schema["$ref"].get<std::string>());
    if (schema.contains("type") && !HasType(value, schema["type"])) {
      findings.push_back(place + ": not of type " + schema["type"].dump());
      return;
    }
    if (schema.contains("const") && value != schema["const"]) Note(place, "const");
    if (schema.contains("enum") &&
        std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end()) {
      Note(place, "enum");
    }
    if (schema.contains("minimum") && value < schema["minimum"]) Note(place, "minimum");
    if (schema.contains("exclusiveMinimum") && value <= schema["exclusiveMinimum"]) {
      Note(place, "exclusiveMinimum");
    }
    if (schema.contains("minItems") && value.size() < schema["minItems"]) Note(place, "minItems");
    if (schema.contains("maxItems") && value.size() > schema["maxItems"]) Note(place, "maxItems");
    for (const Json& name : schema.value("required", Json::array())) {
      if (!value.contains(name.get<std::string>())) Note(place, "missing " + name.dump());
    }
    if (value.is_array() && schema.contains("items")) {
      for (const Json& item : value)
        Check(item, schema["items"], place + "[]");
    }
    if (!value.is_object()) return;
    for (const auto& [name, member] : value.items()) {
      if (schema["properties"].contains(name)) {
        Check(member, schema["properties"][name], place + "." + name);
      } else {
        Note(place, "unknown " + name);
      }
    }
  }

  Vector<std::string> findings;

 private:
  void Note(const std::string& place, const std::string& what) {
    findings.push_back(place + ": " + what);
  }
};

Vector<std::string> Findings(const Json& extension, const char* schema) {
  SchemaChecker checker;
  checker.Check(extension, ReadGltfJson(kSchemas / schema), "");
  return checker.findings;
}

TEST(Schema, BakedFile_ConformsAndDamageIsFound) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path()), out = folder.path() / "out.glb";
  const auto raw = bake::ImportGltf(source);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const Status status = bake::WriteBaked(source, *raw, MakeSyntheticBake(*raw, {}), out);
  ASSERT_TRUE(status.ok()) << status.message();
  const Json root = ReadGltfJson(out);
  constexpr char kDocument[] = "glTF.LIMBER_mesh_ik.schema.json";
  Json extension = root["extensions"][kRigExtensionName];
  EXPECT_EQ(Findings(extension, kDocument), Vector<std::string>());
  EXPECT_EQ(extension["rigs"][0]["tables"].size(), 12u)
      << "every table of the schema is written, but groupHandles and groupFactors";
  EXPECT_EQ(Findings(root["nodes"][0]["extensions"][kRigExtensionName],
                     "node.LIMBER_mesh_ik.schema.json"),
            Vector<std::string>());
  extension["version"] = kRigFormatVersion + 1;
  extension["rigs"][0].erase("space");
  extension["rigs"][0]["handles"][0]["vertex"] = -1;
  extension["rigs"][0]["shapes"][0]["weight"] = 1;
  EXPECT_EQ(Findings(extension, kDocument).size(), 4u);
}

// A real bake has the tables that stand for others.
TEST(Schema, BakedCharacter_Conforms) {
  const TemporaryFolder folder;
  const fs::path source = LIMBER_SOURCE_DIR "/content/characters/square.glb";
  const fs::path out = folder.path() / "out.glb";
  const auto raw = bake::ImportGltf(source);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const auto baked = bake::Bake(*raw, raw->marked_handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  const Status status = bake::WriteBaked(source, *raw, *baked, out);
  ASSERT_TRUE(status.ok()) << status.message();
  const Json extension = ReadGltfJson(out)["extensions"][kRigExtensionName];
  EXPECT_EQ(Findings(extension, "glTF.LIMBER_mesh_ik.schema.json"), Vector<std::string>());
  const Json& tables = extension["rigs"][0]["tables"];
  EXPECT_TRUE(tables.contains("groupFactors") && tables.contains("groupHandles"));
  EXPECT_FALSE(tables.contains("singleEdges") || tables.contains("singleGroupFactors"));
}

}  // namespace
}  // namespace limber::test
