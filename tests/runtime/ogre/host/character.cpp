#include "character.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace {

constexpr size_t kFloatsElsewhere = 11;  // any layout but MovingVertex's

Ogre::Vector3 VectorOf(const float xyz[3]) {
  return {xyz[0], xyz[1], xyz[2]};
}

// Clones the material of media/host.material for one part of one character.
Ogre::MaterialPtr MakeMaterial(const std::string& name, const Ogre::TexturePtr& colours,
                               float roughness, bool flat) {
  Ogre::MaterialPtr material =
      Ogre::MaterialManager::getSingleton().getByName("Host/Character")->clone(name);
  Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
  pass->getTextureUnitState("colours")->setTexture(colours);
  pass->getFragmentProgramParameters()->setNamedConstant("roughness", roughness);
  if (flat) {  // seen from both sides, and what lies in one plane is painted in its order
    pass->setCullingMode(Ogre::CULL_NONE);
    pass->setDepthWriteEnabled(false);
    pass->setAlphaToCoverageEnabled(true);
  }
  return material;
}

}  // namespace

void Check(LimberResult result, const LimberContext* context) {
  if (result == LIMBER_SUCCESS) return;
  std::string message(limberGetLastMessage(context, nullptr, 0), '\0');
  limberGetLastMessage(context, message.data(), message.size() + 1);
  throw std::runtime_error(std::string(limberResultString(result)) + ": " + message);
}

Character::Character(LimberContext* context, const std::string& baked_file,
                     Ogre::SceneManager* scene)
    : context_(context) {
  Check(limberLoadRig(context_, baked_file.c_str(), nullptr, &rig_), context_);
  Check(limberGetRigInfo(context_, rig_, &info_), context_);
  Check(limberCreateInstance(context_, rig_, nullptr, &instance_), context_);
  MeasureRest();
  mesh_ = Ogre::MeshManager::getSingleton().createManual(baked_file, Ogre::RGN_DEFAULT);
  MakeVertices(mesh_.get());
  MakeParts(ReadLook(baked_file), mesh_.get());
  mesh_->_setBounds(rest_box_, false);
  mesh_->_setBoundingSphereRadius(rest_box_.getSize().length());
  mesh_->load();
  entity_ = scene->createEntity(mesh_);
  scene->getRootSceneNode()->createChildSceneNode()->attachObject(entity_);
  Step();
}

Character::~Character() {
  limberDestroyInstance(context_, instance_);
  limberDestroyRig(context_, rig_);
}

