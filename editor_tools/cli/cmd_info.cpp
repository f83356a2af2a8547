// limber info: what a source or a baked glTF holds.
#include "bake/bake.h"
#include "cli/command.h"
#include "cli/cost_text.h"
#include "core/vector.h"
#include "import/import_gltf.h"
#include "load/gltf_accessor.h"
#include "load/gltf_file.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace limber::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFooter[] =
    R"(For a source: the mesh that `limber bake` would take, its shapes, its marked handles, and what a bake
would cost: with the marked handles, or with as many as --auto-handles says.
For a baked file: the same, and the reduced model with its sizes in memory.

Examples:
  limber info horse.glb
  limber info horse.glb --auto-handles 24      what would that cost?
  limber info horse_baked.glb --json
)";

struct InfoOptions {
  std::string file, node;
  // Of a bake that is thought of, for a source.
  int num_handles = 0, num_groups = 0;
  bool no_rotations = false;
};

std::string Joined(const Json& names) {
  constexpr size_t kMostListed = 16;
  std::string text;
  for (size_t i = 0; i < names.size() && i < kMostListed; ++i) {
    text += (i == 0 ? "" : ", ") + names[i].get<std::string>();
  }
  return names.size() > kMostListed ? text + ", ..." : text;
}

Json HandleNames(const Json& handles) {
  Json names = Json::array();
  for (const Json& handle : handles) {
    const bool pinned = handle["pinned"].get<bool>();
    names.push_back(handle["name"].get<std::string>() + (pinned ? "" : " (free)"));
  }
  return names;
}

// The rig that a bake would make of a source; no handles where nothing says how many.
bake::RigSize ThoughtOf(const bake::RawCharacter& raw, const InfoOptions& options) {
  bake::RigSize size;
  size.num_handles =
      options.num_handles > 0 ? options.num_handles : static_cast<int>(raw.marked_handles.size());
  size.num_shapes = static_cast<int>(raw.shapes.size());
  size.num_groups =
      options.num_groups > 0 ? options.num_groups : bake::kGroupsPerHandle * size.num_handles;
  size.rotations = !options.no_rotations;
  size.num_vertices = size.num_draw_vertices = raw.num_draw_vertices();
  return size;
}

Json SourceJson(const bake::RawCharacter& raw, const InfoOptions& options) {
  Json handles = Json::array();
  for (const bake::HandleSpec& handle : raw.marked_handles) {
    handles.push_back({{"name", handle.name}, {"pinned", handle.pinned}, {"node", handle.node}});
  }
  Json json = {{"file", raw.file},
               {"baked", false},
               {"name", raw.name},
               {"node", raw.node},
               {"draw_vertices", raw.num_draw_vertices()},
               {"source_vertices", raw.num_source_vertices},
               {"triangles", raw.triangles.size() / 3},
               {"primitives", raw.primitives.size()},
               {"normals", !raw.normals.empty()},
               {"tangents", !raw.tangents.empty()},
               {"texcoords", !raw.texcoords.empty()},
               {"shapes", raw.shape_names},
               {"handles", handles},
               {"warnings", raw.warnings}};
  const bake::RigSize size = ThoughtOf(raw, options);
  if (size.num_handles > 0) {
    json["cost"] = CostJson(bake::EstimateCost(size));
    json["cost"]["handles"] = size.num_handles;
    json["cost"]["groups"] = size.num_groups;
  }
  return json;
}

uint64_t ModelBytes(const RigTables& tables) {
  uint64_t num_floats = 0;
  VisitRigTables(tables, [&](const char*, const Vector<float>& table, const auto&) {
    num_floats += table.size();
  });
  return num_floats * sizeof(float);
}

uint64_t MeshBytes(const SkinMesh& mesh) {
  return mesh.weights.size() * sizeof(float) + mesh.shape_positions.size() * sizeof(Vec3) +
         mesh.rest_normals.size() * sizeof(Vec3) +
         (mesh.rest_tangents.size() + mesh.texcoords.size()) * sizeof(float) +
         (mesh.solve_vertex.size() + mesh.triangles.size() + mesh.source_vertex.size()) *
             sizeof(uint32_t);
}

