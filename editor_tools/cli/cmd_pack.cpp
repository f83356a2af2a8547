// limber pack: OBJ files of one topology, or moments of an animation -> a glTF with morph targets.
#include "animation/pack_clip.h"
#include "cli/command.h"
#include "core/printable.h"
#include "core/vector.h"
#include "import/file_output.h"
#include "import/pack_obj.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kFooter[] =
    R"(Example shapes come from OBJ files, or from moments of an animation.

OBJ files must have the same vertices and faces in the same order; only positions differ. BASE is the
mesh, each SHAPE a morph target named after its file. The glTF remembers vertex numbers and polygons,
so that `limber solve` writes meshes in the order of BASE.

Of an animated .glb or .gltf, moments of one clip become morph targets named CLIP@SECONDS: the mesh as
its skeleton (or the weights of its own morph targets) shapes it then, in mesh space of the bind pose.
Skin, clips and all else stay in the file; morph targets that the mesh has already come first.
  --times 0,0.1,0.25   these moments, in seconds from the clip's start
  --count N            N moments spread evenly; of a clip that ends as it began the end is left out,
                       of another one the last moment is its end
Travel of the skeleton's root is part of the shapes; --in-place takes its horizontal part out.

Examples:
  limber pack rest.obj bent.obj puffed.obj -o character.glb
  limber pack face/neutral.obj face/smile.obj face/frown.obj -o face.glb --name face
  limber pack walk.glb --clip Run --times 0,0.1,0.2 -o character.glb
  limber pack walk.glb --clip Run --count 8 --in-place --node Body -o character.glb
)";

struct PackCommandOptions {
  std::string base, output, times;
  Vector<std::string> shapes;
  bake::PackOptions pack;
  bake::PackClipOptions clip;
};

bool IsGltf(const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".glb" || extension == ".gltf";
}

// Numbers between commas; nothing where one of them is not a number.
std::optional<Vector<double>> ParseTimes(const std::string& text) {
  Vector<double> times;
  const char* at = text.data();
  const char* const text_end = text.data() + text.size();
  while (true) {
    double time = 0;
    const auto [end, error] = std::from_chars(at, text_end, time);
    if (error != std::errc()) return std::nullopt;
    times.push_back(time);
    if (end == text_end) return times;
    if (*end != ',') return std::nullopt;
    at = end + 1;
  }
}

// What is wrong with the command line: options of the other use, or none where one is needed.
std::string FindMisuse(const CLI::App& app, const PackCommandOptions& options) {
  if (IsGltf(options.base)) {
    if (!options.shapes.empty()) {
      return "SHAPE " + Quoted(options.shapes[0]) +
             ": BASE is a glTF, whose shapes are moments of a clip; see --times and --count";
    }
    if (app.count("--name") > 0) return "--name: a glTF keeps its own names; only for OBJ files";
    if (app.count("--times") + app.count("--count") == 0) {
      return "which moments of the clip? give --times or --count";
    }
    return "";
  }
  for (const char* option : {"--clip", "--times", "--count", "--node", "--in-place"}) {
    if (app.count(option) > 0) {
      return std::string(option) + ": only where BASE is an animated .glb or .gltf";
    }
  }
  if (options.shapes.empty()) return "SHAPE is required: at least one OBJ file beside BASE";
  return "";
}

// A name too many after -o must not turn an artist's shape into a glTF.
Status CheckOutput(const PackCommandOptions& options) {
  Vector<fs::path> inputs(options.shapes.begin(), options.shapes.end());
  inputs.emplace_back(options.base);
  LIMBER_RETURN_IF_ERROR(bake::CheckKeepsInputs(options.output, inputs));
  const std::string extension = fs::path(options.output).extension().string();
  const bool also_text = IsGltf(options.base);
  if (extension != ".glb" && !(also_text && extension == ".gltf")) {
    return Error(StatusCode::kInvalidArgument, "%s: output: the name must end with .glb%s",
                 options.output.c_str(), also_text ? " or .gltf" : "");
  }
  return bake::CheckOutputPlace(options.output);
}

uintmax_t FileSize(const std::string& file) {
  std::error_code ignored;
  return fs::file_size(file, ignored);
}

ExitCode PackObjFiles(const PackCommandOptions& options, const Console& console) {
  const Vector<fs::path> shapes(options.shapes.begin(), options.shapes.end());
  if (Status s = bake::PackObj(options.base, shapes, options.pack, options.output); !s.ok()) {
    return console.Fail(s);
  }
  const uintmax_t num_bytes = FileSize(options.output);
  console.Print("packed %zu morph targets -> %s (%.1f MB)", shapes.size(), options.output.c_str(),
                static_cast<double>(num_bytes) / 1e6);
  Json names = Json::array();
  for (const fs::path& shape : shapes)
    names.push_back(shape.stem().string());
  console.Emit({{"output", options.output}, {"bytes", num_bytes}, {"targets", names}});
  return kSuccess;
}

