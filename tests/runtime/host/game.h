// A game of dozens of characters that dance to a scripted gamepad, at a fixed time step.
#pragma once

#include "engine_heap.h"
#include "engine_jobs.h"
#include "engine_memory.h"
#include "engine_renderer.h"

#include <limber/limber.hpp>
#include <limber/limber_vulkan.hpp>

#include <memory>
#include <string>
#include <vector>

namespace engine {

// A kind of character: its rig, and what the renderer needs of it.
struct Kind {
  std::string path;
  glm::vec3 colour;
  float size = 1;  // of a mesh unit in the world
  bool is_flat = false;
  limber::api::Rig rig;
  LimberRigInfo info = {};
  std::vector<int32_t> held;  // handles that input moves
  float lowest = 0;           // of their rest positions: where the ground is, more or less
  BufferHeap::Piece indices;
};

struct Actor {
  size_t kind = 0;
  limber::api::Instance instance;
  glm::vec3 place = {0, 0, 0};
  float turn = 0, phase = 0;
  int32_t first_vertex = 0;
};

class Game {
 public:
  static constexpr double kTimeStep = 1.0 / 60;

  // `jobs` and `memory` must outlive the game. records: whether the first actor's input is
  // recorded.
  Game(const std::vector<Kind>& kinds, Jobs* jobs, Heap* memory, bool records);

  // Puts the game on a device, again after another was lost; takes it off.
  void Attach(Device* device, BufferHeap* heap);
  void Detach();

  // One fixed step: input, solve.
  void Step();
  // Records the skins into the slot's part of the vertex buffer.
  void RecordSkins(VkCommandBuffer commands, uint32_t slot);
  std::vector<DrawCall> Draws(uint32_t slot) const;

  // A kind's file was baked again: its actors go on with it.
  void Reload(size_t kind, limber::api::Rig rig);

  limber::api::Context& context() { return context_; }

  const std::vector<Actor>& actors() const { return actors_; }

  const std::vector<Kind>& kinds() const { return kinds_; }

  // The slot's vertices of an actor, as the device left them.
  const Vertex* Vertices(uint32_t slot, const Actor& actor) const;

 private:
  void AddActors(size_t kind, int count, float row);
  void MoveActor(Actor* actor, double time);

  Jobs* jobs_;
  BufferHeap* heap_ = nullptr;
  limber::api::Context context_;
  std::vector<Kind> kinds_;
  std::vector<Actor> actors_;
  std::vector<LimberInstanceId> ids_;
  limber::api::Vulkan skinning_;
  std::vector<LimberVulkanSkinDef> skins_;
  BufferHeap::Piece vertices_[Renderer::kSlots];
  uint32_t num_vertices_ = 0;
  uint64_t frame_ = 0;
  bool records_;
};

}  // namespace engine