// Where each example shape has a vertex, in mesh space: targets that bring that example back.
Json ExamplePositions(const Rig& rig, uint32_t vertex) {
  const SkinMesh& mesh = rig.mesh();
  Json positions = Json::array();
  for (size_t s = 0; s < static_cast<size_t>(mesh.num_shapes); ++s) {
    const Vec3 p = rig.ToMesh(mesh.shape_positions[s * mesh.num_solve_vertices + vertex]);
    positions.push_back({p.x, p.y, p.z});
  }
  return positions;
}

// What the rig's tables take in the file, packed or not.
uint64_t TableBytesInFile(const GltfFile& file, const Json& rig) {
  constexpr uint64_t kFloatBytes = 4;
  uint64_t bytes = 0;
  for (const Json& table : rig["tables"]) {
    const auto count = static_cast<uint64_t>(AccessorCount(file, table["accessor"].get<int>()));
    bytes += count * (table.contains("exponent") ? 1 : kFloatBytes);
  }
  return bytes;
}

bake::RigCost CostOf(const GltfFile& file, const Rig& rig, int rig_index) {
  const Json& json =
      file.json()["extensions"][kRigExtensionName]["rigs"][static_cast<size_t>(rig_index)];
  return bake::EstimateCost(rig.tables(), TableBytesInFile(file, json),
                            rig.mesh().num_solve_vertices, rig.mesh().num_draw_vertices);
}

Json BakedJson(const GltfFile& file, const Rig& rig, int rig_index, const bake::RigCost& cost) {
  const RigTables& tables = rig.tables();
  const SkinMesh& mesh = rig.mesh();
  const Json& extension = file.json()["extensions"][kRigExtensionName];
  Json handles = Json::array();
  for (const RigHandle& handle : tables.handles) {
    const Vec3& p = handle.rest_position;
    handles.push_back({{"name", handle.name},
                       {"pinned", handle.pinned},
                       {"node", handle.node},
                       {"vertex", handle.vertex},
                       {"rest", {p.x, p.y, p.z}},
                       {"examples", ExamplePositions(rig, handle.vertex)}});
  }
  return {{"file", file.name()},
          {"baked", true},
          {"version", extension["version"]},
          {"mesh_hash", extension["rigs"][static_cast<size_t>(rig_index)]["mesh"]["hash"]},
          {"name", rig.name()},
          {"node", FindRigNode(file, rig_index)},
          {"dimension", tables.dimension},
          {"draw_vertices", mesh.num_draw_vertices},
          {"solve_vertices", mesh.num_solve_vertices},
          {"source_vertices", mesh.num_source_vertices},
          {"triangles", mesh.num_triangles()},
          {"primitives", mesh.primitives.size()},
          {"diagonal", rig.diagonal()},
          {"shapes", tables.shape_names},
          {"handles", handles},
          {"groups", tables.num_groups},
          {"modes", tables.num_modes},
          {"rotations", tables.has_rotations},
          {"model_bytes", ModelBytes(tables)},
          {"mesh_bytes", MeshBytes(mesh)},
          {"cost", CostJson(cost)}};
}

void PrintSource(const Json& info, const Console& console) {
  console.Print("%s: mesh \"%s\", not baked", info["file"].get<std::string>().c_str(),
                info["name"].get<std::string>().c_str());
  console.Print("  mesh     %d vertices, %d triangles, %d primitives",
                info["draw_vertices"].get<int>(), info["triangles"].get<int>(),
                info["primitives"].get<int>());
  console.Print("  shapes   %zu: %s", info["shapes"].size(), Joined(info["shapes"]).c_str());
  if (info["handles"].empty()) {
    console.Print("  handles  none marked; bake with --handles FILE or --auto-handles N");
  } else {
    console.Print("  handles  %zu marked: %s", info["handles"].size(),
                  Joined(HandleNames(info["handles"])).c_str());
  }
}

void PrintThoughtOf(const bake::RigSize& size, const Console& console) {
  if (size.num_handles == 0) {
    console.Print("  cost     known for a number of handles: ask with --auto-handles N");
    return;
  }
  console.Print("  cost     at most, with %d handles and %d edge groups%s: %s", size.num_handles,
                size.num_groups, size.rotations ? "" : ", without rotations",
                CostText(bake::EstimateCost(size)).c_str());
  if (const Status status = bake::CheckRigSize(size); !status.ok())
    console.Print("  refused  %s", status.message().c_str());
}

