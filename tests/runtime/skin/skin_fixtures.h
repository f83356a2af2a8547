// Small characters that are skinned by hand: meshes with weights, and transforms for them.
#pragma once

#include "core/vector.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin/skin_transforms.h"

#include <array>

namespace limber::test {

struct SkinFixture {
  SkinMesh mesh;
  RigSpace space;
};

// The bend cylinder (support/test_meshes.h) with smooth normals; three handles along y with hat
// weights, three shapes. Rig space is not mesh space: it is scaled, turned and moved.
SkinFixture MakeCylinderFixture(int around, int along);

// A sphere of radius 1 with a seam: its first and last columns are different draw vertices with
// different texture coordinates. One shape, two handles; normals and tangents as a file would have.
SkinFixture MakeSeamSphereFixture(int around, int along);

// A cube of side 2 with hard edges: 24 draw vertices, 8 solve vertices. One shape, one handle.
SkinFixture MakeCubeFixture();

// Transforms that own their numbers.
struct SkinPose {
  Vector<float> matrices;  // [H][S][3][4]
  Vec3 origin;

  SkinTransforms view() const { return {matrices, origin}; }
};

// Every handle at rest in shape `shape`.
SkinPose RestPose(const SkinFixture& fixture, int shape = 0);

// An affine map of mesh space, row-major 3x4.
using Affine = std::array<double, 12>;
Affine RotationAffine(std::array<double, 3> axis, double angle, std::array<double, 3> translation);

// Handle h: a mix of the shapes, then `maps[h]` about the rig's origin.
// blend: [H][S] row-major; maps: H of them.
SkinPose MakePose(const SkinFixture& fixture, const Vector<float>& blend,
                  const Vector<Affine>& maps);

// A lively pose of the cylinder fixture: bent, twisted, bulging.
SkinPose CylinderPose(const SkinFixture& fixture, double amount);

// Smallest and largest coordinates of the first shape, as a length.
float FixtureSize(const SkinFixture& fixture);

}  // namespace limber::test
