// Normals and tangents of skin_kernels.h, for one instruction set. See skin_lanes.h.
//
// What skin_frames.cpp does, operation for operation and without fused ones, so that all sets and
// the plain functions there give the same bits. Where those branch off the usual way (no area, no
// direction, out of range), a lane is reported and its numbers mean nothing.
#pragma once

#include "skin/kernels/skin_lanes.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

struct Vector {
  Lanes x, y, z;
};

#define LIMBER_INLINE static inline __attribute__((always_inline))

LIMBER_INLINE Vector operator+(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

LIMBER_INLINE Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

LIMBER_INLINE Vector operator*(Lanes s, const Vector& v) {
  return {s * v.x, s * v.y, s * v.z};
}

LIMBER_INLINE Lanes Dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

LIMBER_INLINE Vector Cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

LIMBER_INLINE Vector Normalized(const Vector& v) {
  return (Splat(1) / SquareRoot(Dot(v, v))) * v;
}

LIMBER_INLINE Mask IsDirection(const Vector& v) {
  const Lanes squared = Dot(v, v);
  return (squared > Splat(kTinySquare)) & (squared < Splat(kHugeSquare));
}

// The direction of v as far as it is orthogonal to a unit vector; `usual` only where enough of it
// is left to need no second step.
LIMBER_INLINE Vector OrthogonalDirection(const Vector& v, const Vector& unit, Mask* usual) {
  const Vector rest = v - Dot(unit, v) * unit;
  *usual &= IsDirection(rest) & (Dot(rest, rest) > Splat(0.01f) * Dot(v, v));
  return Normalized(rest);
}

LIMBER_INLINE Vector LoadVector(const float* base, const uint32_t* offsets) {
  const Columns columns = LoadRows(base, offsets);
  return {columns.column[0], columns.column[1], columns.column[2]};
}

struct Frame {
  Vector t, b, n, first, second;
};

LIMBER_INLINE Frame SumCorners(const FrameBlocks& blocks, size_t block, size_t lane,
                               const float* positions) {
  const Lanes scale = Splat(blocks.inverse_scale), zero = Splat(0);
  const Vector none = {zero, zero, zero};
  Frame frame = {none, none, none, none, none};
  const Vector centre = LoadVector(positions, blocks.centres + block * kLanes + lane);
  for (size_t c = blocks.first_corner[block]; c < blocks.first_corner[block + 1]; ++c) {
    const uint32_t* others = blocks.others + c * 2 * kLanes + lane;
    const float* coefficients = blocks.coefficients + c * 4 * kLanes + lane;
    const Vector e1 = scale * (LoadVector(positions, others) - centre);
    const Vector e2 = scale * (LoadVector(positions, others + kLanes) - centre);
    frame.n = frame.n + Cross(e1, e2);
    frame.first = frame.first + Load(coefficients) * e1 + Load(coefficients + kLanes) * e2;
    frame.second =
        frame.second + Load(coefficients + 2 * kLanes) * e1 + Load(coefficients + 3 * kLanes) * e2;
  }
  return frame;
}

LIMBER_INLINE Mask FitFrame(Frame* frame) {
  const Vector &n = frame->n, &first = frame->first, &second = frame->second;
  Mask usual =
      (Dot(n, n) + Dot(first, first) + Dot(second, second) < Splat(kHugeSquare)) & IsDirection(n);
  const Vector unit = Normalized(n);
  const Vector t = OrthogonalDirection(first, unit, &usual), b = Cross(unit, t);
  const Lanes c = Dot(first, t) + Dot(second, b), s = Dot(first, b) - Dot(second, t);
  const Lanes length = SquareRoot(c * c + s * s);
  usual &= length * length > Splat(kTinySquare);
  frame->n = unit;
  frame->t = (c / length) * t + (s / length) * b;
  frame->b = (c / length) * b - (s / length) * t;
  return usual;
}

static size_t ComputeFrames(const FrameBlocks& blocks, const float* positions, float* frames,
                            uint32_t* unusual) {
  size_t num_unusual = 0;
  for (size_t begin = 0; begin < blocks.num_groups; begin += kLanes) {
    for (size_t lane = 0; lane < kLanes; lane += kWidth) {
      Frame frame = SumCorners(blocks, begin / kLanes, lane, positions);
      const Mask usual = FitFrame(&frame);
      const uint32_t* groups = blocks.order + begin + lane;
      size_t rows[kWidth];
      for (size_t i = 0; i < kWidth; ++i) {
        rows[i] = size_t{groups[i]} * kFrameFloats;
        if (usual[i] == 0 && groups[i] < blocks.num_groups) unusual[num_unusual++] = groups[i];
      }
      const auto valid = (Lanes)(usual & 1);
      StoreRows({{valid, frame.t.x, frame.t.y, frame.t.z}}, frames, rows);
      StoreRows({{frame.b.x, frame.b.y, frame.b.z, frame.n.x}}, frames + 4, rows);
      StoreRows({{frame.n.y, frame.n.z, frame.first.x, frame.first.y}}, frames + 8, rows);
      StoreRows({{frame.first.z, frame.second.x, frame.second.y, frame.second.z}}, frames + 12,
                rows);
    }
  }
  return num_unusual;
}

static void ApplyFrames(const float* frames, const float* vertices, const uint32_t* groups,
                        AppliedFrames* applied) {
  for (size_t lane = 0; lane < kLanes; lane += kWidth) {
    size_t rows[kWidth], places[kWidth];
    for (size_t i = 0; i < kWidth; ++i) {
      rows[i] = size_t{groups[lane + i]} * kFrameFloats;
      places[i] = (lane + i) * kDrawVertexFloats;
    }
    const Columns normal = LoadRows(vertices, places), tangent = LoadRows(vertices + 4, places);
    const Columns a = LoadRows(frames, rows), b = LoadRows(frames + 4, rows);
    const Columns c = LoadRows(frames + 8, rows), d = LoadRows(frames + 12, rows);
    const Vector frame_t = {a.column[1], a.column[2], a.column[3]};
    const Vector frame_b = {b.column[0], b.column[1], b.column[2]};
    const Vector frame_n = {b.column[3], c.column[0], c.column[1]};
    const Vector first = {c.column[2], c.column[3], d.column[0]};
    const Vector second = {d.column[1], d.column[2], d.column[3]};
    Mask usual = (Mask)a.column[0] != 0;
    const Vector n = Normalized(normal.column[0] * frame_t + normal.column[1] * frame_b +
                                normal.column[2] * frame_n);
    const Vector t =
        OrthogonalDirection(tangent.column[0] * first + tangent.column[1] * second, n, &usual);
    const Lanes results[6] = {n.x, n.y, n.z, t.x, t.y, t.z};
    for (size_t i = 0; i < 6; ++i)
      __builtin_memcpy(&applied->numbers[i][lane], &results[i], sizeof(Lanes));
    __builtin_memcpy(&applied->usual[lane], &usual, sizeof(Mask));
  }
}

#undef LIMBER_INLINE

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
