// Drags a Limber character inside OGRE and looks at what comes out:
//   ogre_host BAKED.glb DRAG.json PICTURES_FOLDER
// Exit code 0 if all is well; else the reasons are on stderr.
#include "character.h"
#include "checks.h"
#include "engine.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace {

constexpr uint32_t kWidth = 800, kHeight = 600;
constexpr size_t kNumFrames = 60, kFramesAPicture = 6;

using Frames = nlohmann::json;  // [{"targets": {"hand": [x, y, z], ...}}, ...]

Ogre::Vector3 VectorOf(const nlohmann::json& xyz) {
  return {xyz.at(0).get<float>(), xyz.at(1).get<float>(), xyz.at(2).get<float>()};
}

// kNumFrames of the script, from its first to its last.
Frames ReadFrames(const std::string& file) {
  std::ifstream in(file);
  const Frames all = nlohmann::json::parse(in).at("frames");
  Frames chosen = Frames::array();
  for (size_t i = 0; i < kNumFrames; ++i)
    chosen.push_back(all.at(i * (all.size() - 1) / (kNumFrames - 1)));
  return chosen;
}

// All places that the drag asks for.
std::vector<Ogre::Vector3> Stage(const Frames& frames) {
  std::vector<Ogre::Vector3> points;
  for (const auto& frame : frames) {
    for (const auto& target : frame.at("targets"))
      points.push_back(VectorOf(target));
  }
  return points;
}

// Each material's part of the character by itself: is it there?
void LookAtParts(Engine* engine, const Ogre::Entity& entity, const Ogre::Image& whole,
                 Checks* checks) {
  for (Ogre::SubEntity* part : entity.getSubEntities()) {
    part->setVisible(false);
    engine->Draw();
    checks->LookAtPart(whole, engine->Picture());
    part->setVisible(true);
  }
}

std::string PictureName(const std::string& folder, size_t number) {
  char name[32];
  std::snprintf(name, sizeof name, "/frame_%02zu.png", number);
  return folder + name;
}

int Run(LimberContext* context, const std::string& baked, const Frames& frames,
        const std::string& folder) {
  Engine engine(folder + "/ogre.log", kWidth, kHeight);
  Character character(context, baked, engine.scene());
  engine.Frame(Stage(frames), character.reach(), character.rest_box().getMinimum().y);
  character.entity()->setVisible(false);
  engine.Draw();
  const Ogre::Image empty = engine.Picture();
  character.entity()->setVisible(true);
  engine.Draw();
  const Ogre::Image rest = engine.Picture();

  Checks checks(character, character.ReadBack());
  LookAtParts(&engine, *character.entity(), rest, &checks);
  double most_change = 0;
  Ogre::Image most_dragged = rest;
  size_t num_pictures = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    for (const auto& [handle, target] : frames[i].at("targets").items())
      character.SetTarget(handle, VectorOf(target));
    character.Step();
    engine.Draw();
    checks.LookAtFrame(static_cast<int>(i));
    if (i % kFramesAPicture != 0) continue;
    Ogre::Image picture = engine.Picture();
    checks.LookAtPicture(static_cast<int>(i), picture, empty);
    picture.save(PictureName(folder, num_pictures++));
    const double change = PartThatDiffers(rest, picture);
    if (change < most_change) continue;
    most_change = change;
    most_dragged = picture;
  }
  checks.LookAtChange(rest, most_dragged);
  std::printf(
      "%zu frames, %zu pictures; dragged by %.2f, missed by %.5f of the diagonal; "
      "%.0f %% of the picture changed\n",
      frames.size(), num_pictures, static_cast<double>(checks.farthest()),
      static_cast<double>(checks.worst_miss()), 100 * most_change);
  return checks.num_failures() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "Usage: ogre_host BAKED.glb DRAG.json PICTURES_FOLDER\n");
    return 2;
  }
  try {
    const LimberContextDef def = limberDefaultContextDef();
    LimberContext* made = nullptr;
    Check(limberCreateContext(&def, &made), nullptr);
    const std::unique_ptr<LimberContext, void (*)(LimberContext*)> context(made,
                                                                           limberDestroyContext);
    return Run(context.get(), argv[1], ReadFrames(argv[2]), argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
