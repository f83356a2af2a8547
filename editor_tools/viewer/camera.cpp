#include "viewer/camera.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::viewer {
namespace {

// A long lens: little perspective, as portraits are taken.
constexpr float kFieldOfView = 0.48f;
constexpr float kSteepest = 1.5f;

glm::vec3 ToGlm(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 FromGlm(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace

Vec3 Bounds::centre() const {
  return {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
}

float Bounds::diagonal() const {
  return glm::length(ToGlm(high) - ToGlm(low));
}

Bounds ShapeBounds(const SkinMesh& mesh, const RigSpace& space, int shape) {
  const size_t count = mesh.num_solve_vertices;
  const size_t begin = shape < 0 ? 0 : static_cast<size_t>(shape) * count;
  const size_t end = shape < 0 ? mesh.shape_positions.size() : begin + count;
  Bounds bounds;
  constexpr float kHuge = std::numeric_limits<float>::max();
  bounds.low = {kHuge, kHuge, kHuge};
  bounds.high = {-kHuge, -kHuge, -kHuge};
  const auto& m = space.basis;
  for (size_t v = begin; v < std::min(end, mesh.shape_positions.size()); ++v) {
    const Vec3 p = mesh.shape_positions[v];
    for (int axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<size_t>(axis);
      const float x =
          space.origin[row] + space.scale * (m[row] * p.x + m[row + 3] * p.y + m[row + 6] * p.z);
      bounds.low[axis] = std::min(bounds.low[axis], x);
      bounds.high[axis] = std::max(bounds.high[axis], x);
    }
  }
  return begin < end ? bounds : Bounds{};
}

OrbitCamera OrbitCamera::Frame(const Bounds& bounds, float aspect) {
  OrbitCamera camera;
  camera.aspect_ = aspect;
  camera.target_ = ToGlm(bounds.centre());
  camera.size_ = std::max(bounds.diagonal(), 1e-12f);
  camera.distance_ = 0.1f * camera.size_;
  camera.yaw_ = 0.45f;
  camera.pitch_ = 0.2f;
  // The nearest distance from which every corner is in view, with a margin.
  const glm::vec3 half = 0.5f * (ToGlm(bounds.high) - ToGlm(bounds.low));
  const glm::vec3 back = camera.Backward(), up = camera.Up(), right = glm::cross(up, back);
  const float slope = std::tan(kFieldOfView / 2) / 1.1f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 offset((corner & 1) != 0 ? half.x : -half.x,
                           (corner & 2) != 0 ? half.y : -half.y,
                           (corner & 4) != 0 ? half.z : -half.z);
    const float reach =
        std::max(std::abs(glm::dot(offset, up)), std::abs(glm::dot(offset, right)) / aspect);
    camera.distance_ = std::max(camera.distance_, glm::dot(offset, back) + reach / slope);
  }
  return camera;
}

OrbitCamera OrbitCamera::FrameFlat(const Bounds& bounds, const RigSpace& space, float aspect) {
  OrbitCamera camera;
  camera.flat_ = true;
  camera.aspect_ = aspect;
  camera.target_ = ToGlm(bounds.centre());
  camera.size_ = std::max(bounds.diagonal(), 1e-12f);
  const auto& m = space.basis;
  camera.axes_ = glm::mat3(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
  // Of the two sides and the four quarter turns: the one that keeps +y up and +z to the viewer.
  glm::vec3 back = camera.axes_[2];
  if (back.z < -1e-3f || (std::abs(back.z) <= 1e-3f && back.x + back.y < 0)) back = -back;
  glm::vec3 up = std::abs(back.y) > 0.9f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  const glm::vec3 right = glm::normalize(glm::cross(up, back));
  up = glm::cross(back, right);
  camera.axes_ = glm::mat3(right, up, back);
  const glm::vec3 half = 0.5f * (ToGlm(bounds.high) - ToGlm(bounds.low));
  const float height = glm::dot(glm::abs(up), half), width = glm::dot(glm::abs(right), half);
  camera.distance_ = std::max(height, width / aspect) * 1.15f / std::tan(kFieldOfView / 2);
  return camera;
}

void OrbitCamera::Orbit(float yaw, float pitch) {
  yaw_ += yaw;
  pitch_ = std::clamp(pitch_ + pitch, -kSteepest, kSteepest);
}

void OrbitCamera::Zoom(float factor) {
  distance_ = std::clamp(distance_ * factor, 0.05f * size_, 50 * size_);
}

void OrbitCamera::Pan(float dx, float dy, float viewport_height) {
  const float scale = 2 * distance_ * std::tan(kFieldOfView / 2) / std::max(viewport_height, 1.0f);
  const glm::vec3 up = Up(), right = glm::cross(up, Backward());
  target_ += scale * (dy * up - dx * right);
}

glm::vec3 OrbitCamera::Backward() const {
  return axes_ * glm::vec3(std::cos(pitch_) * std::sin(yaw_), std::sin(pitch_),
                           std::cos(pitch_) * std::cos(yaw_));
}

glm::vec3 OrbitCamera::Up() const {
  return axes_ * glm::vec3(-std::sin(pitch_) * std::sin(yaw_), std::cos(pitch_),
                           -std::sin(pitch_) * std::cos(yaw_));
}

Vec3 OrbitCamera::eye() const {
  return FromGlm(target_ + distance_ * Backward());
}

glm::mat4 OrbitCamera::MeshToView() const {
  return glm::lookAt(target_ + distance_ * Backward(), target_, Up());
}

glm::mat4 OrbitCamera::ClipFromMesh() const {
  const float near_plane = std::max(distance_ - 3 * size_, 0.02f * distance_);
  glm::mat4 projection =
      glm::perspectiveRH_ZO(kFieldOfView, aspect_, near_plane, distance_ + 5 * size_);
  projection[1][1] = -projection[1][1];
  return projection * MeshToView();
}

Ray OrbitCamera::PixelRay(float x, float y, float width, float height) const {
  const float slope = std::tan(kFieldOfView / 2);
  const glm::vec3 back = Backward(), up = Up(), right = glm::cross(up, back);
  const float sx = (2 * x / width - 1) * slope * aspect_, sy = (1 - 2 * y / height) * slope;
  const glm::vec3 direction = glm::normalize(sx * right + sy * up - back);
  return {eye(), FromGlm(direction)};
}

std::array<float, 3> OrbitCamera::Project(Vec3 point, float width, float height) const {
  const glm::vec4 clip = ClipFromMesh() * glm::vec4(ToGlm(point), 1);
  if (!(clip.w > 0)) return {0, 0, -1};
  return {(clip.x / clip.w + 1) / 2 * width, (clip.y / clip.w + 1) / 2 * height, clip.z / clip.w};
}

Vec3 OrbitCamera::DragInViewPlane(Vec3 point, float x, float y, float width, float height) const {
  const Ray ray = PixelRay(x, y, width, height);
  const glm::vec3 back = Backward(), origin = ToGlm(ray.origin);
  const glm::vec3 direction = ToGlm(ray.direction);
  const float along = glm::dot(back, ToGlm(point) - origin) / glm::dot(back, direction);
  return along > 0 ? FromGlm(origin + along * direction) : point;
}

}  // namespace limber::viewer
