#include "game.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace engine {
namespace {

LimberContextDef ContextOf(Jobs* jobs, Heap* memory) {
  LimberContextDef def = limberDefaultContextDef();
  def.tasks_user = jobs;
  def.run_tasks = [](void* user, LimberTask task, void* data, uint32_t count) {
    static_cast<Jobs*>(user)->Run(task, data, count);
  };
  def.memory_user = memory;
  def.allocate = [](void* user, size_t size, size_t alignment) {
    return static_cast<Heap*>(user)->Allocate(size, alignment);
  };
  def.free = [](void* user, void* piece, size_t size, size_t alignment) {
    static_cast<Heap*>(user)->Free(piece, size, alignment);
  };
  return def;
}

VkResult MakeBuffer(void* user, const VkBufferCreateInfo* info, VkMemoryPropertyFlags required,
                    VkMemoryPropertyFlags preferred, LimberVulkanBuffer* buffer) {
  BufferHeap::Piece piece;
  const VkResult result = static_cast<BufferHeap*>(user)->Make(*info, required, preferred, &piece);
  if (result == VK_SUCCESS) *buffer = {piece.buffer, piece.mapped, new BufferHeap::Piece(piece)};
  return result;
}

void FreeBuffer(void* user, const LimberVulkanBuffer* buffer) {
  const auto* piece = static_cast<const BufferHeap::Piece*>(buffer->allocation);
  static_cast<BufferHeap*>(user)->Free(*piece);
  delete piece;
}

// What a player's stick does: it is pushed, let go, and circles.
glm::vec2 Stick(double time) {
  const double beat = std::fmod(time, 1.6);
  if (beat < 0.4) return {0.8f, 0.3f};
  if (beat < 0.7) return {0, 0};
  const double angle = (beat - 0.7) / 0.9 * 6.2831853;
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

}  // namespace

Game::Game(const std::vector<Kind>& kinds, Jobs* jobs, Heap* memory, bool records)
    : jobs_(jobs),
      context_(ContextOf(jobs, memory)),
      records_(records) {
  for (const Kind& from : kinds) {
    Kind kind;
    kind.path = from.path;
    kind.colour = from.colour;
    kind.size = from.size;
    kind.is_flat = from.is_flat;
    kind.rig = context_.LoadRig(kind.path);
    kind.info = kind.rig.Info();
    for (int32_t h = 0; h < kind.info.num_handles; ++h) {
      const LimberHandleInfo handle = kind.rig.HandleInfo(h);
      if (handle.pinned != 0) kind.held.push_back(h);
      kind.lowest = std::min(kind.lowest, handle.rest_position[1]);
    }
    kinds_.push_back(std::move(kind));
    AddActors(kinds_.size() - 1, 12, static_cast<float>(kinds_.size()) - 2);
  }
}

void Game::AddActors(size_t kind, int count, float row) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  for (int i = 0; i < count; ++i) {
    def.record = records_ && actors_.empty() ? 1 : 0;
    Actor actor;
    actor.kind = kind;
    actor.instance = kinds_[kind].rig.MakeInstance(&def);
    actor.place = {1.35f * (static_cast<float>(i % 6) - 2.5f),
                   -kinds_[kind].size * kinds_[kind].lowest, -2.4f * row + (i < 6 ? 0.0f : -1.2f)};
    actor.phase = 0.13f * static_cast<float>(i + 5 * static_cast<int>(kind));
    actor.turn = kinds_[kind].is_flat ? 0 : 0.25f * static_cast<float>(i % 5 - 2);
    actor.first_vertex = static_cast<int32_t>(num_vertices_);
    num_vertices_ += kinds_[kind].info.num_vertices;
    ids_.push_back(actor.instance.id());
    actors_.push_back(std::move(actor));
  }
}

