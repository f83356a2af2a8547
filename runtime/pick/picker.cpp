#include "pick/picker.h"

#include "core/out_of_memory.h"
#include "core/vector.h"
#include "pick/handle_pick.h"
#include "ray/triangle_hit.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <string>

namespace limber {
namespace {

// Embree passes over triangles with larger coordinates when it builds, so that a refit could not
// bring them back.
constexpr float kLargestCoordinate = 1e18f;
constexpr size_t kPaddingFloats = 4;  // Embree reads 16 bytes at the last vertex
constexpr double kTieFraction = 1e-6;

// Embree divides by zero on purpose and its builders may set flush-to-zero: the host sees neither.
class KeepFloatingPoint {
 public:
  KeepFloatingPoint() { std::feholdexcept(&environment_); }

  ~KeepFloatingPoint() { std::fesetenv(&environment_); }

  KeepFloatingPoint(const KeepFloatingPoint&) = delete;
  KeepFloatingPoint& operator=(const KeepFloatingPoint&) = delete;

 private:
  std::fenv_t environment_ = {};
};

Status CheckPositions(std::span<const Vec3> positions, size_t expected) {
  if (positions.size() != expected) {
    return Error(StatusCode::kInvalidArgument, "picker: positions: got %zu, the mesh has %zu",
                 positions.size(), expected);
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(p[axis]) <= kLargestCoordinate)) {
        return Error(StatusCode::kInvalidArgument,
                     "picker: position %zu: (%g, %g, %g) is not finite or beyond 1e18", i,
                     static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
      }
    }
  }
  return {};
}

// Extends Embree's context: collects the lowest triangle among all hits of a short segment.
struct LowestTriangle {
  RTCIntersectContext base;  // first: Embree hands back a pointer to it
  unsigned int triangle;
};

void KeepLowestTriangle(const RTCFilterFunctionNArguments* args) {
  auto* lowest = reinterpret_cast<LowestTriangle*>(args->context);
  for (unsigned int i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    lowest->triangle = std::min(lowest->triangle, RTCHitN_primID(args->hit, args->N, i));
    args->valid[i] = 0;  // look on: every hit of the segment counts
  }
}

std::optional<Double3> UnitDirection(const PickRay& ray) {
  if (!IsFinite(ray.origin) || !IsFinite(ray.direction)) return std::nullopt;
  if (std::isnan(ray.near_distance) || std::isnan(ray.far_distance)) return std::nullopt;
  const Double3 direction = ToDouble(ray.direction);
  const double length = Length(direction);
  if (!(length > 0)) return std::nullopt;
  return (1 / length) * direction;
}

