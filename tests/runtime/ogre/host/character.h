// One Limber character as an OGRE entity. Limber writes positions and normals straight into the
// vertex buffer that OGRE draws from; nothing lies between.
#pragma once

#include "look.h"

#include <Ogre.h>
#include <limber/limber.h>

#include <string>
#include <vector>

// The part of a vertex that changes each frame, as this engine likes it. What never changes, the
// texture coordinates, has a buffer of its own: a discarded buffer must be written whole.
struct MovingVertex {
  float normal[3];
  float position[3];
};

// Throws std::runtime_error with Limber's message.
void Check(LimberResult result, const LimberContext* context);

class Character {
 public:
  // `baked_file` is the character after `limber bake`. The context must outlive the character.
  Character(LimberContext* context, const std::string& baked_file, Ogre::SceneManager* scene);
  ~Character();
  Character(const Character&) = delete;
  Character& operator=(const Character&) = delete;

  // In mesh space; the names are the file's.
  void SetTarget(const std::string& handle, const Ogre::Vector3& position);
  // One fixed step: solves and writes the skin into OGRE's buffer.
  void Step();

  const LimberRigInfo& info() const { return info_; }

  const Ogre::AxisAlignedBox& rest_box() const { return rest_box_; }

  // How far the skin stands out from the box of its handles, at rest.
  float reach() const { return reach_; }

  Ogre::Entity* entity() const { return entity_; }

  std::vector<LimberHandleState> Handles() const;
  // The same skin by another call, into plain memory of another layout.
  std::vector<MovingVertex> SkinElsewhere() const;
  // What OGRE's buffer holds.
  std::vector<MovingVertex> ReadBack() const;

 private:
  void MakeVertices(Ogre::Mesh* mesh);
  void MakeParts(const Look& look, Ogre::Mesh* mesh);
  void MeasureRest();
  void SetBounds(const float bounds[6]);  // smallest, largest

  LimberContext* context_;
  LimberRigId rig_ = {};
  LimberInstanceId instance_ = {};
  LimberRigInfo info_ = {};
  Ogre::MeshPtr mesh_;
  Ogre::Entity* entity_ = nullptr;
  Ogre::HardwareVertexBufferSharedPtr moving_;
  Ogre::AxisAlignedBox rest_box_;
  float reach_ = 0;
};
