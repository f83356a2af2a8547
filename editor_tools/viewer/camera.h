// An orbit camera in mesh space: looks at a point from a distance, with y up.
#pragma once

#include "core/vec3.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"

#include <glm/glm.hpp>

#include <array>

namespace limber::viewer {

struct Bounds {
  Vec3 low, high;

  Vec3 centre() const;
  float diagonal() const;
};

// The box around all example shapes, mesh space. `shape` -1: all of them.
Bounds ShapeBounds(const SkinMesh& mesh, const RigSpace& space, int shape = -1);

struct Ray {
  Vec3 origin, direction;  // direction is unit
};

class OrbitCamera {
 public:
  // A view of the whole box from the front (along -z), a little from the right and above.
  static OrbitCamera Frame(const Bounds& bounds, float aspect);
  // Straight at the plane of a planar character (the xy plane of its rig space).
  static OrbitCamera FrameFlat(const Bounds& bounds, const RigSpace& space, float aspect);

  // Radians; the camera never tips over the poles.
  void Orbit(float yaw, float pitch);
  // Factor of the distance; below 1 comes nearer.
  void Zoom(float factor);
  // Moves what is looked at by a motion of the pointer in pixels.
  void Pan(float dx, float dy, float viewport_height);

  void set_aspect(float aspect) { aspect_ = aspect; }

  // Column-major matrix to Vulkan's clip space (y down, depth 0 to 1).
  glm::mat4 ClipFromMesh() const;
  Vec3 eye() const;

  float distance() const { return distance_; }

  bool flat() const { return flat_; }

  // Pixels count from the top left corner; the middle of the first pixel is (0.5, 0.5).
  Ray PixelRay(float x, float y, float width, float height) const;
  // {x, y, depth} in pixels and 0..1; depth above 1 or below 0: not in view.
  std::array<float, 3> Project(Vec3 point, float width, float height) const;
  // Where `point` goes when it is dragged to a pixel in the plane through it that faces the camera.
  Vec3 DragInViewPlane(Vec3 point, float x, float y, float width, float height) const;

 private:
  glm::mat4 MeshToView() const;
  glm::vec3 Backward() const;  // from the target to the eye
  glm::vec3 Up() const;

  glm::vec3 target_{0, 0, 0};
  glm::mat3 axes_{1};  // columns: right, up and back at yaw = pitch = 0
  float distance_ = 1, yaw_ = 0, pitch_ = 0, aspect_ = 1, size_ = 1;
  bool flat_ = false;
};

}  // namespace limber::viewer
