// What must hold of a frame and of a picture. Each failure is one line on stderr.
#pragma once

#include "character.h"

#include <OgreImage.h>

class Checks {
 public:
  // `rest` is the skin at rest; lengths are measured by the rig's diagonal.
  Checks(const Character& character, std::vector<MovingVertex> rest);

  // That OGRE's buffer holds the bits of a skin elsewhere, that the box holds all of it, and that
  // the vertices around each held handle went where its target is.
  void LookAtFrame(int frame);
  // That the character covers a sensible part of the picture and does not touch its border.
  // `empty` is the same scene without it.
  void LookAtPicture(int frame, const Ogre::Image& picture, const Ogre::Image& empty);
  // That something is missing where one part of the character is not drawn.
  void LookAtPart(const Ogre::Image& whole, const Ogre::Image& without);
  // That the drag went far, and that a dragged character looks otherwise than at rest.
  void LookAtChange(const Ogre::Image& rest, const Ogre::Image& dragged);

  int num_failures() const { return num_failures_; }

  // The farthest that any target went from its rest, and that any handle's nearest vertex stayed
  // from its target, as parts of the diagonal.
  float farthest() const { return farthest_; }

  float worst_miss() const { return worst_miss_; }

 private:
  void Expect(bool holds, int frame, const std::string& what);
  void LookAtHandle(int frame, size_t handle, const std::vector<MovingVertex>& skin,
                    const LimberHandleState& state);

  const Character& character_;
  std::vector<MovingVertex> rest_;
  std::vector<LimberHandleState> rest_handles_;
  int num_failures_ = 0;
  float farthest_ = 0, worst_miss_ = 0;
};

// How many pixels differ between two pictures of one size, as a part of all.
double PartThatDiffers(const Ogre::Image& a, const Ogre::Image& b);
