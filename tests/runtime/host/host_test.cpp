// A game that links liblimber and nothing else of Limber's: its own device, jobs and allocator.
#include "bake/bake.h"
#include "bake/write_baked.h"
#include "game.h"
#include "import/import_gltf.h"
#include "runtime/skin_vulkan/test_device.h"
#include "support/counting_allocator.h"
#include "support/temporary_folder.h"
#include "viewer/image.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace engine {
namespace {

namespace fs = std::filesystem;

const fs::path kTop = LIMBER_SOURCE_DIR;

// A shipped character, baked.
void Bake(const std::string& name, const fs::path& to) {
  const fs::path source = kTop / "content/characters" / (name + ".glb");
  const auto raw = limber::bake::ImportGltf(source);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const auto made = limber::bake::Bake(*raw, raw->marked_handles, {}, nullptr);
  ASSERT_TRUE(made.ok()) << made.status().message();
  ASSERT_TRUE(limber::bake::WriteBaked(source, *raw, *made, to).ok());
}

// Once a program.
std::string Baked(const std::string& name) {
  static const limber::test::TemporaryFolder folder;
  const fs::path to = folder.path() / (name + ".glb");
  if (!fs::exists(to)) Bake(name, to);
  return to.string();
}

std::vector<Kind> Kinds() {
  std::vector<Kind> kinds(3);
  kinds[0].path = (kTop / "content/baked/v2/tube.glb").string();
  kinds[0].colour = {0.6f, 0.16f, 0.2f};
  kinds[0].size = 0.4f;
  kinds[1].path = Baked("dragonlet");
  kinds[1].colour = {0.16f, 0.5f, 0.24f};
  kinds[1].size = 0.62f;
  kinds[2].path = Baked("fox");
  kinds[2].colour = {0.85f, 0.45f, 0.1f};
  kinds[2].size = 0.7f;
  kinds[2].is_flat = true;
  return kinds;
}

glm::mat4 Camera() {
  glm::mat4 clip = glm::perspective(glm::radians(38.0f), 960.0f / 540.0f, 0.1f, 50.0f);
  clip[1][1] *= -1;  // Vulkan's y
  return clip * glm::lookAt(glm::vec3(0, 4.6f, 8.4f), glm::vec3(0, 0.35f, -0.8f), {0, 1, 0});
}

// How much of a picture is not background.
double Covered(const uint8_t* rgba) {
  size_t covered = 0;
  constexpr size_t kPixels = size_t{Renderer::kWidth} * Renderer::kHeight;
  for (size_t i = 0; i < kPixels; ++i)
    covered += std::memcmp(rgba + 4 * i, rgba, 3) != 0 ? 1 : 0;  // the first pixel is sky
  return static_cast<double>(covered) / kPixels;
}

void WritePicture(const uint8_t* rgba, const std::string& name) {
  limber::viewer::Image image;
  image.width = Renderer::kWidth;
  image.height = Renderer::kHeight;
  image.rgba.assign(rgba, rgba + size_t{4} * image.width * image.height);
  const fs::path folder = fs::path(LIMBER_BINARY_DIR) / "pictures";
  fs::create_directories(folder);
  EXPECT_TRUE(limber::viewer::WritePng(folder / name, image).ok());
}

// Every character's blend weights, bit for bit.
std::vector<double> AllBlends(const Game& game) {
  std::vector<double> all;
  for (const Actor& actor : game.actors()) {
    const LimberRigInfo& info = game.kinds()[actor.kind].info;
    std::vector<double> weights(static_cast<size_t>(info.num_groups * info.num_shapes));
    limber::api::Check(limberGetBlendWeights(const_cast<Game&>(game).context().get(),
                                             actor.instance.id(), weights.data(), weights.size()),
                       nullptr);
    all.insert(all.end(), weights.begin(), weights.end());
  }
  return all;
}

// The device's vertices of an actor are those of the CPU path. (Two of the dragonlet's examples are
// all but halves of each other: what is large in their transforms cancels, and leaves 2e-5 of the
// size, which turns a normal here and there by some thousandths.)
void ExpectSkinned(Game* game, uint32_t slot, const Actor& actor) {
  const LimberRigInfo& info = game->kinds()[actor.kind].info;
  std::vector<Vertex> cpu(info.num_vertices);
  LimberSkinDef def = limberDefaultSkinDef();
  def.num_vertices = info.num_vertices;
  def.positions = {cpu[0].position, sizeof(Vertex)};
  def.normals = {cpu[0].normal, sizeof(Vertex)};
  ASSERT_EQ(limberSkin(game->context().get(), actor.instance.id(), &def), LIMBER_SUCCESS);
  const Vertex* gpu = game->Vertices(slot, actor);
  double squares = 0;
  for (uint32_t v = 0; v < info.num_vertices; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(gpu[v].position[axis], cpu[v].position[axis], 5e-5 * info.diagonal) << v;
      ASSERT_NEAR(gpu[v].normal[axis], cpu[v].normal[axis], 0.03) << v;
      squares += std::pow(gpu[v].normal[axis] - cpu[v].normal[axis], 2);
    }
  }
  EXPECT_LT(std::sqrt(squares / info.num_vertices), 1e-3);
}

