// limber bake: a glTF with morph targets and handles -> a glTF that a game can drag.
#include "animation/painted_weights.h"
#include "bake/bake.h"
#include "bake/write_baked.h"
#include "cli/character_input.h"
#include "cli/command.h"
#include "cli/cost_text.h"
#include "cli/interrupt.h"
#include "cli/progress_bar.h"
#include "import/file_output.h"
#include "import/import_gltf.h"

#include <nlohmann/json.hpp>

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// Where the skinning weights come from.
constexpr char kComputedWeights[] = "computed", kHeatWeights[] = "heat", kSkinWeights[] = "skin",
               kColorWeights[] = "colors";

bool ArePainted(const std::string& weights) {
  return weights == kSkinWeights || weights == kColorWeights;
}

constexpr char kFooter[] =
    R"(Handles are the points that a game drags. They come from, in this order:
  --handles FILE       {"handles":[{"name":"tail","vertex":123},
                                   {"name":"knee","position":[x,y,z],"free":true}]}
                       vertex numbers count from 0 in the source's order; a position is in the mesh's
                       space and snaps to the nearest vertex; a free handle is not dragged, it adds
                       freedom; "stiffness":10 makes the region around a handle ten times as stiff
  --auto-handles N     N points spread over the extremities
  nodes of the glTF    whose extras say {"limber_handle":true}, or {"limber_handle":{"pinned":false}}
A painted map makes regions stiffer or softer: --stiffness COLOR_0 takes the first channel, black a
hundredth, mid-grey as it is, white a hundred times as stiff; a float attribute is the factor itself.
Everything else in the input file survives. Bake last: tools that rewrite the mesh afterwards make
the bake stale, which the loader notices and refuses. The same input gives the same bytes.

Examples:
  limber bake cat.glb -o cat_baked.glb                      handles marked in the file
  limber bake horse.glb -o horse_baked.glb --auto-handles 10
  limber bake hero.glb -o hero_baked.glb --weights skin       the joints are the handles
  limber bake face.glb -o face_baked.glb --handles face_handles.json --no-rotations
)";

struct BakeCommandOptions {
  std::string input, output, handle_file, node, stiffness, weights = kComputedWeights;
  int num_auto_handles = 0;
  bool no_base = false;
  bake::BakeOptions bake;
  bool no_rotations = false;
};

// Baking in place is allowed: nothing of the input is lost.
Status CheckWeights(const BakeCommandOptions& options) {
  if (options.weights != kSkinWeights ||
      (options.handle_file.empty() && options.num_auto_handles == 0)) {
    return {};
  }
  return Error(
      StatusCode::kInvalidArgument,
      "--weights skin: the joints are the handles; leave --handles and --auto-handles out");
}

Status CheckOutput(const BakeCommandOptions& options) {
  LIMBER_RETURN_IF_ERROR(bake::CheckOutputPlace(options.output));
  return bake::CheckKeepsInputs(options.output, std::array<fs::path, 1>{options.handle_file});
}

struct BakeSummary {
  HandleChoice handles;
  double seconds = 0;
};

Json WeightsJson(const BakeCommandOptions& options, const bake::BakedCharacter& baked) {
  Json handles = Json::array();
  for (size_t h = 0; h < baked.weights.handles.size(); ++h) {
    const bake::HandleOptimality& optimality = baked.weights.handles[h];
    handles.push_back({{"name", baked.tables.handles[h].name},
                       {"iterations", optimality.iterations},
                       {"converged", optimality.converged},
                       {"stationarity", optimality.stationarity},
                       {"complementarity", optimality.complementarity}});
  }
  const bake::InfluenceReport& influences = baked.influences;
  return {{"source", options.weights},
          {"bound_violation", baked.weights.bound_violation},
          {"stationarity", baked.weights.stationarity},
          {"complementarity", baked.weights.complementarity},
          {"handles", handles},
          {"influences",
           {{"most", influences.most},
            {"kept", influences.kept == 0 ? baked.tables.num_handles() : influences.kept},
            {"cut_vertices", influences.cut_vertices},
            {"largest_change", influences.largest_change},
            {"rms_change", influences.rms_change}}}};
}

std::string WeightsText(const BakeCommandOptions& options, const bake::BakedCharacter& baked) {
  if (options.weights == kHeatWeights) return "a preview: spread like heat, not the smoothest";
  if (options.weights == kSkinWeights) return "as painted, from the skin";
  if (options.weights == kColorWeights) return "as painted, from the vertex colours";
  if (baked.weights.handles.empty()) return "one everywhere, of the only handle";
  char text[256];
  std::snprintf(text, sizeof text, "optimal to %.1g of a handle's pull, duality gap %.1g",
                baked.weights.stationarity, baked.weights.complementarity);
  return text;
}

