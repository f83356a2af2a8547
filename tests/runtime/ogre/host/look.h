// What a character's file says of its looks, which is the engine's affair and not Limber's: the
// colour picture and the materials.
#pragma once

#include <OgreImage.h>

#include <cstdint>
#include <string>
#include <vector>

struct Look {
  Ogre::Image colours;
  std::vector<float> roughness;  // of each material
};

// Of the first mesh of a .glb. Throws std::exception with the reason.
Look ReadLook(const std::string& glb_file);