class Host : public ::testing::Test {
 protected:
  // A device with all that stands on it.
  struct Screen {
    std::unique_ptr<Device> device;
    std::unique_ptr<BufferHeap> heap;
    std::unique_ptr<Renderer> renderer;

    ~Screen() {
      renderer = nullptr;
      if (heap != nullptr) {
        EXPECT_EQ(heap->num_live(), 0);
      }
      heap = nullptr;
      if (device == nullptr) return;
      for (const std::string& complaint : device->complaints)
        ADD_FAILURE() << complaint;
    }
  };

  void TearDown() override { EXPECT_EQ(memory_.num_live(), 0) << "of the engine's memory"; }

  void SetUp() override {
    std::string reason = limber::test::PrepareVulkan();
    if (reason.empty()) screen_ = MakeScreen(&reason);
    if (screen_ == nullptr) GTEST_SKIP() << "no Vulkan device: " << reason;
  }

  static std::unique_ptr<Screen> MakeScreen(std::string* reason) {
    auto screen = std::make_unique<Screen>();
    screen->device = Device::Create(reason);
    if (screen->device == nullptr) return nullptr;
    screen->heap = std::make_unique<BufferHeap>(*screen->device);
    screen->renderer = std::make_unique<Renderer>(screen->device.get(), screen->heap.get());
    return screen;
  }

  // Frames `first` to `end` - 1; two are in flight.
  void Play(Game* game, uint32_t first, uint32_t end) {
    for (uint32_t frame = first; frame < end; ++frame) {
      game->Step();
      const uint32_t slot = frame % Renderer::kSlots;
      screen_->renderer->Frame(
          slot, Camera(), 60, [&](VkCommandBuffer commands) { game->RecordSkins(commands, slot); },
          game->Draws(slot));
    }
  }

  Heap memory_{size_t{128} << 20};  // what the game has for its characters
  std::unique_ptr<Screen> screen_;
};

