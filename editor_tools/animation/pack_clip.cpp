#include "animation/pack_clip.h"

#include "animation/clip_moments.h"
#include "animation/clip_shapes.h"
#include "core/out_of_memory.h"
#include "core/printable.h"
#include "core/vector.h"
#include "gltf_edit/append_targets.h"
#include "gltf_edit/gltf_patch.h"
#include "import/file_output.h"
#include "import/mesh_node.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Result<AnimationClip> ChooseClip(const GltfFile& file, const std::string& wanted) {
  const Result<int> index = FindAnimationClip(file, wanted);
  if (!index.ok()) return index.status();
  return ReadAnimationClip(file, *index);
}

Status CheckDeforms(const GltfFile& file, const AnimationClip& clip, int node) {
  const std::string name = Quoted(NodeName(file, static_cast<size_t>(node)));
  const bool has_skin = file.json()["nodes"][static_cast<size_t>(node)].contains("skin");
  if (!has_skin && NumMorphTargets(file, node) == 0) {
    return Error(StatusCode::kInvalidArgument,
                 "node %s: it has neither a skin nor morph targets, so a clip moves it only as a "
                 "whole, and there is no shape to take",
                 name.c_str());
  }
  if (ClipDeforms(file, clip, node)) return {};
  return Error(StatusCode::kInvalidArgument,
               "node %s: the clip %s moves neither its joints nor its morph targets; choose "
               "another clip or node",
               name.c_str(), Quoted(clip.name).c_str());
}

Result<int> ChooseNode(const GltfFile& file, const AnimationClip& clip, const std::string& wanted) {
  if (!wanted.empty()) {
    Result<int> node = FindNamedMeshNode(file, wanted);
    if (!node.ok()) return node;
    LIMBER_RETURN_IF_ERROR(CheckDeforms(file, clip, *node));
    return node;
  }
  Vector<size_t> candidates = MeshNodes(file);
  std::erase_if(candidates, [&](size_t node) {
    return !CheckDeforms(file, clip, static_cast<int>(node)).ok();
  });
  if (candidates.size() == 1) return static_cast<int>(candidates[0]);
  if (candidates.empty()) {
    return Error(StatusCode::kInvalidArgument,
                 "clip %s: it bends no mesh: none has a skin or morph targets that it moves, and "
                 "what only moves as a whole has no shapes to take",
                 Quoted(clip.name).c_str());
  }
  return Error(StatusCode::kInvalidArgument,
               "nodes: the clip %s deforms several meshes; choose one with --node: %s",
               Quoted(clip.name).c_str(), ListNodes(file, candidates).c_str());
}

// New targets would make a bake of this mesh stale.
Status CheckNotBaked(const GltfFile& file, int mesh) {
  for (const Json& node : file.json()["nodes"]) {
    if (node.value("mesh", -1) != mesh || !node.contains("extensions")) continue;
    if (node["extensions"].contains(kRigExtensionName)) {
      return Error(StatusCode::kInvalidArgument,
                   "meshes[%d]: it is baked already; pack the file that was baked, and bake last",
                   mesh);
    }
  }
  return {};
}

Status CheckLimits(const GltfFile& file, const SkinnedMesh& mesh, size_t num_moments) {
  const GltfLimits& limits = file.limits();
  const uint64_t num_targets = uint64_t{mesh.num_targets} + num_moments;
  if (num_targets <= limits.max_targets &&
      num_targets * mesh.num_vertices() <= limits.max_morph_positions) {
    return {};
  }
  return Error(StatusCode::kLimitExceeded,
               "%llu morph targets of %zu vertices would be more than a bake reads (%llu targets, "
               "%llu targets times vertices); take fewer moments",
               static_cast<unsigned long long>(num_targets), mesh.num_vertices(),
               static_cast<unsigned long long>(limits.max_targets),
               static_cast<unsigned long long>(limits.max_morph_positions));
}

// Of the box around the mesh at rest.
double Diagonal(const SkinnedMesh& mesh) {
  Eigen::RowVector3d low = mesh.primitives[0].positions.row(0), high = low;
  for (const SkinnedPrimitive& primitive : mesh.primitives) {
    low = low.cwiseMin(primitive.positions.colwise().minCoeff());
    high = high.cwiseMax(primitive.positions.colwise().maxCoeff());
  }
  return (high - low).norm();
}

// Whether the shape at the clip's end is that at its start, to a thousandth of the mesh's size.
bool Loops(const ClipShapes& shapes, const AnimationClip& clip, bool in_place) {
  constexpr double kSame = 1e-3;
  const auto start = shapes.ShapeAt(clip, 0, in_place);
  const auto end = shapes.ShapeAt(clip, clip.duration, in_place);
  double farthest = 0;
  for (size_t p = 0; p < start.size(); ++p) {
    const PointMatrix difference = end[p].positions - start[p].positions;
    farthest = std::max(farthest, difference.rowwise().norm().maxCoeff());
  }
  return farthest <= kSame * Diagonal(shapes.mesh());
}

Result<Vector<double>> ChooseMoments(const GltfFile& file, const SkinnedMesh& mesh,
                                     const AnimationClip& clip, const PackClipOptions& options,
                                     bool loops) {
  const auto count = static_cast<size_t>(std::max(0, options.count));
  LIMBER_RETURN_IF_ERROR(CheckLimits(file, mesh, std::max(count, options.times.size())));
  if (options.count > 0) return SpreadMoments(clip, options.count, loops);
  return CheckMoments(clip, options.times);
}

