#include "cli/character_input.h"

#include "bake/resolve_handles.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "import/handle_file.h"

namespace limber::cli {
namespace {

// The bake welds for itself, with its own tolerance; choosing only needs to know what hangs
// together.
Vector<bake::HandleSpec> ChooseOnSurface(const bake::RawCharacter& raw, int count) {
  const auto& rest = raw.shapes[0];
  const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 1e-6 * diagonal);
  geometry::ConnectComponents(&mesh);
  return bake::ChooseHandles(raw, mesh, count);
}

}  // namespace

Result<HandleChoice> ChooseHandleSource(const bake::RawCharacter& raw,
                                        const std::string& handle_file, int num_auto) {
  if (!handle_file.empty()) {
    auto handles = bake::ReadHandleFile(handle_file);
    if (!handles.ok()) return handles.status();
    return HandleChoice{std::move(handles).value(), "the file " + handle_file};
  }
  if (num_auto > 0) {
    return HandleChoice{ChooseOnSurface(raw, num_auto), "chosen automatically"};
  }
  if (!raw.marked_handles.empty()) {
    return HandleChoice{raw.marked_handles, "nodes marked in the glTF"};
  }
  return Error(StatusCode::kNoHandles,
               "%s: handles: there are none; give a file (--handles FILE), let them be chosen "
               "(--auto-handles 8), or mark nodes in the glTF (extras)",
               raw.file.c_str());
}

}  // namespace limber::cli