TEST_F(Host, DozensOfCharacters_AreSolvedSkinnedAndDrawn) {
  Jobs jobs(2);
  Game game(Kinds(), &jobs, &memory_, false);
  ASSERT_EQ(game.actors().size(), 36u);
  game.Attach(screen_->device.get(), screen_->heap.get());
  std::vector<std::vector<uint8_t>> pictures;
  int num_buffers = 0;
  for (const uint32_t until : {3u, 20u, 37u, 56u}) {
    static uint32_t from = 0;
    Play(&game, from, until);
    from = until;
    const uint32_t slot = (until - 1) % Renderer::kSlots;
    const uint8_t* picture = screen_->renderer->Picture(slot);
    for (const Actor& actor : game.actors())
      ExpectSkinned(&game, slot, actor);
    EXPECT_GT(Covered(picture), 0.2) << "frame " << until;
    EXPECT_LT(Covered(picture), 0.8) << "frame " << until;
    WritePicture(picture, "host_" + std::to_string(until) + ".png");
    pictures.emplace_back(picture, picture + size_t{4} * Renderer::kWidth * Renderer::kHeight);
    if (until == 3) num_buffers = screen_->heap->num_made();
  }
  EXPECT_EQ(screen_->heap->num_made(), num_buffers) << "steady frames ask for buffers";
  std::printf("36 characters of %zu kinds: at most %.1f MB\n", game.kinds().size(),
              1e-6 * static_cast<double>(memory_.most_used()));
  EXPECT_NE(pictures[1], pictures[2]);
  EXPECT_NE(pictures[2], pictures[3]);
  EXPECT_GT(jobs.num_stolen(), 0) << "the engine's workers had nothing to do";
  screen_->renderer->WaitAll();
  game.Detach();
}

TEST_F(Host, AnyNumberOfWorkers_GivesTheSameBits) {
  std::vector<std::vector<double>> results;
  for (const int workers : {1, 2, 4}) {
    Jobs jobs(workers);
    Game game(Kinds(), &jobs, &memory_, false);
    for (int frame = 0; frame < 40; ++frame)
      game.Step();
    results.push_back(AllBlends(game));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST_F(Host, SteadySteps_AllocateNothing) {
  Jobs jobs(1);
  Game game(Kinds(), &jobs, &memory_, false);
  for (int frame = 0; frame < 10; ++frame)
    game.Step();
  const int64_t before = limber::test::AllocationCount();
  const int pieces_before = memory_.num_made();
  for (int frame = 0; frame < 60; ++frame)
    game.Step();
  EXPECT_EQ(limber::test::AllocationCount(), before);
  EXPECT_EQ(memory_.num_made(), pieces_before);
}

// The game goes on where it was, on the next device, with a kind that was baked again meanwhile.
TEST_F(Host, DeviceLossAndHotReload_DoNotEndTheGame) {
  Jobs jobs(2);
  Game game(Kinds(), &jobs, &memory_, false);
  game.Attach(screen_->device.get(), screen_->heap.get());
  Play(&game, 0, 6);
  const std::vector<double> before = AllBlends(game);
  screen_->renderer->WaitAll();  // a lost device does nothing more, either
  game.Detach();
  std::string reason;
  screen_ = nullptr;
  screen_ = MakeScreen(&reason);
  ASSERT_NE(screen_, nullptr) << reason;
  EXPECT_EQ(AllBlends(game), before) << "poses are the host's memory's";
  game.Attach(screen_->device.get(), screen_->heap.get());
  Play(&game, 0, 4);
  limber::api::Rig baked_again;
  std::thread loader([&] { baked_again = game.context().LoadRig(game.kinds()[2].path); });
  Play(&game, 4, 8);
  loader.join();
  game.Reload(2, std::move(baked_again));
  Play(&game, 8, 12);
  screen_->renderer->WaitAll();
  for (const Actor& actor : game.actors())
    ExpectSkinned(&game, 1, actor);
  game.Detach();
}

TEST_F(Host, RecordingOfAnActor_ReplaysBitForBit) {
  Jobs jobs(2);
  Game game(Kinds(), &jobs, &memory_, true);
  for (int frame = 0; frame < 50; ++frame)
    game.Step();
  const Actor& actor = game.actors()[0];
  const std::vector<unsigned char> recording = actor.instance.Recording();
  LimberReplayDef def = limberDefaultReplayDef();
  def.bytes = recording.data();
  def.num_bytes = recording.size();
  LimberReplayReport report = {};
  ASSERT_EQ(limberReplay(game.context().get(), game.kinds()[actor.kind].rig.id(), &def, &report),
            LIMBER_SUCCESS);
  EXPECT_EQ(report.num_frames, 50u);
  EXPECT_EQ(report.num_different, 0u);
}

}  // namespace
}  // namespace engine
