// limber bench: Table 1 of the paper beside what this machine does, or the cost of baked files.
#include "bake/bake.h"
#include "bench/drag_path.h"
#include "bench/paper_table.h"
#include "bench/quick_bake.h"
#include "cli/bench_table.h"
#include "cli/character_input.h"
#include "cli/command.h"
#include "cli/progress_bar.h"
#include "core/vector.h"
#include "load/gltf_file.h"
#include "load/rig_loader.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kFooter[] =
    R"(Without files: the characters of Table 1 (Wampler 2016), baked and dragged here, beside the
paper's figures (one thread of a 2.4 GHz Xeon E5-2630). Sizes: k axes, |P| points of the mesh, |S|
example shapes, |H| handles, as in the paper. Then the precomputation (the whole bake, in seconds),
and one alternation of the solver on one thread: handle targets in, skinning matrices out, the median
over the frames of a drag through all shapes. Of it, each the median for itself, in microseconds:
  rot.   best rotations of the edge groups    near   how far each example is from the targets
  blend  blend weights, the convex step       skin   skinning matrices
The last column: "paper" is its own mesh (from --data DIR: horse/horse_ref.obj with -01 and
-02, characters/lion-poses.glb, characters/head-poses.glb), "made" one made in code of the same k,
|S| and |H| and nearly as many points. head and face are solved without rotations, as in the paper.

With baked files: what an alternation of each costs.

Close everything else first. Nothing is written.

Examples:
  limber bench --quick                       in a few seconds: cheap weights, no precomputation
  limber bench --data meshes/                the whole table; takes some minutes
  limber bench --only horse --only lion --threads 1
  limber bench dragonlet_baked.glb face_baked.glb
)";

struct BenchOptions {
  Vector<std::string> files, only;
  std::string data;
  bool quick = false;
  int num_frames = 480, num_threads = 0;
};

// One row's share of the whole bar.
class RowProgress {
 public:
  RowProgress(ProgressBar* bar, std::string name, double from, double to)
      : bar_(bar),
        name_(std::move(name)),
        from_(from),
        to_(to) {}

  bool Update(const std::string& stage, double fraction) {
    return bar_->Update((name_ + ": " + stage).c_str(), from_ + (to_ - from_) * fraction);
  }

 private:
  ProgressBar* bar_;
  std::string name_;
  double from_, to_;
};

// Within a row: nine tenths for the bake, the rest for the drag.
constexpr double kBakeShare = 0.9;

Status Drag(const BenchOptions& options, RowProgress* progress, BenchRow* row) {
  auto times = bench::TimeAlternations(row->rig, options.num_frames, [&](double fraction) {
    return progress->Update("drag", kBakeShare + (1 - kBakeShare) * fraction);
  });
  if (!times.ok()) return times.status().WithContext(row->name);
  row->times = *times;
  return {};
}

Status BakeRow(const BenchOptions& options, RowProgress* progress, BenchRow* row) {
  auto character = bench::CharacterOf(*row->paper, options.data);
  if (!character.ok()) return character.status();
  const bake::RawCharacter& raw = character->raw;
  row->is_the_papers_mesh = character->is_the_papers;
  const auto choice =
      ChooseHandleSource(raw, "", character->is_the_papers ? row->paper->handles : 0);
  if (!choice.ok()) return choice.status();
  bake::BakeOptions bake_options;
  bake_options.rotations = row->paper->rotations;
  bake_options.num_threads = options.num_threads;
  const auto report = [&](const char* stage, double fraction) {
    return progress->Update(stage, kBakeShare * fraction);
  };
  const auto start = std::chrono::steady_clock::now();
  auto baked =
      (options.quick ? bench::BakeQuickly : bake::Bake)(raw, choice->handles, bake_options, report);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  if (!baked.ok()) return baked.status();
  if (!options.quick) row->precompute = spent.count();
  auto rig = Rig::Create(row->name, std::move(baked->tables), std::move(baked->mesh));
  if (!rig.ok()) return rig.status();
  row->rig = *rig;
  return {};
}

// About what a bake costs, for the progress bar.
double Effort(const bench::PaperRow& row) {
  return 1e3 + static_cast<double>(row.vertices) * row.handles;
}

Vector<const bench::PaperRow*> ChosenRows(const BenchOptions& options) {
  Vector<const bench::PaperRow*> rows;
  for (const bench::PaperRow& row : bench::PaperTable()) {
    const bool named = std::count(options.only.begin(), options.only.end(), row.name) > 0;
    if (named || options.only.empty()) rows.push_back(&row);
  }
  return rows;
}

