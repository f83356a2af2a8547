#include "skin/cpu_skinner.h"

#include "core/out_of_memory.h"
#include "core/vector.h"
#include "skin/vec3_math.h"

#include <algorithm>
#include <cstring>

namespace limber {
namespace {

// Puts one vertex's numbers in their place, and goes on to the next.
class Cursor {
 public:
  explicit Cursor(const StridedOutput& output)
      : to_(static_cast<std::byte*>(output.data)),
        stride_(output.stride) {}

  template <class T>
  void Put(const T& numbers) {
    if (to_ == nullptr) return;
    std::memcpy(to_, &numbers, sizeof(T));
    to_ += stride_;
  }

 private:
  std::byte* to_;
  size_t stride_;
};

Bounds BoundsOf(std::span<const Vec3> points, Vec3 offset) {
  if (points.empty()) return {};
  Bounds bounds = {points[0], points[0]};
  for (const Vec3& p : points) {
    bounds.min = {std::min(bounds.min.x, p.x), std::min(bounds.min.y, p.y),
                  std::min(bounds.min.z, p.z)};
    bounds.max = {std::max(bounds.max.x, p.x), std::max(bounds.max.y, p.y),
                  std::max(bounds.max.z, p.z)};
  }
  return {bounds.min + offset, bounds.max + offset};
}

template <class T>
StridedOutput Packed(Vector<T>* vertices) {
  return {vertices->data(), sizeof(T)};
}

}  // namespace

Result<std::shared_ptr<const SkinSurface>> SkinSurface::Create(const SkinMesh& mesh,
                                                               const RigSpace& space) {
  using Shared = std::shared_ptr<const SkinSurface>;
  return CatchOutOfMemory("skin mesh", [&]() -> Result<Shared> {
    Result<SkinTopology> topology = BuildSkinTopology(mesh, space);
    if (!topology.ok()) return topology.status();
    FrameLayout frames(*topology);
    return Shared(
        Share(new SkinSurface{{}, SkinLayout(mesh), std::move(*topology), std::move(frames)}));
  });
}

Result<CpuSkinner> CpuSkinner::CreateWithoutResults(std::shared_ptr<const SkinSurface> surface) {
  if (surface == nullptr) return Error(StatusCode::kInvalidArgument, "no skin surface was given");
  return CatchOutOfMemory("skin", [&]() -> Result<CpuSkinner> {
    CpuSkinner skinner;
    skinner.scratch_.resize(SkinScratchSize(surface->layout));
    skinner.relative_.resize(size_t{surface->layout.num_vertices()} + 1);
    skinner.frames_.Resize(surface->topology.num_groups());
    skinner.surface_ = std::move(surface);
    return skinner;
  });
}

Result<CpuSkinner> CpuSkinner::Create(std::shared_ptr<const SkinSurface> surface) {
  Result<CpuSkinner> made = CreateWithoutResults(std::move(surface));
  if (!made.ok()) return made;
  return CatchOutOfMemory("skin", [&]() -> Result<CpuSkinner> {
    const size_t num_draw = made->topology().draw_vertices.size();
    made->solve_positions_.resize(made->relative().size());
    made->positions_.resize(num_draw);
    made->normals_.resize(num_draw);
    made->tangents_.resize(num_draw);
    made->has_results_ = true;
    return std::move(made);
  });
}

Result<CpuSkinner> CpuSkinner::Create(const SkinMesh& mesh, const RigSpace& space) {
  auto surface = SkinSurface::Create(mesh, space);
  if (!surface.ok()) return surface.status();
  return Create(std::move(surface).value());
}

// Of the solve vertices alone; the one behind them is for wide loads (ComputeSurfaceFrames).
std::span<Vec3> CpuSkinner::relative() {
  return std::span(relative_).first(surface_->layout.num_vertices());
}

Status CpuSkinner::SkinInto(const SkinTransforms& transforms, const SkinOutputs& outputs) {
  LIMBER_RETURN_IF_ERROR(
      SkinPositions(surface_->layout, {transforms.matrices, {}}, &scratch_, relative()));
  if (outputs.normals.data != nullptr || outputs.tangents.data != nullptr) {
    WriteFrames(transforms.origin, outputs);
  } else {
    Cursor positions(outputs.positions);
    for (const SkinDrawVertex& vertex : topology().draw_vertices)
      positions.Put(relative_[vertex.solve_vertex] + transforms.origin);
  }
  if (outputs.bounds != nullptr) *outputs.bounds = BoundsOf(relative(), transforms.origin);
  return {};
}

// Vertex by vertex, so that an interleaved buffer is written from its beginning to its end.
void CpuSkinner::WriteFrames(Vec3 origin, const SkinOutputs& outputs) {
  const SkinKernels& kernels = ChooseSkinKernels();
  ComputeSurfaceFrames(kernels, surface_->frames, topology(), relative_, &frames_);
  Cursor positions(outputs.positions), normals(outputs.normals), tangents(outputs.tangents);
  const std::span<const SkinDrawVertex> vertices = topology().draw_vertices;
  for (size_t begin = 0; begin < vertices.size(); begin += kSkinLanes) {
    const auto some =
        vertices.subspan(begin, std::min<size_t>(kSkinLanes, vertices.size() - begin));
    Vec3 some_normals[kSkinLanes];
    Tangent some_tangents[kSkinLanes];
    ApplyFrames(kernels, frames_.frames, some, some_normals, some_tangents);
    for (size_t i = 0; i < some.size(); ++i) {
      positions.Put(relative_[some[i].solve_vertex] + origin);
      normals.Put(some_normals[i]);
      tangents.Put(some_tangents[i]);
    }
  }
}

Status CpuSkinner::SkinResults(const SkinTransforms& transforms, bool with_frames) {
  if (!has_results_) return Error(StatusCode::kInvalidArgument, "skin: made without results");
  SkinOutputs outputs;
  outputs.positions = Packed(&positions_);
  if (with_frames) {
    outputs.normals = Packed(&normals_);
    outputs.tangents = Packed(&tangents_);
  }
  LIMBER_RETURN_IF_ERROR(SkinInto(transforms, outputs));
  for (size_t v = 0; v < solve_positions_.size(); ++v)
    solve_positions_[v] = relative_[v] + transforms.origin;
  return {};
}

Status CpuSkinner::SkinPositionsOnly(const SkinTransforms& transforms) {
  return SkinResults(transforms, false);
}

Status CpuSkinner::Skin(const SkinTransforms& transforms) {
  return SkinResults(transforms, true);
}

DeformedMesh CpuSkinner::result() const {
  return {solve_positions_, positions_, normals_, tangents_};
}

}  // namespace limber
