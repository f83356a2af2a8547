// limber.h: what holds a character, and how firmly.
#include "capi/inputs.h"

namespace limber::capi {
namespace {

// The host's point, of draw vertices, as one of solve vertices.
CallStatus ToSkinPoint(const LimberSkinPoint* point, const Rig& rig, SkinPoint* to) {
  if (point == nullptr) return NullArgument("point");
  const SkinMesh& mesh = rig.mesh();
  for (size_t i = 0; i < 3; ++i) {
    if (point->vertices[i] >= mesh.num_draw_vertices) {
      return {LIMBER_ERROR_INVALID_ARGUMENT, "point: vertex " + std::to_string(point->vertices[i]) +
                                                 "; the rig has " +
                                                 std::to_string(mesh.num_draw_vertices)};
    }
    to->vertices[i] = mesh.solve_vertex[point->vertices[i]];
    to->weights[i] = point->weights[i];
  }
  return CheckSkinPoint(rig, *to);
}

void Put(const Vec3& from, float to[3]) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberPin(LimberContext* context, LimberInstanceId instance, int32_t handle) {
  return CallOn(context, "limberPin", instance,
                [&](Instance* of) { return Ask(HandleEvent(InputKind::kPin, handle), of); });
}

LimberResult limberUnpin(LimberContext* context, LimberInstanceId instance, int32_t handle) {
  return CallOn(context, "limberUnpin", instance,
                [&](Instance* of) { return Ask(HandleEvent(InputKind::kUnpin, handle), of); });
}

LimberResult limberSetStiffness(LimberContext* context, LimberInstanceId instance, int32_t handle,
                                float stiffness) {
  return CallOn(context, "limberSetStiffness", instance, [&](Instance* of) {
    return Ask(HandleEvent(InputKind::kStiffness, handle, stiffness), of);
  });
}

LimberResult limberSetWeight(LimberContext* context, LimberInstanceId instance, int32_t handle,
                             float weight) {
  return CallOn(context, "limberSetWeight", instance, [&](Instance* of) {
    return Ask(HandleEvent(InputKind::kWeight, handle, weight), of);
  });
}

LimberResult limberGetHandle(LimberContext* context, LimberInstanceId instance, int32_t handle,
                             LimberHandleState* state) {
  return CallOn(context, "limberGetHandle", instance, [&](Instance* of) -> CallStatus {
    if (state == nullptr) return NullArgument("state");
    const Rig& rig = of->state.rig();
    LIMBER_RETURN_IF_FAILED(CheckHandle(rig, handle));
    SkinPoint point;
    point.vertices.fill(rig.tables().handles[static_cast<size_t>(handle)].vertex);
    Put(of->state.target(handle), state->target);
    Put(of->state.Place(point), state->position);
    state->pinned = of->state.is_pinned(handle) ? 1 : 0;
    return {};
  });
}

LimberResult limberGrab(LimberContext* context, LimberInstanceId instance,
                        const LimberSkinPoint* point, float stiffness, int32_t* grab) {
  return CallOn(context, "limberGrab", instance, [&](Instance* of) -> CallStatus {
    if (grab == nullptr) return NullArgument("grab");
    InputEvent event = HandleEvent(InputKind::kGrab, 0, stiffness);
    LIMBER_RETURN_IF_FAILED(ToSkinPoint(point, of->state.rig(), &event.point));
    return Ask(event, of, grab);
  });
}

LimberResult limberSetGrabTarget(LimberContext* context, LimberInstanceId instance, int32_t grab,
                                 const float position[3]) {
  return CallOn(context, "limberSetGrabTarget", instance, [&](Instance* of) -> CallStatus {
    if (position == nullptr) return NullArgument("position");
    InputEvent event = TargetEvent(grab, {position[0], position[1], position[2]});
    event.kind = InputKind::kGrabTarget;
    return Ask(event, of);
  });
}

LimberResult limberRelease(LimberContext* context, LimberInstanceId instance, int32_t grab) {
  return CallOn(context, "limberRelease", instance,
                [&](Instance* of) { return Ask(HandleEvent(InputKind::kRelease, grab), of); });
}

LimberResult limberGetPlace(LimberContext* context, LimberInstanceId instance,
                            const LimberSkinPoint* point, float position[3]) {
  return CallOn(context, "limberGetPlace", instance, [&](Instance* of) -> CallStatus {
    if (position == nullptr) return NullArgument("position");
    SkinPoint on_skin;
    LIMBER_RETURN_IF_FAILED(ToSkinPoint(point, of->state.rig(), &on_skin));
    Put(of->state.Place(on_skin), position);
    return {};
  });
}

}  // extern "C"
