// OGRE without a window on the screen: a small studio with two lights, pictures as images.
#pragma once

#include <Ogre.h>

#include <memory>
#include <string>
#include <vector>

class Engine {
 public:
  // `log_file` is OGRE's own. Throws Ogre::Exception.
  Engine(const std::string& log_file, uint32_t width, uint32_t height);

  Ogre::SceneManager* scene() const { return scene_; }

  // Points camera and lights at `points`, all of them and their shadows in the picture and `margin`
  // around them, and lays the ground at the height `floor`.
  void Frame(const std::vector<Ogre::Vector3>& points, float margin, float floor);
  // Draws the scene as it is now.
  void Draw();
  // What was drawn last.
  Ogre::Image Picture() const;

 private:
  void OpenRenderer();
  void MakeTarget(uint32_t width, uint32_t height);
  void MakeLights();
  void MakeStudio();
  void AimCamera(const std::vector<Ogre::Vector3>& points, float margin);

  std::unique_ptr<Ogre::LogManager> log_;
  std::unique_ptr<Ogre::Root> root_;
  Ogre::SceneManager* scene_ = nullptr;
  Ogre::Camera* camera_ = nullptr;
  Ogre::Light* key_ = nullptr;
  Ogre::Light* rim_ = nullptr;
  Ogre::SceneNode* ground_ = nullptr;
  Ogre::TexturePtr target_;
};
