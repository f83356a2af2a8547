#include "include_rules.h"

#include "core/vector.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

// A room and the other rooms of its own half that it may include. Rooms of editor_tools may
// include any room of runtime as well; those of runtime never one of editor_tools.
const std::map<std::string, Names> kRuntimeRooms = {
    {"include", {}},
    {"core", {}},
    {"rig", {"core"}},
    {"load", {"core", "rig"}},
    {"clips", {"core", "rig", "load"}},
    {"skin", {"core", "rig"}},
    {"solve", {"core", "rig", "skin"}},
    {"drive", {"core", "rig", "skin", "solve"}},
    {"ray", {"core"}},
    {"pick", {"core", "rig", "skin", "ray"}},
    {"skin_vulkan", {"core", "rig", "skin"}},
    {"capi", {"core", "rig", "load", "clips", "solve", "skin", "drive", "ray", "limber"}},
    {"capi_vulkan", {"core", "rig", "solve", "skin", "skin_vulkan", "capi", "limber"}},
};
const std::map<std::string, Names> kToolRooms = {
    {"threads", {}},
    {"linear", {"threads"}},
    {"geometry", {}},
    {"import", {"geometry"}},
    {"gltf_edit", {"import"}},
    {"animation", {"import", "gltf_edit"}},
    {"bake", {"threads", "linear", "geometry", "import", "gltf_edit"}},
    {"deform", {"threads", "linear", "geometry", "bake"}},
    {"bench", {"geometry", "import", "bake"}},
    {"viewer", {}},
    {"inspect", {"viewer"}},
    {"cli",
     {"geometry", "import", "bake", "deform", "bench", "viewer", "inspect", "gltf_edit",
      "animation"}},
};

bool Matches(const std::string& text, const char* pattern) {
  return std::regex_search(text, std::regex(pattern));
}

// What no file of the room may include from outside the project; empty where all is well.
std::string ForeignViolation(const std::string& half, const std::string& room,
                             const std::string& included) {
  if (Matches(included, "tiny_?gltf") && room != "load" && room != "import") {
    return "only load and import see tinygltf";
  }
  if (Matches(included, "^(vulkan/|volk\\.h)") && room != "skin_vulkan" && room != "viewer" &&
      room != "include") {
    return "only skin_vulkan, viewer and limber_vulkan.h see Vulkan";
  }
  if (Matches(included, "^embree") && room != "pick") return "only pick sees Embree";
  if (Matches(included, "^(GLFW/|imgui)") && room != "viewer") {
    return "only viewer sees windows";
  }
  if (half == "runtime" && Matches(included, "^nlohmann/") && room != "load" && room != "clips") {
    return "only load and clips parse JSON in the runtime";
  }
  if (half == "runtime" && Matches(included, "^CLI/")) return "the runtime has no command line";
  return "";
}

std::string Violation(const std::string& half, const std::string& room,
                      const std::string& included) {
  if (included.find("..") != std::string::npos) return "climbs out of its folder with ..";
  const std::string first = included.substr(0, included.find('/'));
  const bool into_tools = kToolRooms.contains(first) || first == "editor_tools";
  if (half == "runtime" && into_tools) return "runtime never includes editor_tools";
  const auto& rooms = half == "runtime" ? kRuntimeRooms : kToolRooms;
  const auto allowed = rooms.find(room);
  if (allowed == rooms.end()) return "room '" + room + "' is missing in include_rules.cpp";
  if (rooms.contains(first) && first != room && !allowed->second.contains(first)) {
    return room + " may not include " + first;
  }
  return ForeignViolation(half, room, included);
}

void CheckFile(const fs::path& source_folder, const fs::path& file, IncludeReport* report) {
  const fs::path relative = file.lexically_relative(source_folder);
  const std::string half = relative.begin()->string();
  const std::string room = std::next(relative.begin())->string();
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, kInclude)) continue;
    ++report->num_includes;
    const std::string reason = Violation(half, room, match[1].str());
    if (reason.empty()) continue;
    report->violations.push_back(relative.string() + ":" + std::to_string(number) + ": " + reason +
                                 ": " + match[1].str());
  }
  ++report->num_files;
}

}  // namespace

Vector<fs::path> SourcesBelow(const fs::path& folder, const Vector<std::string>& extensions) {
  Vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    const std::string extension = entry.path().extension().string();
    const bool wanted = std::count(extensions.begin(), extensions.end(), extension) > 0;
    const bool foreign = entry.path().string().find("node_modules") != std::string::npos;
    if (entry.is_regular_file() && wanted && !foreign) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

IncludeReport CheckIncludes(const fs::path& source_folder) {
  IncludeReport report;
  for (const char* half : {"runtime", "editor_tools"}) {
    for (const fs::path& file : SourcesBelow(source_folder / half, {".h", ".hpp", ".c", ".cpp"})) {
      CheckFile(source_folder, file, &report);
    }
  }
  return report;
}

}  // namespace limber::test
