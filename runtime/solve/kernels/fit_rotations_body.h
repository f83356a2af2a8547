// Procrustes, eight blocks at once: R = argmax over SO(k) of tr(R M) (eq. 22 of Wampler 2016).
//
// k = 3 is Newton's method on the group, from the rotation of the last alternation. With S = R M,
//     tr(exp([w]) S) = tr S + v.w - 1/2 w.(A w) + ...,   v = axial part of S,  A = tr(S) I - sym S,
// and a point where v = 0 is the global maximum exactly where A is positive semi-definite (its
// eigenvalues are the pairwise sums of S's), so the result is certified, not hoped for. Blocks that
// start too far away say so and are left to a singular value decomposition.
//
// A little of the last rotation is added to M: where M leaves R undetermined (edges along one line,
// a reflection with two equal singular values, no edges at all) R stays as near as it can to what
// it was. A rotation at rest is not moved by this.
#pragma once

#include "solve/kernels/chunk.h"
#include "solve/kernels/solve_kernels.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

static constexpr double kBias = 1e-9;        // of M's largest entry
static constexpr int kMaxNewtonSteps = 6;    // two are usual
static constexpr double kConverged = 1e-10;  // |w|^2 of a last step: cubic, so that nothing is left
static constexpr double kTorqueOfRounding = 1e-14;  // |v| that means nothing, of M's largest entry
static constexpr double kFarthest = 1.0;  // |w|^2 that a quadratic model can be trusted with

using Matrix3 = Chunk[3][3];

static inline __attribute__((always_inline)) void Multiply(const Matrix3& x, const Matrix3& y,
                                                           Matrix3& product) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      product[i][j] = MulAdd(x[i][0], y[0][j], MulAdd(x[i][1], y[1][j], x[i][2] * y[2][j]));
    }
  }
}

// R (3 - R^T R) / 2: a nearly orthogonal matrix made orthogonal to rounding, so that a million
// frames of products do not add up.
static inline __attribute__((always_inline)) void Orthonormalise(Matrix3& r) {
  Matrix3 gap, result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Chunk product = MulAdd(r[0][i], r[0][j], MulAdd(r[1][i], r[1][j], r[2][i] * r[2][j]));
      gap[i][j] = gap[j][i] = MulAdd(SplatChunk(-0.5), product, SplatChunk(i == j ? 1.5 : 0));
    }
  }
  Multiply(r, gap, result);
  __builtin_memcpy(&r, &result, sizeof(Matrix3));
}

// Where only the bias holds R, rounding alone would turn it, a little every frame.
static inline __attribute__((always_inline)) Chunk WithoutRounding(Chunk torque) {
  return Select(Abs(torque) > kTorqueOfRounding, torque, Chunk{});
}

// w = A^-1 v; returns where A is positive definite.
static inline __attribute__((always_inline)) ChunkMask NewtonStep(const Matrix3& s, Chunk (&w)[3]) {
  const Chunk a00 = s[1][1] + s[2][2], a11 = s[0][0] + s[2][2], a22 = s[0][0] + s[1][1];
  const Chunk a01 = -0.5 * (s[0][1] + s[1][0]), a02 = -0.5 * (s[0][2] + s[2][0]),
              a12 = -0.5 * (s[1][2] + s[2][1]);
  const Chunk c00 = MulSub(a11, a22, a12 * a12), c01 = MulSub(a02, a12, a01 * a22),
              c02 = MulSub(a01, a12, a02 * a11), c11 = MulSub(a00, a22, a02 * a02),
              c12 = MulSub(a01, a02, a00 * a12), c22 = MulSub(a00, a11, a01 * a01);
  const Chunk determinant = MulAdd(a00, c00, MulAdd(a01, c01, a02 * c02));
  const ChunkMask definite = (a00 > 0) & (c22 > 0) & (determinant > 0);
  const Chunk inverse = 1 / Select(definite, determinant, SplatChunk(1));
  const Chunk v0 = WithoutRounding(s[1][2] - s[2][1]), v1 = WithoutRounding(s[2][0] - s[0][2]),
              v2 = WithoutRounding(s[0][1] - s[1][0]);
  w[0] = MulAdd(c00, v0, MulAdd(c01, v1, c02 * v2)) * inverse;
  w[1] = MulAdd(c01, v0, MulAdd(c11, v1, c12 * v2)) * inverse;
  w[2] = MulAdd(c02, v0, MulAdd(c12, v1, c22 * v2)) * inverse;
  return definite;
}