void PrintBaked(const Json& info, const bake::RigCost& cost, const Console& console) {
  console.Print("%s: \"%s\", baked (%s version %d)", info["file"].get<std::string>().c_str(),
                info["name"].get<std::string>().c_str(), kRigExtensionName,
                info["version"].get<int>());
  console.Print("  mesh     %d vertices (%d for drawing), %d triangles, %d primitives, %s",
                info["solve_vertices"].get<int>(), info["draw_vertices"].get<int>(),
                info["triangles"].get<int>(), info["primitives"].get<int>(),
                info["dimension"] == 2 ? "planar" : "3D");
  console.Print("  shapes   %zu: %s", info["shapes"].size(), Joined(info["shapes"]).c_str());
  console.Print("  handles  %zu: %s", info["handles"].size(),
                Joined(HandleNames(info["handles"])).c_str());
  console.Print("  model    %d edge groups, %d modes%s", info["groups"].get<int>(),
                info["modes"].get<int>(),
                info["rotations"].get<bool>() ? "" : ", without rotations");
  console.Print("  tables   %.2f MB, and %.2f MB of mesh", info["model_bytes"].get<double>() / 1e6,
                info["mesh_bytes"].get<double>() / 1e6);
  console.Print("  cost     %s", CostText(cost).c_str());
  console.Print("  hash     %s", info["mesh_hash"].get<std::string>().c_str());
}

ExitCode InfoOfSource(const GltfFile& file, const InfoOptions& options, const Console& console) {
  bake::ImportOptions import_options;
  import_options.node = options.node;
  const Result<bake::RawCharacter> raw = bake::ImportGltf(file, import_options);
  if (!raw.ok()) return console.Fail(raw.status());
  const Json info = SourceJson(*raw, options);
  PrintSource(info, console);
  PrintThoughtOf(ThoughtOf(*raw, options), console);
  console.Emit(info);
  console.Warn(raw->warnings);
  return kSuccess;
}

ExitCode InfoOfBaked(const GltfFile& file, int num_rigs, const Console& console) {
  Json infos = Json::array();
  Vector<bake::RigCost> costs;
  for (int i = 0; i < num_rigs; ++i) {
    RigLoadOptions load_options;
    load_options.rig_index = i;
    const auto rig = LoadRig(file, load_options);
    if (!rig.ok()) return console.Fail(rig.status());
    costs.push_back(CostOf(file, **rig, i));
    infos.push_back(BakedJson(file, **rig, i, costs.back()));
  }
  for (size_t i = 0; i < costs.size(); ++i)
    PrintBaked(infos[i], costs[i], console);
  console.Emit(num_rigs == 1 ? infos[0] : Json{{"baked", true}, {"rigs", infos}});
  return kSuccess;
}

ExitCode RunInfo(const InfoOptions& options, const Console& console) {
  const Result<GltfFile> file = GltfFile::Open(options.file);
  if (!file.ok()) return console.Fail(file.status());
  const int num_rigs = CountRigs(*file);
  return num_rigs > 0 ? InfoOfBaked(*file, num_rigs, console)
                      : InfoOfSource(*file, options, console);
}

}  // namespace

Command AddInfoCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("info", "Say what a source or baked glTF holds");
  auto options = std::make_shared<InfoOptions>();
  app->add_option("FILE", options->file, "A .glb or .gltf, baked or not")
      ->required()
      ->option_text(" ");
  app->add_option("--node", options->node,
                  "The mesh's node, by name or number, where a source has several")
      ->option_text("NODE");
  app->add_option("--auto-handles", options->num_handles,
                  "Of a source: what a bake with so many handles would cost")
      ->check(CLI::Range(1, 1024))
      ->option_text("N");
  app->add_option("--groups", options->num_groups, "and with so many edge groups")
      ->check(CLI::Range(1, 4096))
      ->option_text("N");
  app->add_flag("--no-rotations", options->no_rotations, "and without rotations");
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunInfo(*options, console); }};
}

}  // namespace limber::cli