void Game::Attach(Device* device, BufferHeap* heap) {
  heap_ = heap;
  LimberVulkanDef def = limberDefaultVulkanDef();
  def.instance = device->instance;
  def.physical_device = device->physical;
  def.device = device->device;
  def.get_instance_proc_addr = vkGetInstanceProcAddr;
  def.create_buffer = MakeBuffer;
  def.destroy_buffer = FreeBuffer;
  def.buffer_user = heap;
  def.frames_in_flight = Renderer::kSlots;
  skinning_ = limber::api::Vulkan(context_, def);
  for (Kind& kind : kinds_) {
    skinning_.Prepare(kind.rig);
    const size_t bytes = size_t{kind.info.num_triangles} * 3 * sizeof(uint32_t);
    kind.indices = heap->MakeMapped(bytes, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    std::memcpy(kind.indices.mapped, kind.info.triangles, bytes);
  }
  for (BufferHeap::Piece& vertices : vertices_) {
    vertices =
        heap->MakeMapped(VkDeviceSize{num_vertices_} * sizeof(Vertex),
                         VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  }
}

void Game::Detach() {
  skinning_ = limber::api::Vulkan();
  for (const Kind& kind : kinds_)
    heap_->Free(kind.indices);
  for (const BufferHeap::Piece& vertices : vertices_)
    heap_->Free(vertices);
}

// One handle in two hangs on the stick's spring, the others sway.
void Game::MoveActor(Actor* actor, double time) {
  const Kind& kind = kinds_[actor->kind];
  LimberFollowDef follow = limberDefaultFollowDef();
  follow.time_step = kTimeStep;
  follow.damping = 0.5;
  const glm::vec2 stick = Stick(time + actor->phase);
  const float step = 0.09f * kind.info.diagonal;
  for (size_t i = 1; i < kind.held.size(); ++i) {
    const LimberHandleInfo handle = kind.rig.HandleInfo(kind.held[i]);
    const float* rest = handle.rest_position;
    const float side = i % 2 == 0 ? 1.0f : -0.6f;
    const float depth = kind.is_flat ? 0 : 0.5f * side * stick.x;
    actor->instance.Follow(
        kind.held[i],
        {rest[0] + step * side * stick.x, rest[1] + step * stick.y * side, rest[2] + step * depth},
        follow);
  }
}

void Game::Step() {
  const double time = static_cast<double>(frame_++) * kTimeStep;
  for (Actor& actor : actors_)
    MoveActor(&actor, time);
  context_.SolveMany(ids_);
}

void Game::RecordSkins(VkCommandBuffer commands, uint32_t slot) {
  skins_.clear();
  for (const Actor& actor : actors_) {
    constexpr uint32_t kStride = sizeof(Vertex);
    const VkDeviceSize at = VkDeviceSize{kStride} * static_cast<uint32_t>(actor.first_vertex);
    const VkBuffer buffer = vertices_[slot].buffer;
    LimberVulkanSkinDef skin = limberDefaultVulkanSkinDef();
    skin.instance = actor.instance.id();
    skin.num_vertices = kinds_[actor.kind].info.num_vertices;
    skin.positions = {buffer, at + offsetof(Vertex, position), kStride};
    skin.normals = {buffer, at + offsetof(Vertex, normal), kStride};
    skin.last_positions = {buffer, at + offsetof(Vertex, last), kStride};
    skins_.push_back(skin);
  }
  LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
  frame.commands = commands;
  frame.slot = slot;
  skinning_.RecordSkins(frame, skins_);
}

// From the last to the first: flat ones stand at the back, and have no depth.
std::vector<DrawCall> Game::Draws(uint32_t slot) const {
  std::vector<DrawCall> draws;
  for (size_t i = actors_.size(); i-- > 0;) {
    const Actor& actor = actors_[i];
    const Kind& kind = kinds_[actor.kind];
    DrawCall draw;
    draw.vertices = vertices_[slot].buffer;
    draw.indices = kind.indices.buffer;
    draw.first_vertex = actor.first_vertex;
    draw.num_indices = 3 * kind.info.num_triangles;
    draw.place = {actor.place, kind.size};
    draw.colour = kind.colour;
    draw.turn = actor.turn;
    draw.is_flat = kind.is_flat;
    draws.push_back(draw);
  }
  return draws;
}

void Game::Reload(size_t kind, limber::api::Rig rig) {
  for (Actor& actor : actors_) {
    if (actor.kind == kind) actor.instance.SwitchRig(rig.id());
  }
  skinning_.Prepare(rig);
  kinds_[kind].rig = std::move(rig);
  kinds_[kind].info = kinds_[kind].rig.Info();
}

const Vertex* Game::Vertices(uint32_t slot, const Actor& actor) const {
  return static_cast<const Vertex*>(vertices_[slot].mapped) + actor.first_vertex;
}

}  // namespace engine
