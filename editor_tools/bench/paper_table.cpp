#include "bench/paper_table.h"

#include "bench/made_character.h"
#include "core/vector.h"
#include "import/import_gltf.h"
#include "import/pack_obj.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace limber::bench {
namespace {

namespace fs = std::filesystem;

constexpr PaperRow kTable[] = {
    {"snake", 2, 817, 5, 2, true, 0.05, 0.01},
    {"caterpillar", 2, 481, 3, 2, true, 0.03, 0.005},
    {"starfish", 2, 3532, 3, 6, true, 0.65, 0.015},
    {"plant", 2, 3152, 3, 4, true, 0.8, 0.01},
    {"horse", 3, 8431, 3, 10, true, 30, 0.05},
    {"lion", 3, 5000, 6, 7, true, 5.0, 0.15},
    {"cat", 3, 7307, 6, 7, true, 8.0, 0.15},
    {"head", 3, 15941, 7, 6, false, 79, 0.17},
    {"face", 3, 23725, 6, 9, false, 74, 0.22},
};

// The rest shape first.
constexpr std::array kHorse = {"horse/horse_ref.obj", "horse/horse-01.obj", "horse/horse-02.obj",
                               "horse/horse-03.obj"};
constexpr std::array kLion = {"characters/lion-poses.glb"};
constexpr std::array kHead = {"characters/head-poses.glb"};

std::span<const char* const> FilesOf(std::string_view name) {
  if (name == "horse") return kHorse;
  if (name == "lion") return kLion;
  if (name == "head") return kHead;
  return {};
}

bool HasFilesOf(const PaperRow& row, const fs::path& data) {
  const auto files = FilesOf(row.name);
  std::error_code ignored;
  return !data.empty() && !files.empty() && fs::exists(data / files[0], ignored);
}

// As `limber pack` and `limber bake` would read them.
Result<bake::RawCharacter> ReadObjs(std::span<const char* const> files, const fs::path& data) {
  Vector<bake::ObjMesh> meshes;
  Vector<std::string> names;
  for (const char* file : files) {
    auto mesh = bake::ReadObj(data / file);
    if (!mesh.ok()) return mesh.status();
    meshes.push_back(std::move(*mesh));
    names.push_back(fs::path(file).stem().string());
  }
  const auto packed = bake::PackMeshes(meshes[0], std::span(meshes).subspan(1),
                                       std::span(names).subspan(1), names[0]);
  if (!packed.ok()) return packed.status();
  const auto gltf = GltfFile::Parse(*packed, (data / files[0]).string());
  if (!gltf.ok()) return gltf.status();
  return bake::ImportGltf(*gltf);
}

Result<bake::RawCharacter> ReadFiles(const PaperRow& row, const fs::path& data) {
  const auto files = FilesOf(row.name);
  const auto wanted = static_cast<size_t>(row.shapes);
  auto raw = files.size() > 1 ? ReadObjs(files.first(std::min(wanted, files.size())), data)
                              : bake::ImportGltf(data / files[0]);
  if (!raw.ok()) return raw;
  if (raw->shapes.size() < wanted) {
    return Error(StatusCode::kNoExamples, "%s: %zu shapes; the paper's %s has %zu",
                 (data / files[0]).c_str(), raw->shapes.size(), row.name, wanted);
  }
  raw->shapes.resize(wanted);
  raw->shape_names.resize(wanted);
  return raw;
}

}  // namespace

std::span<const PaperRow> PaperTable() {
  return kTable;
}

Result<PaperCharacter> CharacterOf(const PaperRow& row, const fs::path& data) {
  if (HasFilesOf(row, data)) {
    auto raw = ReadFiles(row, data);
    if (!raw.ok()) return raw.status();
    return PaperCharacter{std::move(*raw), true};
  }
  CharacterSize size;
  size.vertices = row.vertices;
  size.handles = row.handles;
  size.shapes = row.shapes;
  size.dimension = row.dimension;
  return PaperCharacter{MakeRawCharacter(size), false};
}

bool HasPaperMeshes(const fs::path& data) {
  for (const PaperRow& row : kTable) {
    if (HasFilesOf(row, data)) return true;
  }
  return false;
}

}  // namespace limber::bench