void Character::MakeVertices(Ogre::Mesh* mesh) {
  auto& buffers = Ogre::HardwareBufferManager::getSingleton();
  mesh->sharedVertexData = OGRE_NEW Ogre::VertexData();
  mesh->sharedVertexData->vertexCount = info_.num_vertices;
  Ogre::VertexDeclaration* layout = mesh->sharedVertexData->vertexDeclaration;
  layout->addElement(0, offsetof(MovingVertex, position), Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  layout->addElement(0, offsetof(MovingVertex, normal), Ogre::VET_FLOAT3, Ogre::VES_NORMAL);
  layout->addElement(1, 0, Ogre::VET_FLOAT2, Ogre::VES_TEXTURE_COORDINATES);
  moving_ =
      buffers.createVertexBuffer(sizeof(MovingVertex), info_.num_vertices,
                                 Ogre::HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE, false);
  const auto fixed = buffers.createVertexBuffer(2 * sizeof(float), info_.num_vertices,
                                                Ogre::HardwareBuffer::HBU_STATIC_WRITE_ONLY);
  if (info_.texcoords == nullptr) throw std::runtime_error("no texture coordinates");
  fixed->writeData(0, fixed->getSizeInBytes(), info_.texcoords);
  mesh->sharedVertexData->vertexBufferBinding->setBinding(0, moving_);
  mesh->sharedVertexData->vertexBufferBinding->setBinding(1, fixed);
}

void Character::MakeParts(const Look& look, Ogre::Mesh* mesh) {
  const auto indices = Ogre::HardwareBufferManager::getSingleton().createIndexBuffer(
      Ogre::HardwareIndexBuffer::IT_32BIT, size_t{3} * info_.num_triangles,
      Ogre::HardwareBuffer::HBU_STATIC_WRITE_ONLY);
  indices->writeData(0, indices->getSizeInBytes(), info_.triangles);
  const Ogre::TexturePtr colours = Ogre::TextureManager::getSingleton().loadImage(
      mesh->getName() + " colours", Ogre::RGN_DEFAULT, look.colours);
  int32_t num_parts = 0;
  Check(limberGetNumPrimitives(context_, rig_, &num_parts), context_);
  for (int32_t i = 0; i < num_parts; ++i) {
    LimberPrimitiveInfo part;
    Check(limberGetPrimitiveInfo(context_, rig_, i, &part), context_);
    Ogre::SubMesh* submesh = mesh->createSubMesh();
    submesh->useSharedVertices = true;
    submesh->indexData->indexBuffer = indices;
    submesh->indexData->indexStart = size_t{3} * part.first_triangle;
    submesh->indexData->indexCount = size_t{3} * part.num_triangles;
    const float roughness = look.roughness.at(static_cast<size_t>(part.gltf_material));
    const std::string name = mesh->getName() + " " + std::to_string(i);
    submesh->setMaterialName(
        MakeMaterial(name, colours, roughness, info_.dimension == 2)->getName());
  }
}

void Character::SetTarget(const std::string& handle, const Ogre::Vector3& position) {
  int32_t number = 0;
  Check(limberFindHandle(context_, rig_, handle.c_str(), &number), context_);
  Check(limberSetTarget(context_, instance_, number, position.ptr()), context_);
}

void Character::Step() {
  // A script at thirty frames a second moves fast: with one alternation the pose lags, and creases.
  LimberSolveDef solve = limberDefaultSolveDef();
  solve.iterations = 8;
  solve.settle_tolerance = 1e-3;
  Check(limberSolve(context_, instance_, &solve, nullptr), context_);
  float bounds[6];
  {
    const Ogre::HardwareBufferLockGuard lock(moving_, Ogre::HardwareBuffer::HBL_DISCARD);
    auto* vertices = static_cast<MovingVertex*>(lock.pData);
    LimberSkinDef skin = limberDefaultSkinDef();
    skin.num_vertices = info_.num_vertices;
    skin.positions = {vertices->position, sizeof(MovingVertex)};
    skin.normals = {vertices->normal, sizeof(MovingVertex)};
    skin.bounds = bounds;
    Check(limberSkin(context_, instance_, &skin), context_);
  }
  SetBounds(bounds);
}

std::vector<LimberHandleState> Character::Handles() const {
  std::vector<LimberHandleState> handles(static_cast<size_t>(info_.num_handles));
  for (int32_t handle = 0; handle < info_.num_handles; ++handle) {
    Check(limberGetHandle(context_, instance_, handle, &handles[static_cast<size_t>(handle)]),
          context_);
  }
  return handles;
}

// What the engine culls by.
void Character::SetBounds(const float bounds[6]) {
  mesh_->_setBounds({VectorOf(bounds), VectorOf(bounds + 3)}, false);
  entity_->getParentSceneNode()->needUpdate();
}

void Character::MeasureRest() {
  for (const MovingVertex& vertex : SkinElsewhere())
    rest_box_.merge(VectorOf(vertex.position));
  Ogre::AxisAlignedBox handles;
  for (const LimberHandleState& handle : Handles())
    handles.merge(VectorOf(handle.position));
  for (int axis = 0; axis < 3; ++axis) {
    reach_ = std::max({reach_, handles.getMinimum()[axis] - rest_box_.getMinimum()[axis],
                       rest_box_.getMaximum()[axis] - handles.getMaximum()[axis]});
  }
}

std::vector<MovingVertex> Character::SkinElsewhere() const {
  std::vector<float> plain(kFloatsElsewhere * info_.num_vertices);
  LimberSkinDef skin = limberDefaultSkinDef();
  skin.num_vertices = info_.num_vertices;
  skin.positions = {&plain[1], kFloatsElsewhere * sizeof(float)};
  skin.normals = {&plain[6], kFloatsElsewhere * sizeof(float)};
  Check(limberSkin(context_, instance_, &skin), context_);
  std::vector<MovingVertex> vertices(info_.num_vertices);
  for (size_t v = 0; v < vertices.size(); ++v) {
    std::copy_n(&plain[v * kFloatsElsewhere + 1], 3, vertices[v].position);
    std::copy_n(&plain[v * kFloatsElsewhere + 6], 3, vertices[v].normal);
  }
  return vertices;
}

std::vector<MovingVertex> Character::ReadBack() const {
  std::vector<MovingVertex> vertices(info_.num_vertices);
  moving_->readData(0, vertices.size() * sizeof(MovingVertex), vertices.data());
  return vertices;
}