RTCRay MakeRay(Double3 origin, Double3 unit_direction, double near_distance, double far_distance) {
  RTCRay ray = {};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(unit_direction.x);
  ray.dir_y = static_cast<float>(unit_direction.y);
  ray.dir_z = static_cast<float>(unit_direction.z);
  ray.tnear = static_cast<float>(std::max(0.0, near_distance));
  ray.tfar = static_cast<float>(far_distance);
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct Picker::Impl {
  ~Impl() {
    KeepFloatingPoint keep;
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  Status Build(const SkinMesh& mesh, std::span<const Vec3> solve_positions);
  Status CopyTriangles(const SkinMesh& mesh);
  void CopyPositions(std::span<const Vec3> solve_positions);
  Status DeviceStatus(const char* doing) const;
  std::array<Vec3, 3> Corners(uint32_t triangle) const;
  bool IsHidden(const PickRay& ray, Double3 unit_direction, Vec3 handle, double distance,
                const HandlePickOptions& options) const;

  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  size_t num_vertices = 0;
  Vector<uint32_t> corners;  // 3 per triangle, solve vertices
  Vector<float> vertices;    // 3 per vertex, then the padding; Embree reads them in place
  float diagonal = 0;
};

Status Picker::Impl::DeviceStatus(const char* doing) const {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return {};
  const char* reason = error == RTC_ERROR_OUT_OF_MEMORY     ? "out of memory"
                       : error == RTC_ERROR_UNSUPPORTED_CPU ? "this processor is not supported"
                                                            : "an internal error";
  return Error(StatusCode::kDeviceError, "picker: %s: Embree reports %s (code %d)", doing, reason,
               static_cast<int>(error));
}

Status Picker::Impl::CopyTriangles(const SkinMesh& mesh) {
  if (mesh.triangles.size() < 3) {
    return Error(StatusCode::kDegenerate, "picker: the mesh has no triangle; nothing to pick");
  }
  corners.resize(mesh.triangles.size() / 3 * 3);
  for (size_t i = 0; i < corners.size(); ++i) {
    const uint32_t draw = mesh.triangles[i];
    if (draw >= mesh.solve_vertex.size() || mesh.solve_vertex[draw] >= mesh.num_solve_vertices) {
      return Error(StatusCode::kMalformed,
                   "picker: triangle %zu: corner %zu is draw vertex %u, which has no solve vertex",
                   i / 3, i % 3, draw);
    }
    corners[i] = mesh.solve_vertex[draw];
  }
  return {};
}

void Picker::Impl::CopyPositions(std::span<const Vec3> solve_positions) {
  std::memcpy(vertices.data(), solve_positions.data(), solve_positions.size_bytes());
  Vec3 low = solve_positions.front(), high = low;
  for (const Vec3& p : solve_positions) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  diagonal = static_cast<float>(Length(ToDouble(high) - ToDouble(low)));
}

Status Picker::Impl::Build(const SkinMesh& mesh, std::span<const Vec3> solve_positions) {
  num_vertices = mesh.num_solve_vertices;
  LIMBER_RETURN_IF_ERROR(CopyTriangles(mesh));
  LIMBER_RETURN_IF_ERROR(CheckPositions(solve_positions, num_vertices));
  vertices.assign(num_vertices * 3 + kPaddingFloats, 0.0f);
  CopyPositions(solve_positions);

  KeepFloatingPoint keep;
  // One thread: the caller's. Embree then never wakes workers that would compete with the game.
  device = rtcNewDevice("threads=1,set_affinity=0");
  if (device == nullptr) {
    const Status status = DeviceStatus("opening the device");
    return status.ok() ? Error(StatusCode::kDeviceError, "Embree: no device") : status;
  }
  scene = rtcNewScene(device);
  geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  LIMBER_RETURN_IF_ERROR(DeviceStatus("creating the scene"));
  // Robust: no ray slips between two triangles that share an edge.
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST |
                              RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  // Refitting takes both: at any other quality of the scene Embree builds one tree over all of it,
  // anew in each commit, whatever the geometry asks for.
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, corners.data(),
                             0, 3 * sizeof(uint32_t), corners.size() / 3);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             vertices.data(), 0, 3 * sizeof(float), num_vertices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
  return DeviceStatus("building the scene");
}

std::array<Vec3, 3> Picker::Impl::Corners(uint32_t triangle) const {
  std::array<Vec3, 3> result;
  for (size_t i = 0; i < 3; ++i) {
    const float* p = &vertices[3 * static_cast<size_t>(corners[3 * size_t{triangle} + i])];
    result[i] = {p[0], p[1], p[2]};
  }
  return result;
}

bool Picker::Impl::IsHidden(const PickRay& ray, Double3 unit_direction, Vec3 handle,
                            double distance, const HandlePickOptions& options) const {
  // Looked at from the common eye of a perspective camera, or along the parallel rays of an
  // orthographic one.
  const Double3 target = ToDouble(handle);
  Double3 origin = ToDouble(ray.origin);
  if (options.cone_tangent <= 0) origin = target - distance * unit_direction;
  const Double3 to_handle = target - origin;
  const double length = Length(to_handle);
  const double reach = length - static_cast<double>(options.depth_tolerance) * diagonal;
  if (!(reach > ray.near_distance)) return false;
  RTCRay segment = MakeRay(origin, (1 / length) * to_handle, ray.near_distance, reach);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &segment);
  return segment.tfar < 0;
}

