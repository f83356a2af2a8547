// limber.h: where a ray meets the skin.
#include "capi/context.h"
#include "capi/instance_calls.h"

#include <algorithm>
#include <cmath>

namespace limber::capi {
namespace {

CallStatus ReadVector(const float from[3], const char* name, Vec3* to) {
  if (from == nullptr) return NullArgument(name);
  *to = {from[0], from[1], from[2]};
  if (IsFinite(*to)) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT, std::string(name) + ": it is not finite"};
}

LimberPickHit HitOf(const NearestHit& found, const SkinMesh& mesh) {
  LimberPickHit hit = {};
  hit.found = 1;
  hit.front_facing = found.at.front_facing ? 1 : 0;
  hit.triangle = found.triangle;
  for (size_t i = 0; i < 3; ++i) {
    hit.point.vertices[i] = mesh.triangles[size_t{3} * found.triangle + i];
    hit.point.weights[i] = static_cast<float>(found.at.barycentrics[i]);
  }
  const Vec3 position = ToFloat(found.at.point), normal = ToFloat(found.at.normal);
  std::copy_n(&position.x, 3, hit.position);
  std::copy_n(&normal.x, 3, hit.normal);
  hit.distance = static_cast<float>(found.at.distance);
  return hit;
}

CallStatus Pick(Instance* instance, Vec3 origin, Vec3 direction, PickScratch* scratch,
                LimberPickHit* hit) {
  const SkinMesh& mesh = instance->rig->mesh();
  scratch->positions.resize(mesh.num_draw_vertices);
  LimberSkinDef def = limberDefaultSkinDef();
  def.num_vertices = mesh.num_draw_vertices;
  def.positions.data = scratch->positions.data();
  LIMBER_RETURN_IF_FAILED(SkinInstance(&def, instance));
  const EqualHits equal = instance->rig->dimension() == 2 ? EqualHits::kLast : EqualHits::kFirst;
  const auto found =
      scratch->finder.Find(scratch->positions, mesh.triangles, origin, direction, equal);
  *hit = found ? HitOf(*found, mesh) : LimberPickHit{};
  return {};
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberPick(LimberContext* context, LimberInstanceId instance, const float origin[3],
                        const float direction[3], LimberPickHit* hit) {
  return CallOn(context, "limberPick", instance, [&](Instance* of) -> CallStatus {
    Vec3 from, along;
    LIMBER_RETURN_IF_FAILED(ReadVector(origin, "origin", &from));
    LIMBER_RETURN_IF_FAILED(ReadVector(direction, "direction", &along));
    if (along.x == 0 && along.y == 0 && along.z == 0)
      return {LIMBER_ERROR_INVALID_ARGUMENT, "direction: of length zero"};
    if (hit == nullptr) return NullArgument("hit");
    if (of->skins == nullptr) return WithoutSkin();
    std::unique_ptr<PickScratch> scratch = of->skins->idle_picks.Take();
    if (scratch == nullptr) scratch = std::make_unique<PickScratch>();
    CallStatus picked = Pick(of, from, along, scratch.get(), hit);
    of->skins->idle_picks.Give(std::move(scratch));
    return picked;
  });
}

}  // extern "C"