// R <- Q R with Q the rotation of the quaternion (1, w/2): exp([w]) to third order.
static inline __attribute__((always_inline)) void Turn(const Chunk (&w)[3], Matrix3& r) {
  const Chunk x = 0.5 * w[0], y = 0.5 * w[1], z = 0.5 * w[2];
  const Chunk inverse = 2 / MulAdd(x, x, MulAdd(y, y, MulAdd(z, z, SplatChunk(1))));
  const Chunk real = inverse - 1;  // (1 - |w/2|^2) / (1 + |w/2|^2)
  const Chunk u = inverse * x, v = inverse * y, t = inverse * z;
  const Matrix3 q = {{MulAdd(u, x, real), MulSub(u, y, t), MulAdd(u, z, v)},
                     {MulAdd(u, y, t), MulAdd(v, y, real), MulSub(v, z, u)},
                     {MulSub(u, z, v), MulAdd(v, z, u), MulAdd(t, z, real)}};
  Matrix3 result;
  Multiply(q, r, result);
  __builtin_memcpy(&r, &result, sizeof(Matrix3));
}

// M: the fits, scaled to a largest entry of one, and the bias.
static inline __attribute__((always_inline)) void ScaledFits(const double* fits, const Matrix3& r,
                                                             Matrix3& m) {
  Chunk largest = SplatChunk(1e-300);
  for (int i = 0; i < 9; ++i)
    largest = Max(largest, Abs(LoadChunk(fits + i * kLanes)));
  const Chunk inverse = 1 / largest;
  for (int a = 0; a < 3; ++a) {
    for (int c = 0; c < 3; ++c)
      m[a][c] = MulAdd(LoadChunk(fits + (a * 3 + c) * kLanes), inverse, kBias * r[c][a]);
  }
}

static inline void FitChunk3(const double* fits, double* rotations, uint8_t* failed) {
  Matrix3 r, start, m, s;
  for (int i = 0; i < 9; ++i)
    r[i / 3][i % 3] = LoadChunk(rotations + i * kLanes);
  Orthonormalise(r);
  __builtin_memcpy(&start, &r, sizeof(Matrix3));
  ScaledFits(fits, r, m);
  ChunkMask lost = {}, settled = {};  // a settled lane is left alone, whatever its neighbours need
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    Chunk w[3];
    Multiply(r, m, s);
    const ChunkMask definite = NewtonStep(s, w);
    const Chunk squared = MulAdd(w[0], w[0], MulAdd(w[1], w[1], w[2] * w[2]));
    lost = lost | (~settled & ~(definite & (squared <= kFarthest)));
    for (Chunk& component : w)
      component = Select(lost | settled, Chunk{}, component);
    Turn(w, r);
    settled = settled | (~lost & (squared <= kConverged));
    if (AreAllSet(lost | settled)) break;
  }
  lost = lost | ~settled;
  for (int i = 0; i < 9; ++i)
    Store(Select(lost, start[i / 3][i % 3], r[i / 3][i % 3]), rotations + i * kLanes);
  for (size_t lane = 0; lane < kLanes; ++lane)
    failed[lane] = IsSet(lost, lane) ? 1 : 0;
}

// tr(R M) = cos (m00 + m11) + sin (m01 - m10).
static inline void FitChunk2(const double* fits, double* rotations, uint8_t* failed) {
  for (size_t lane = 0; lane < kLanes; ++lane) {
    double largest = 1e-300;
    for (int i = 0; i < 4; ++i) {
      const double size = __builtin_fabs(fits[i * kLanes + lane]);
      largest = size > largest ? size : largest;
    }
    double c = (fits[lane] + fits[3 * kLanes + lane]) / largest;
    double s = (fits[kLanes + lane] - fits[2 * kLanes + lane]) / largest;
    c += 2 * kBias * rotations[lane];
    s += 2 * kBias * rotations[2 * kLanes + lane];
    const double length = __builtin_sqrt(c * c + s * s);
    failed[lane] = length > 0 ? 0 : 1;
    if (!(length > 0)) continue;
    rotations[lane] = rotations[3 * kLanes + lane] = c / length;
    rotations[2 * kLanes + lane] = s / length;
    rotations[kLanes + lane] = -(s / length);
  }
}

template <int K>
static void FitRotations(const double* fits, double* rotations, size_t chunks, uint8_t* failed) {
  constexpr size_t kPlanes = size_t{K} * K * kLanes;
  for (size_t chunk = 0; chunk < chunks; ++chunk) {
    if constexpr (K == 3) {
      FitChunk3(fits + chunk * kPlanes, rotations + chunk * kPlanes, failed + chunk * kLanes);
    } else {
      FitChunk2(fits + chunk * kPlanes, rotations + chunk * kPlanes, failed + chunk * kLanes);
    }
  }
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