// posed - rest as single precision; empty where there are no rows. False: not finite.
bool Displacements(const PointMatrix& posed, const PointMatrix& rest, Vector<float>* numbers) {
  for (Eigen::Index i = 0; i < posed.size(); ++i) {
    const auto number = static_cast<float>(posed.data()[i] - rest.data()[i]);
    if (!std::isfinite(number)) return false;
    numbers->push_back(number + 0.0f);  // without minus zero's sign
  }
  return true;
}

Result<NewTarget> MakeTarget(const ClipShapes& shapes, const AnimationClip& clip, double time,
                             bool in_place) {
  NewTarget target{MomentName(clip, time), {}};
  const Vector<PosedPrimitive> posed = shapes.ShapeAt(clip, time, in_place);
  for (size_t p = 0; p < posed.size(); ++p) {
    const SkinnedPrimitive& rest = shapes.mesh().primitives[p];
    TargetOffsets offsets;
    if (!Displacements(posed[p].positions, rest.positions, &offsets.positions) ||
        !Displacements(posed[p].normals, rest.normals, &offsets.normals)) {
      return Error(StatusCode::kMalformed,
                   "clip %s: at %g s the mesh is not finite (primitive %zu); its animation or its "
                   "skin is broken, export them again",
                   Quoted(clip.name).c_str(), time, p);
    }
    target.primitives.push_back(std::move(offsets));
  }
  return target;
}

// A moment at rest is no example beside the base, which is one itself.
void WarnOfRest(const NewTarget& target, double diagonal, Vector<std::string>* warnings) {
  constexpr double kStill = 1e-5;
  double largest = 0;
  for (const TargetOffsets& offsets : target.primitives) {
    for (const float number : offsets.positions)
      largest = std::max(largest, std::abs(double{number}));
  }
  if (largest > kStill * diagonal) return;
  warnings->push_back("morph target " + Quoted(target.name) +
                      ": it is the mesh at rest, which is an example shape anyway");
}

Status CheckOutputName(const std::filesystem::path& out) {
  const std::string extension = out.extension().string();
  if (extension == ".glb" || extension == ".gltf") return {};
  return Error(StatusCode::kInvalidArgument, "%s: output: the name must end with .glb or .gltf",
               out.string().c_str());
}

// What PackClip adds to the file.
struct ClipTargets {
  int mesh = -1;
  Vector<NewTarget> targets;
  PackClipSummary summary;
};

Result<ClipTargets> MakeTargets(const GltfFile& file, const ClipShapes& shapes,
                                const AnimationClip& clip, const PackClipOptions& options) {
  ClipTargets result;
  PackClipSummary& summary = result.summary;
  summary.loops = Loops(shapes, clip, options.in_place);
  const Result<Vector<double>> moments =
      ChooseMoments(file, shapes.mesh(), clip, options, summary.loops);
  if (!moments.ok()) return moments.status();
  summary.warnings = shapes.mesh().warnings;
  for (const double time : *moments) {
    Result<NewTarget> target = MakeTarget(shapes, clip, time, options.in_place);
    if (!target.ok()) return target.status();
    summary.shape_names.push_back(target->name);
    WarnOfRest(*target, Diagonal(shapes.mesh()), &summary.warnings);
    result.targets.push_back(std::move(*target));
  }
  summary.clip = clip.name;
  summary.clip_seconds = clip.duration;
  summary.num_vertices = shapes.mesh().num_vertices();
  summary.num_old_targets = shapes.mesh().num_targets;
  return result;
}

// Everything but opening and writing; errors without the file's name.
Result<ClipTargets> TakeShapes(const GltfFile& file, const PackClipOptions& options) {
  const Result<AnimationClip> clip = ChooseClip(file, options.clip);
  if (!clip.ok()) return clip.status();
  const Result<int> node = ChooseNode(file, *clip, options.node);
  if (!node.ok()) return node.status();
  const std::string name = NodeName(file, static_cast<size_t>(*node));
  const int mesh = file.json()["nodes"][static_cast<size_t>(*node)]["mesh"].get<int>();
  LIMBER_RETURN_IF_ERROR(CheckNotBaked(file, mesh));
  const Result<ClipShapes> shapes = ClipShapes::Create(file, *node);
  if (!shapes.ok()) return shapes.status();
  if (options.in_place && !shapes->has_skin()) {
    return Error(StatusCode::kInvalidArgument,
                 "node %s: it has no skin, so there is no root joint to hold in place",
                 Quoted(name).c_str());
  }
  Result<ClipTargets> result = MakeTargets(file, *shapes, *clip, options);
  if (!result.ok()) return result;
  result->mesh = mesh;
  result->summary.node = name;
  return result;
}

}  // namespace

Result<PackClipSummary> PackClip(const std::filesystem::path& source,
                                 const PackClipOptions& options, const std::filesystem::path& out) {
  LIMBER_RETURN_IF_ERROR(CheckOutputName(out));
  const Result<GltfFile> file = GltfFile::Open(source);
  if (!file.ok()) return file.status();
  return CatchOutOfMemory(file->name(), [&]() -> Result<PackClipSummary> {
    Result<ClipTargets> added = TakeShapes(*file, options);
    if (!added.ok()) return added.status().WithContext(file->name());
    Result<GltfPatch> patch = GltfPatch::Begin(*file);
    if (!patch.ok()) return patch.status();
    LIMBER_RETURN_IF_ERROR(
        AppendTargets(*file, added->mesh, added->targets, &*patch).WithContext(file->name()));
    Result<Vector<uint8_t>> bytes = patch->Finish(out.extension() == ".glb");
    if (!bytes.ok()) return bytes.status().WithContext(out.string());
    LIMBER_RETURN_IF_ERROR(WriteFileAtomically(out, *bytes));
    return std::move(added->summary);
  });
}

}  // namespace limber::bake
