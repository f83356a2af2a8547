// The bytes of a recording, for writing and reading alike: which fields an event has, in order.
#pragma once

#include "drive/input_events.h"

#include <bit>
#include <cstdint>
#include <cstring>

namespace limber {

template <class T>
void ToLittleEndian(const T& value, uint8_t* raw) {
  std::memcpy(raw, &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) {
    for (size_t i = 0; i < sizeof(T) / 2; ++i)
      std::swap(raw[i], raw[sizeof(T) - 1 - i]);
  }
}

template <class Visit>
void VisitBool(bool* value, const Visit& visit) {
  uint8_t byte = *value ? 1 : 0;
  visit(byte);
  *value = byte != 0;
}

template <class Visit>
void VisitHead(RecordingHead* head, const Visit& visit) {
  visit(head->rig_hash);
  visit(head->room.grabs);
  visit(head->room.rotations);
  VisitBool(&head->room.guaranteed, visit);
}

// All that results depend on; not the time budget, in place of which the alternations stand that
// were done.
template <class Visit>
void VisitOptions(PoseOptions* options, const Visit& visit) {
  visit(options->iterations);
  visit(options->lambda);
  VisitBool(&options->rotations, visit);
  VisitBool(&options->square_roots, visit);
  VisitBool(&options->varying_blend, visit);
  VisitBool(&options->guaranteed, visit);
  visit(options->settle_tolerance);
  visit(options->stretch_limit);
  visit(options->smoothing);
  visit(options->time_step);
}

template <class Visit>
void VisitPosition(Vec3* position, const Visit& visit) {
  visit(position->x);
  visit(position->y);
  visit(position->z);
}

template <class Visit>
void VisitPoint(SkinPoint* point, const Visit& visit) {
  for (uint32_t& vertex : point->vertices)
    visit(vertex);
  for (float& weight : point->weights)
    visit(weight);
}

// What follows an event's kind.
template <class Visit>
void VisitFields(InputEvent* event, const Visit& visit) {
  const InputKind kind = event->kind;
  if (kind == InputKind::kOptions) return VisitOptions(&event->options, visit);
  if (kind == InputKind::kResetToRest) return;
  if (kind == InputKind::kSolve) {
    visit(event->iterations);
    visit(event->pose_hash);
    return;
  }
  visit(event->index);
  if (kind == InputKind::kTarget || kind == InputKind::kGrabTarget)
    VisitPosition(&event->position, visit);
  if (kind == InputKind::kRotation) {
    visit(event->rotation.x);
    visit(event->rotation.y);
    visit(event->rotation.z);
    visit(event->rotation.w);
  }
  if (kind == InputKind::kGrab) VisitPoint(&event->point, visit);
  if (kind == InputKind::kRotation || kind == InputKind::kStiffness || kind == InputKind::kWeight ||
      kind == InputKind::kGrab) {
    visit(event->number);
  }
}

template <class Visit>
void VisitEvent(InputEvent* event, const Visit& visit) {
  auto kind = static_cast<uint8_t>(event->kind);
  visit(kind);
  event->kind = static_cast<InputKind>(kind);
  VisitFields(event, visit);
}

// Of what is written.
inline bool SameOptions(const PoseOptions& a, const PoseOptions& b) {
  uint8_t bytes_a[64], bytes_b[64];
  const auto encode = [](PoseOptions options, uint8_t* to) {
    size_t size = 0;
    VisitOptions(&options, [&](auto& value) {
      std::memcpy(to + size, &value, sizeof(value));
      size += sizeof(value);
    });
    return size;
  };
  const size_t size = encode(a, bytes_a);
  return size == encode(b, bytes_b) && std::memcmp(bytes_a, bytes_b, size) == 0;
}

}  // namespace limber
