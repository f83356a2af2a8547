// What a character's file says of its looks, which the engine needs and Limber does not give: the
// colour picture, and which triangles have which material.
#pragma once

#include <OgreImage.h>

#include <cstdint>
#include <string>
#include <vector>

struct LookPart {
  uint32_t first_triangle = 0, num_triangles = 0;
  float roughness = 1;
};

struct Look {
  Ogre::Image colours;
  std::vector<LookPart> parts;  // one for each primitive of the mesh, in the file's order
};

// Of the first mesh of a .glb. Throws std::exception with the reason.
Look ReadLook(const std::string& glb_file);