// Rows are printed as they come; all of them are in `rows` at the end.
Status BenchTable(const BenchOptions& options, const Console& console, Json* rows) {
  if (!options.data.empty() && !bench::HasPaperMeshes(options.data)) {
    return Error(StatusCode::kNotFound,
                 "%s: none of the paper's meshes is there (horse/horse_ref.obj, "
                 "characters/lion-poses.glb, characters/head-poses.glb); leave --data out to use "
                 "characters made in code",
                 options.data.c_str());
  }
  const auto chosen = ChosenRows(options);
  double all = 0, done = 0;
  for (const bench::PaperRow* paper : chosen)
    all += Effort(*paper);
  PrintBenchHeading(true, console);
  ProgressBar bar(console);
  for (const bench::PaperRow* paper : chosen) {
    BenchRow row;
    row.name = paper->name;
    row.paper = paper;
    RowProgress progress(&bar, row.name, done / all, (done + Effort(*paper)) / all);
    LIMBER_RETURN_IF_ERROR(BakeRow(options, &progress, &row));
    LIMBER_RETURN_IF_ERROR(Drag(options, &progress, &row));
    done += Effort(*paper);
    bar.Clear();
    PrintBenchRow(row, console);
    rows->push_back(BenchRowJson(row));
  }
  return {};
}

Status LoadRows(const std::string& path, Vector<BenchRow>* rows) {
  const Result<GltfFile> file = GltfFile::Open(path);
  if (!file.ok()) return file.status();
  const int num_rigs = std::max(1, CountRigs(*file));  // none: the loader says so
  for (int i = 0; i < num_rigs; ++i) {
    RigLoadOptions load_options;
    load_options.rig_index = i;
    auto rig = LoadRig(*file, load_options);
    if (!rig.ok()) return rig.status();
    BenchRow row;
    row.name = fs::path(path).stem().string() + (num_rigs > 1 ? ":" + std::to_string(i) : "");
    row.rig = std::move(*rig);
    rows->push_back(std::move(row));
  }
  return {};
}

Status BenchFiles(const BenchOptions& options, const Console& console, Json* result) {
  Vector<BenchRow> rows;
  for (const std::string& path : options.files)
    LIMBER_RETURN_IF_ERROR(LoadRows(path, &rows));
  PrintBenchHeading(false, console);
  ProgressBar bar(console);
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto count = static_cast<double>(rows.size()), first = static_cast<double>(i);
    RowProgress progress(&bar, rows[i].name, first / count, (first + 1) / count);
    LIMBER_RETURN_IF_ERROR(Drag(options, &progress, &rows[i]));
    bar.Clear();
    PrintBenchRow(rows[i], console);
    result->push_back(BenchRowJson(rows[i]));
  }
  return {};
}

ExitCode RunBench(const BenchOptions& options, const Console& console) {
  Json rows = Json::array();
  const Status status = options.files.empty() ? BenchTable(options, console, &rows)
                                              : BenchFiles(options, console, &rows);
  if (!status.ok()) return console.Fail(status);
  console.Emit({{"processor", ProcessorName()}, {"frames", options.num_frames}, {"rows", rows}});
  return kSuccess;
}

Vector<std::string> RowNames() {
  Vector<std::string> names;
  for (const bench::PaperRow& row : bench::PaperTable())
    names.emplace_back(row.name);
  return names;
}

}  // namespace

Command AddBenchCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("bench", "Measure the solver beside the paper's table");
  auto options = std::make_shared<BenchOptions>();
  auto* files = app->add_option("BAKED", options->files, "Baked glTF files to measure instead")
                    ->option_text("...");
  app->add_option("--data", options->data, "A folder with the paper's own meshes (see below)")
      ->excludes(files)
      ->option_text("DIR");
  app->add_option("--only", options->only, "Only this row of the table; may be repeated")
      ->check(CLI::IsMember(RowNames()))
      ->allow_extra_args(false)
      ->excludes(files)
      ->option_text("NAME");
  app->add_flag("--quick", options->quick, "Weights that cost nothing; no precomputation to show")
      ->excludes(files)
      ->option_text(" ");
  app->add_option("--frames", options->num_frames,
                  "Frames of the drag (default 480); fewer are larger steps, which cost more")
      ->check(CLI::Range(1, 1000000))
      ->option_text("N");
  app->add_option("--threads", options->num_threads,
                  "Threads of the bake (default: one per core); the solver has one")
      ->check(CLI::Range(1, 1024))
      ->excludes(files)
      ->option_text("N");
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunBench(*options, console); }};
}

}  // namespace limber::cli
