// limber pack: OBJ files of one topology -> a glTF with morph targets.
#include "cli/command.h"
#include "import/file_output.h"
#include "import/pack_obj.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace limber::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kFooter[] =
    R"(All files must have the same vertices and faces in the same order; only positions differ. The first
is the mesh, each further one a morph target named after its file. The glTF remembers vertex numbers
and polygons, so that `limber solve` writes meshes in the order of BASE.obj.

Examples:
  limber pack rest.obj bent.obj puffed.obj -o character.glb
  limber pack face/neutral.obj face/smile.obj face/frown.obj -o face.glb --name face
)";

struct PackCommandOptions {
  std::string base, output;
  std::vector<std::string> shapes;
  bake::PackOptions pack;
};

// A name too many after -o must not turn an artist's shape into a glTF.
Status CheckOutput(const PackCommandOptions& options) {
  std::vector<fs::path> inputs(options.shapes.begin(), options.shapes.end());
  inputs.emplace_back(options.base);
  LIMBER_RETURN_IF_ERROR(bake::CheckKeepsInputs(options.output, inputs));
  if (fs::path(options.output).extension() != ".glb") {
    return Error(StatusCode::kInvalidArgument, "%s: output: the name must end with .glb",
                 options.output.c_str());
  }
  return bake::CheckOutputPlace(options.output);
}

ExitCode RunPack(const PackCommandOptions& options, const Console& console) {
  if (Status s = CheckOutput(options); !s.ok()) return console.Fail(s);
  const std::vector<fs::path> shapes(options.shapes.begin(), options.shapes.end());
  if (Status s = bake::PackObj(options.base, shapes, options.pack, options.output); !s.ok()) {
    return console.Fail(s);
  }
  std::error_code ignored;
  const auto num_bytes = fs::file_size(options.output, ignored);
  console.Print("packed %zu morph targets -> %s (%.1f MB)", shapes.size(), options.output.c_str(),
                static_cast<double>(num_bytes) / 1e6);
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const fs::path& shape : shapes)
    names.push_back(shape.stem().string());
  console.Emit({{"output", options.output}, {"bytes", num_bytes}, {"targets", names}});
  return kSuccess;
}

}  // namespace

Command AddPackCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("pack", "Make a glTF with morph targets of OBJ files");
  auto options = std::make_shared<PackCommandOptions>();
  app->add_option("BASE", options->base, "The mesh at rest (OBJ)")->required()->option_text(" ");
  app->add_option("SHAPE", options->shapes, "Its example shapes (OBJ)")
      ->required()
      ->option_text("... ");
  app->add_option("-o,--output", options->output, "The .glb to write")
      ->required()
      ->option_text("FILE (required)");
  app->add_option("--name", options->pack.name, "Name of the mesh (default: that of BASE)")
      ->option_text("NAME");
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunPack(*options, console); }};
}

}  // namespace limber::cli
