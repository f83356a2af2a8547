#include "bake/resolve_handles.h"

#include "core/vector.h"
#include "geometry/extremities.h"
#include "geometry/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace limber::bake {
namespace {

constexpr int kNone = -1;

std::string Place(const HandleSpec& spec) {
  return "handle '" + spec.name + "'";
}

// Solve vertex of each of the source's vertices, by the first draw vertex that came from it;
// kNone for source vertices that no draw vertex uses.
Vector<int> SolveVertexOfSource(const RawCharacter& raw, const geometry::SolveMesh& mesh) {
  Vector<int> solve(raw.num_source_vertices, kNone);
  const size_t count = std::min(raw.source_vertex.size(), mesh.solve_vertex.size());
  for (size_t d = 0; d < count; ++d) {
    const uint32_t source = raw.source_vertex[d];
    if (source < solve.size() && solve[source] == kNone) {
      solve[source] = static_cast<int>(mesh.solve_vertex[d]);
    }
  }
  return solve;
}

class Snapper {
 public:
  Snapper(const RawCharacter& raw, const geometry::SolveMesh& mesh)
      : source_(SolveVertexOfSource(raw, mesh)),
        tree_(mesh.shapes[0], geometry::AllIndices(mesh.num_vertices())) {}

  Result<int> Snap(const HandleSpec& spec) const {
    if (spec.source_vertex.has_value() == spec.position.has_value()) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: needs either a vertex or a position; give exactly one of them",
                   Place(spec).c_str());
    }
    if (!IsRegionStiffness(spec.stiffness)) {
      return Error(StatusCode::kInvalidArgument, "%s: stiffness %g; expected %g to %g",
                   Place(spec).c_str(), spec.stiffness, kSoftestRegion, kStiffestRegion);
    }
    return spec.position ? SnapPosition(spec) : SnapSource(spec);
  }

 private:
  Result<int> SnapPosition(const HandleSpec& spec) const {
    const Vec3 p = *spec.position;
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: position is not finite; give three ordinary numbers", Place(spec).c_str());
    }
    double squared_distance = std::numeric_limits<double>::infinity();
    int nearest = kNone;
    tree_.FindNearest(Eigen::Vector3d(p.x, p.y, p.z), &squared_distance, &nearest);
    return nearest;
  }

  Result<int> SnapSource(const HandleSpec& spec) const {
    const uint32_t source = *spec.source_vertex;
    if (source >= source_.size()) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: vertex %u does not exist; the mesh has %zu vertices, counted from 0",
                   Place(spec).c_str(), source, source_.size());
    }
    if (source_[source] == kNone) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: vertex %u belongs to no triangle of the mesh; choose another one",
                   Place(spec).c_str(), source);
    }
    return source_[source];
  }

  Vector<int> source_;
  geometry::PointTree tree_;
};

// Names are there and differ, and at least one handle is pinned.
Status CheckSpecs(std::span<const HandleSpec> specs) {
  if (specs.empty()) {
    return Error(StatusCode::kNoHandles,
                 "handles: there are none; mark nodes in the glTF, give --handles FILE or "
                 "--auto-handles N");
  }
  std::map<std::string, size_t> seen;
  for (size_t i = 0; i < specs.size(); ++i) {
    if (specs[i].name.empty()) {
      return Error(StatusCode::kInvalidArgument,
                   "handles: number %zu has no name; every handle needs one", i);
    }
    if (const auto [first, added] = seen.emplace(specs[i].name, i); !added) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: two handles have this name (numbers %zu and %zu); rename one of them",
                   Place(specs[i]).c_str(), first->second, i);
    }
  }
  const auto pinned = [](const HandleSpec& spec) { return spec.pinned; };
  if (std::none_of(specs.begin(), specs.end(), pinned)) {
    return Error(StatusCode::kNoHandles,
                 "handles: all %zu are free; pin at least one, or nothing can be dragged",
                 specs.size());
  }
  return {};
}

}  // namespace

Result<Vector<ResolvedHandle>> ResolveHandles(const RawCharacter& raw,
                                              const geometry::SolveMesh& mesh,
                                              std::span<const HandleSpec> specs) {
  LIMBER_RETURN_IF_ERROR(CheckSpecs(specs));
  if (mesh.num_vertices() == 0) {
    return Error(StatusCode::kDegenerate, "mesh: it has no vertices; there is nothing to hold");
  }
  const Snapper snapper(raw, mesh);
  Vector<ResolvedHandle> resolved;
  std::map<int, size_t> owner;
  for (const HandleSpec& spec : specs) {
    Result<int> vertex = snapper.Snap(spec);
    if (!vertex.ok()) return vertex.status();
    if (const auto [first, added] = owner.emplace(*vertex, resolved.size()); !added) {
      const auto point = mesh.shapes[0].row(*vertex);
      return Error(StatusCode::kInvalidArgument,
                   "%s: lies on the same vertex as handle '%s', at (%g, %g, %g); move one of them "
                   "or remove it",
                   Place(spec).c_str(), resolved[first->second].spec.name.c_str(), point(0),
                   point(1), point(2));
    }
    resolved.push_back({spec, *vertex});
  }
  return resolved;
}

Vector<HandleSpec> ChooseHandles(const RawCharacter& raw, const geometry::SolveMesh& mesh,
                                 int count) {
  // The source vertex of the first draw vertex on each solve vertex.
  Vector<uint32_t> source(static_cast<size_t>(mesh.num_vertices()), 0);
  for (size_t d = mesh.solve_vertex.size(); d-- > 0;) {
    source[mesh.solve_vertex[d]] =
        d < raw.source_vertex.size() ? raw.source_vertex[d] : static_cast<uint32_t>(d);
  }
  Vector<HandleSpec> handles;
  for (const int vertex : geometry::SpreadPoints(mesh, count)) {
    HandleSpec spec;
    spec.name = "handle_" + std::to_string(handles.size());
    spec.source_vertex = source[vertex];
    handles.push_back(std::move(spec));
  }
  return handles;
}

}  // namespace limber::bake
