#include "engine.h"

#include <OgreRectangle2D.h>

#include <algorithm>

namespace {

constexpr float kFieldOfView = 0.5f;  // radians, from bottom to top: a portrait lens
constexpr unsigned kSamples = 4;      // a pixel
const Ogre::Vector3 kCameraFrom(0.52f, 0.2f, 1.0f);
const Ogre::Vector3 kKeyFrom(-0.5f, 1.4f, 0.9f);
const Ogre::Vector3 kRimFrom(0.9f, 0.7f, -1.0f);

Ogre::SceneNode* NodeOf(Ogre::SceneManager* scene, Ogre::MovableObject* object) {
  Ogre::SceneNode* node = scene->getRootSceneNode()->createChildSceneNode();
  node->attachObject(object);
  return node;
}

void LookFrom(Ogre::MovableObject* object, const Ogre::Vector3& from, const Ogre::Vector3& at) {
  object->getParentSceneNode()->setPosition(from);
  object->getParentSceneNode()->lookAt(at, Ogre::Node::TS_WORLD);
}

}  // namespace

Engine::Engine(const std::string& log_file, uint32_t width, uint32_t height) {
  log_ = std::make_unique<Ogre::LogManager>();
  log_->createLog(log_file, true, false);
  root_ = std::make_unique<Ogre::Root>("", "", "");
  OpenRenderer();
  scene_ = root_->createSceneManager();
  camera_ = scene_->createCamera("camera");
  NodeOf(scene_, camera_);
  MakeTarget(width, height);
  MakeLights();
  MakeStudio();
}

void Engine::OpenRenderer() {
  root_->loadPlugin(HOST_PLUGINS "/RenderSystem_GL3Plus");
  root_->loadPlugin(HOST_PLUGINS "/Codec_STBI");
  root_->setRenderSystem(root_->getAvailableRenderers().at(0));
  root_->initialise(false);
  // OGRE has its context from a window; the pictures are drawn into a texture.
  const Ogre::NameValuePairList hidden = {{"hidden", "true"}};
  root_->createRenderWindow("ogre_host", 64, 64, false, &hidden);
  auto& resources = Ogre::ResourceGroupManager::getSingleton();
  resources.addResourceLocation(HOST_MEDIA, "FileSystem");
  // OGRE asks for its shadow volumes' programs even where shadows are textures.
  resources.addResourceLocation(HOST_OGRE_MEDIA "/ShadowVolume", "FileSystem");
  resources.initialiseAllResourceGroups();
}

void Engine::MakeTarget(uint32_t width, uint32_t height) {
  target_ = Ogre::TextureManager::getSingleton().createManual(
      "picture", Ogre::RGN_DEFAULT, Ogre::TEX_TYPE_2D, width, height, 0, Ogre::PF_BYTE_RGB,
      Ogre::TU_RENDERTARGET, nullptr, false, kSamples);
  Ogre::RenderTexture* texture = target_->getBuffer()->getRenderTarget();
  texture->setAutoUpdated(false);
  texture->addViewport(camera_);
  camera_->setAspectRatio(static_cast<float>(width) / static_cast<float>(height));
  camera_->setFOVy(Ogre::Radian(kFieldOfView));
}

void Engine::MakeLights() {
  scene_->setShadowTechnique(Ogre::SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED);
  scene_->setShadowTextureSelfShadow(true);
  scene_->setShadowTextureSettings(1024, 1, Ogre::PF_FLOAT32_R);
  scene_->setShadowTextureCasterMaterial(
      Ogre::MaterialManager::getSingleton().getByName("Host/Caster"));
  key_ = scene_->createLight();
  key_->setType(Ogre::Light::LT_SPOTLIGHT);
  key_->setDiffuseColour(1.0f, 0.93f, 0.82f);
  NodeOf(scene_, key_);
  rim_ = scene_->createLight();
  rim_->setType(Ogre::Light::LT_DIRECTIONAL);
  rim_->setDiffuseColour(0.62f, 0.74f, 1.0f);
  rim_->setCastShadows(false);
  NodeOf(scene_, rim_);
}