void PrintClipSummary(const bake::PackClipSummary& summary, const PackCommandOptions& options,
                      const Console& console) {
  std::string names;
  for (const std::string& name : summary.shape_names)
    names += (names.empty() ? "" : ", ") + Printable(name);
  const std::string kept = std::to_string(summary.num_old_targets) + " kept, ";
  console.Print("packed %zu moments of clip %s -> %s (%.1f MB)", summary.shape_names.size(),
                Quoted(summary.clip).c_str(), options.output.c_str(),
                static_cast<double>(FileSize(options.output)) / 1e6);
  console.Print("  clip     %.3f s%s", summary.clip_seconds,
                summary.loops ? ", ends as it began" : "");
  console.Print("  mesh     node %s, %zu vertices", Quoted(summary.node).c_str(),
                summary.num_vertices);
  console.Print("  targets  %s%zu new: %s", summary.num_old_targets > 0 ? kept.c_str() : "",
                summary.shape_names.size(), names.c_str());
}

ExitCode PackMoments(const PackCommandOptions& options, const Console& console) {
  const Result<bake::PackClipSummary> summary =
      bake::PackClip(options.base, options.clip, options.output);
  if (!summary.ok()) return console.Fail(summary.status());
  PrintClipSummary(*summary, options, console);
  console.Emit({{"output", options.output},
                {"bytes", FileSize(options.output)},
                {"clip", summary->clip},
                {"clip_seconds", summary->clip_seconds},
                {"loops", summary->loops},
                {"node", summary->node},
                {"vertices", summary->num_vertices},
                {"kept_targets", summary->num_old_targets},
                {"targets", summary->shape_names},
                {"warnings", summary->warnings}});
  console.Warn(summary->warnings);
  return kSuccess;
}

ExitCode RunPack(const CLI::App& app, PackCommandOptions options, const Console& console) {
  if (const std::string misuse = FindMisuse(app, options); !misuse.empty()) {
    return console.FailUsage(misuse + "; see limber pack --help");
  }
  if (app.count("--times") > 0) {
    const auto times = ParseTimes(options.times);
    if (!times.has_value()) {
      return console.FailUsage(
          "--times: " + Quoted(options.times) +
          " is no list of seconds, such as 0,0.1,0.25; see limber pack --help");
    }
    options.clip.times = *times;
  }
  if (Status s = CheckOutput(options); !s.ok()) return console.Fail(s);
  return IsGltf(options.base) ? PackMoments(options, console) : PackObjFiles(options, console);
}

void AddClipOptions(CLI::App* app, PackCommandOptions* options) {
  auto* times = app->add_option("--times", options->times, "Moments of the clip, in seconds")
                    ->option_text("T,T,...");
  app->add_option("--count", options->clip.count, "This many moments, spread over the clip")
      ->check(CLI::Range(1, 1024))
      ->excludes(times)
      ->option_text("N");
  app->add_option("--clip", options->clip.clip,
                  "The animation, by name or number, where the file has several")
      ->option_text("CLIP");
  app->add_option("--node", options->clip.node,
                  "The mesh's node, by name or number, where the clip deforms several")
      ->option_text("NODE");
  app->add_flag("--in-place", options->clip.in_place,
                "Without the horizontal travel of the skeleton's root");
}

}  // namespace

Command AddPackCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand(
      "pack", "Make a glTF with morph targets of OBJ files, or of moments of an animation");
  auto options = std::make_shared<PackCommandOptions>();
  app->add_option("BASE", options->base, "The mesh at rest (OBJ), or an animated .glb or .gltf")
      ->required()
      ->option_text(" ");
  app->add_option("SHAPE", options->shapes, "Its example shapes (OBJ)")->option_text("... ");
  app->add_option("-o,--output", options->output, "The .glb to write (of a glTF also .gltf)")
      ->required()
      ->option_text("FILE (required)");
  app->add_option("--name", options->pack.name,
                  "Name of the mesh, of OBJ files (default: that of BASE)")
      ->option_text("NAME");
  AddClipOptions(app, options.get());
  app->footer(kFooter);
  return {app, [app, options](const Console& console) { return RunPack(*app, *options, console); }};
}

}  // namespace limber::cli