Picker::Picker(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Picker::Picker(Picker&&) noexcept = default;
Picker& Picker::operator=(Picker&&) noexcept = default;
Picker::~Picker() = default;

Result<Picker> Picker::Create(const SkinMesh& mesh, std::span<const Vec3> solve_positions) {
  return CatchOutOfMemory("picker", [&]() -> Result<Picker> {
    auto impl = std::make_unique<Impl>();
    LIMBER_RETURN_IF_ERROR(impl->Build(mesh, solve_positions));
    return Picker(std::move(impl));
  });
}

Status Picker::Update(std::span<const Vec3> solve_positions) {
  LIMBER_RETURN_IF_ERROR(CheckPositions(solve_positions, impl_->num_vertices));
  impl_->CopyPositions(solve_positions);
  KeepFloatingPoint keep;
  rtcUpdateGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(impl_->geometry);
  rtcCommitScene(impl_->scene);
  return impl_->DeviceStatus("refitting the scene");
}

std::optional<SurfaceHit> Picker::PickSurface(const PickRay& ray) const {
  const std::optional<Double3> direction = UnitDirection(ray);
  if (!direction) return std::nullopt;
  const Double3 origin = ToDouble(ray.origin);

  KeepFloatingPoint keep;
  RTCRayHit query = {};
  query.ray = MakeRay(origin, *direction, ray.near_distance, ray.far_distance);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  // A second look at everything that the first hit ties with: which of two neighbours is found
  // first depends on how the tree was built, the lowest of them does not.
  LowestTriangle lowest = {};
  rtcInitIntersectContext(&lowest.base);
  lowest.base.filter = KeepLowestTriangle;
  lowest.triangle = query.hit.primID;
  const double nearest = query.ray.tfar;
  RTCRayHit again = {};
  again.ray = MakeRay(origin, *direction, ray.near_distance,
                      std::min<double>(ray.far_distance, nearest * (1 + kTieFraction)));
  again.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &lowest.base, &again);

  const std::array<Vec3, 3> corners = impl_->Corners(lowest.triangle);
  const std::optional<TriangleHit> exact = HitTriangle(origin, *direction, corners);
  if (!exact) return std::nullopt;
  SurfaceHit hit;
  hit.distance = static_cast<float>(exact->distance);
  hit.triangle = lowest.triangle;
  for (size_t i = 0; i < 3; ++i) {
    hit.barycentrics[i] = static_cast<float>(exact->barycentrics[i]);
    hit.solve_vertices[i] = impl_->corners[3 * size_t{lowest.triangle} + i];
  }
  hit.point = ToFloat(exact->point);
  hit.normal = ToFloat(exact->normal);
  hit.front_facing = exact->front_facing;
  return hit;
}

std::optional<HandleHit> Picker::PickHandle(const PickRay& ray,
                                            std::span<const Vec3> handle_positions,
                                            const HandlePickOptions& options) const {
  const std::optional<Double3> direction = UnitDirection(ray);
  if (!direction) return std::nullopt;
  KeepFloatingPoint keep;
  HandleScore best;
  int best_handle = -1;
  for (size_t i = 0; i < handle_positions.size(); ++i) {
    const Vec3 handle = handle_positions[i];
    const std::optional<HandleScore> score = ScoreHandle(ray, *direction, handle, options);
    if (!score || (best_handle >= 0 && !score->BetterThan(best))) continue;
    if (options.occlusion && impl_->IsHidden(ray, *direction, handle, score->distance, options)) {
      continue;
    }
    best = *score;
    best_handle = static_cast<int>(i);
  }
  if (best_handle < 0) return std::nullopt;
  return HandleHit{best_handle, static_cast<float>(best.distance), static_cast<float>(best.offset)};
}

float Picker::diagonal() const {
  return impl_->diagonal;
}

}  // namespace limber