std::string InfluencesText(const bake::InfluenceReport& influences) {
  char text[256];
  int length = std::snprintf(text, sizeof text, "up to %d a vertex", influences.most);
  if (influences.kept > 0) {
    std::snprintf(text + length, sizeof text - static_cast<size_t>(length),
                  ", cut to %d: %lld vertices changed, by up to %.2g, %.2g in the mean square",
                  influences.kept, static_cast<long long>(influences.cut_vertices),
                  influences.largest_change, influences.rms_change);
  }
  return text;
}

Json SummaryJson(const BakeCommandOptions& options, const BakeSummary& summary,
                 const bake::BakedCharacter& baked) {
  Json handles = Json::array(), timings = Json::array();
  for (const RigHandle& handle : baked.tables.handles) {
    const Vec3& p = handle.rest_position;
    handles.push_back(
        {{"name", handle.name}, {"pinned", handle.pinned}, {"rest", {p.x, p.y, p.z}}});
  }
  for (const bake::BakeTiming& timing : baked.timings) {
    timings.push_back({{"stage", timing.stage}, {"seconds", timing.seconds}});
  }
  std::error_code ignored;
  return {{"input", options.input},
          {"output", options.output},
          {"bytes", fs::file_size(options.output, ignored)},
          {"dimension", baked.tables.dimension},
          {"draw_vertices", baked.mesh.num_draw_vertices},
          {"solve_vertices", baked.mesh.num_solve_vertices},
          {"triangles", baked.mesh.num_triangles()},
          {"shapes", baked.tables.shape_names},
          {"handle_source", summary.handles.source},
          {"handles", handles},
          {"groups", baked.tables.num_groups},
          {"modes", baked.tables.num_modes},
          {"rotations", baked.tables.has_rotations},
          {"weights", WeightsJson(options, baked)},
          {"cost", CostJson(baked.cost)},
          {"seconds", summary.seconds},
          {"timings", timings},
          {"warnings", baked.warnings}};
}

void PrintSummary(const BakeCommandOptions& options, const BakeSummary& summary,
                  const bake::BakedCharacter& baked, const Console& console) {
  const RigTables& tables = baked.tables;
  const SkinMesh& mesh = baked.mesh;
  std::string names, stages;
  for (const RigHandle& handle : tables.handles) {
    names += (names.empty() ? "" : ", ") + handle.name + (handle.pinned ? "" : " (free)");
  }
  for (const bake::BakeTiming& timing : baked.timings) {
    char text[96];
    std::snprintf(text, sizeof text, "%s%s %.2f", stages.empty() ? "" : ", ", timing.stage.c_str(),
                  timing.seconds);
    stages += text;
  }
  std::error_code ignored;
  const auto num_bytes = static_cast<double>(fs::file_size(options.output, ignored));
  console.Print("baked %s -> %s (%.1f MB)", options.input.c_str(), options.output.c_str(),
                num_bytes / 1e6);
  console.Print("  mesh     %u vertices (%u for drawing), %u triangles, %s",
                mesh.num_solve_vertices, mesh.num_draw_vertices, mesh.num_triangles(),
                tables.dimension == 2 ? "planar" : "3D");
  console.Print("  shapes   %d", tables.num_shapes());
  console.Print("  handles  %d, %s: %s", tables.num_handles(), summary.handles.source.c_str(),
                names.c_str());
  console.Print("  model    %d edge groups, %d modes%s", tables.num_groups, tables.num_modes,
                tables.has_rotations ? "" : ", without rotations");
  console.Print("  weights  %s", WeightsText(options, baked).c_str());
  console.Print("  follows  %s", InfluencesText(baked.influences).c_str());
  console.Print("  cost     %s", CostText(baked.cost).c_str());
  console.Print("  time     %.2f s (%s)", summary.seconds, stages.c_str());
}

struct Source {
  bake::RawCharacter raw;
  HandleChoice choice;
};

// The character with its handles, and with their weights where those are painted.
Result<Source> ReadSource(const BakeCommandOptions& options) {
  const Result<GltfFile> file = GltfFile::Open(options.input);
  if (!file.ok()) return file.status();
  bake::ImportOptions import_options;
  import_options.node = options.node;
  import_options.include_base = !options.no_base;
  import_options.stiffness = options.stiffness;
  Result<bake::RawCharacter> raw = bake::ImportGltf(*file, import_options);
  if (!raw.ok()) return raw.status();
  HandleChoice choice;
  if (options.weights != kSkinWeights) {
    Result<HandleChoice> chosen =
        ChooseHandleSource(*raw, options.handle_file, options.num_auto_handles);
    if (!chosen.ok()) return chosen.status();
    choice = std::move(chosen).value();
  }
  if (ArePainted(options.weights)) {
    Result<bake::PaintedWeights> painted = options.weights == kSkinWeights
                                               ? bake::WeightsOfSkin(*file, *raw)
                                               : bake::WeightsOfColors(*file, *raw, choice.handles);
    if (!painted.ok()) return painted.status().WithContext(file->name());
    if (options.weights == kSkinWeights)
      choice = {std::move(painted->handles), "joints of the skin"};
    raw->painted_weights = std::move(painted->weights);
    raw->warnings.insert(raw->warnings.end(), painted->warnings.begin(), painted->warnings.end());
  }
  return Source{std::move(raw).value(), std::move(choice)};
}