void Engine::MakeStudio() {
  const Ogre::MeshPtr plane = Ogre::MeshManager::getSingleton().createPlane(
      "ground", Ogre::RGN_DEFAULT, Ogre::Plane(Ogre::Vector3::UNIT_Y, 0), 2, 2, 1, 1, true, 1, 1, 1,
      Ogre::Vector3::UNIT_Z);
  Ogre::Entity* ground = scene_->createEntity(plane);
  ground->setMaterialName("Host/Ground");
  ground->setCastShadows(false);
  ground->setRenderQueueGroup(Ogre::RENDER_QUEUE_2);  // characters may stand before it unsorted
  ground_ = NodeOf(scene_, ground);

  auto* backdrop = OGRE_NEW Ogre::Rectangle2D(true);
  backdrop->setCorners(-1, 1, 1, -1);
  backdrop->setMaterial(Ogre::MaterialManager::getSingleton().getByName("Host/Backdrop"));
  backdrop->setRenderQueueGroup(Ogre::RENDER_QUEUE_BACKGROUND);
  backdrop->setBoundingBox(Ogre::AxisAlignedBox::BOX_INFINITE);
  backdrop->setCastShadows(false);
  NodeOf(scene_, backdrop);
}

// Looks at the middle of the points, from the nearest place that has all of them in the picture.
void Engine::AimCamera(const std::vector<Ogre::Vector3>& points, float margin) {
  const Ogre::Vector3 from = kCameraFrom.normalisedCopy();
  const Ogre::Vector3 x_axis = Ogre::Vector3::UNIT_Y.crossProduct(from).normalisedCopy();
  Ogre::Matrix3 axes;
  axes.FromAxes(x_axis, from.crossProduct(x_axis), from);
  Ogre::AxisAlignedBox box;
  for (const Ogre::Vector3& point : points)
    box.merge(axes.transpose() * point);
  const Ogre::Vector3 middle = axes * box.getCenter();
  const float high = Ogre::Math::Tan(Ogre::Radian(kFieldOfView / 2));
  const float wide = high * camera_->getAspectRatio();
  float distance = 0;
  for (const Ogre::Vector3& point : points) {
    const Ogre::Vector3 place = axes.transpose() * (point - middle);
    distance = std::max({distance, place.z + (std::abs(place.x) + margin) / wide,
                         place.z + (std::abs(place.y) + margin) / high});
  }
  LookFrom(camera_, middle + distance * from, middle);
  camera_->setNearClipDistance(distance / 20);
  camera_->setFarClipDistance(distance * 10);
}

void Engine::Frame(const std::vector<Ogre::Vector3>& points, float margin, float floor) {
  Ogre::AxisAlignedBox box;
  std::vector<Ogre::Vector3> with_shadows = points;
  for (const Ogre::Vector3& point : points) {
    box.merge(point);
    with_shadows.push_back(point - (point.y - floor) / kKeyFrom.y * kKeyFrom);
  }
  AimCamera(with_shadows, margin);
  const Ogre::Vector3 centre = box.getCenter();
  const float radius = box.getHalfSize().length() + margin, distance = 4 * radius;
  LookFrom(key_, centre + distance * kKeyFrom.normalisedCopy(), centre);
  const Ogre::Radian cone(2.2f * Ogre::Math::ASin(1.1f * radius / distance).valueRadians());
  key_->setSpotlightRange(cone, cone);
  key_->setAttenuation(100 * radius, 1, 0, 0);
  key_->setShadowNearClipDistance(distance - 1.5f * radius);
  key_->setShadowFarClipDistance(distance + 2.5f * radius);
  LookFrom(rim_, centre + distance * kRimFrom.normalisedCopy(), centre);
  ground_->setPosition(centre.x, floor, centre.z);
  ground_->setScale(Ogre::Vector3(6 * radius));
}

void Engine::Draw() {
  root_->_fireFrameStarted();
  target_->getBuffer()->getRenderTarget()->update();
  root_->_fireFrameEnded();
}

Ogre::Image Engine::Picture() const {
  Ogre::Image picture;
  target_->convertToImage(picture);
  return picture;
}