ExitCode RunBake(BakeCommandOptions options, const Console& console) {
  if (Status s = CheckWeights(options); !s.ok()) return console.Fail(s);
  if (Status s = CheckOutput(options); !s.ok()) return console.Fail(s);
  const auto start = Clock::now();
  ProgressBar progress(console);
  const auto fail = [&](const Status& status) {
    progress.Clear();
    return console.Fail(status);
  };
  progress.Update("read", 0);
  Result<Source> source = ReadSource(options);
  if (!source.ok()) return fail(source.status());
  const bake::RawCharacter& raw = source->raw;
  if (Status s =
          bake::CheckBeforeBake(options.input, raw, source->choice.handles.size(), options.output);
      !s.ok()) {
    return fail(s);
  }

  if (options.weights == kHeatWeights) options.bake.weights = bake::WeightKind::kHeat;
  options.bake.rotations = !options.no_rotations;
  const auto report = [&](const char* stage, double fraction) {
    return progress.Update(stage, fraction);
  };
  Result<bake::BakedCharacter> baked =
      bake::Bake(raw, source->choice.handles, options.bake, report);
  if (!baked.ok()) return fail(baked.status());
  if (!progress.Update("write", 1)) return fail(Error(StatusCode::kInvalidArgument, "cancelled"));
  if (Status s = bake::WriteBaked(options.input, raw, *baked, options.output); !s.ok())
    return fail(s);
  progress.Clear();

  const BakeSummary summary{std::move(source->choice),
                            std::chrono::duration<double>(Clock::now() - start).count()};
  PrintSummary(options, summary, *baked, console);
  console.Emit(SummaryJson(options, summary, *baked));
  console.Warn(raw.warnings);
  console.Warn(baked->warnings);
  return kSuccess;
}

}  // namespace

Command AddBakeCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("bake", "Prepare a glTF with morph targets for dragging");
  auto options = std::make_shared<BakeCommandOptions>();
  app->add_option("IN", options->input, "A .glb or .gltf whose mesh has morph targets")
      ->required()
      ->option_text(" ");
  app->add_option("-o,--output", options->output, "The baked .glb (or .gltf, data inside)")
      ->required()
      ->option_text("FILE (required)");
  auto* file = app->add_option("--handles", options->handle_file, "Handles from a JSON file")
                   ->option_text("FILE");
  app->add_option("--auto-handles", options->num_auto_handles,
                  "Choose this many handles (1 to 1024)")
      ->check(CLI::Range(1, 1024))
      ->excludes(file)
      ->option_text("N");
  app->add_option("--node", options->node,
                  "The mesh's node, by name or number, where the file has several")
      ->option_text("NODE");
  app->add_flag("--no-base", options->no_base,
                "The base mesh is not one of the example shapes, only the targets are");
  app->add_option("--groups", options->bake.num_groups,
                  "Edge groups that rotate and blend as one (default: twice the handles)")
      ->check(CLI::Range(1, 4096))
      ->option_text("N");
  app->add_option(
         "--weights", options->weights,
         "Skinning weights: computed (the smoothest), heat (a preview, at once), skin (the joints "
         "of "
         "the mesh's skin are the handles) or colors (handle i has channel i % 4 of COLOR_(i / 4))")
      ->check(CLI::IsMember({kComputedWeights, kHeatWeights, kSkinWeights, kColorWeights}))
      ->option_text("computed|heat|skin|colors");
  app->add_option("--influences", options->bake.influences,
                  "Most handles that a vertex follows, the largest weights kept (default: all)")
      ->check(CLI::Range(1, 1024))
      ->option_text("K");
  app->add_option("--stiffness", options->stiffness,
                  "Vertex attribute that scales the stiffness: _NAME, or COLOR_0 as a painted map "
                  "(default: _LIMBER_STIFFNESS where there is one)")
      ->option_text("ATTRIBUTE");
  app->add_flag("--no-rotations", options->no_rotations,
                "Bake only for blending without local rotations (faces): a smaller file");
  app->add_option("--threads", options->bake.num_threads, "Threads to use (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->option_text("N");
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunBake(*options, console); }};
}

}  // namespace limber::cli
