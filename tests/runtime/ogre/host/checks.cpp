#include "checks.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace {

constexpr float kAtTarget = 2e-3f;  // of the diagonal: where a held handle's vertex is
constexpr float kAround = 0.03f;    // of the diagonal: what counts as a handle's surroundings
constexpr float kStretched = 2.5f;  // how much wider these may have become
constexpr int kSeen = 24;           // of 255 in any channel: a pixel that differs
constexpr double kLeastCover = 0.08, kMostCover = 0.6;
constexpr double kLeastChange = 0.03, kLeastPart = 0.004;
constexpr float kLeastDrag = 0.1f;  // of the diagonal

Ogre::Vector3 VectorOf(const float xyz[3]) {
  return {xyz[0], xyz[1], xyz[2]};
}

std::string Number(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", number);
  return text;
}

bool Differs(const Ogre::Image& a, const Ogre::Image& b, size_t x, size_t y) {
  const Ogre::ColourValue one = a.getColourAt(x, y, 0), other = b.getColourAt(x, y, 0);
  const float most =
      std::max({std::abs(one.r - other.r), std::abs(one.g - other.g), std::abs(one.b - other.b)});
  return most * 255 > kSeen;
}

bool TouchesTheBorder(const Ogre::Image& picture, const Ogre::Image& empty) {
  const size_t width = picture.getWidth(), height = picture.getHeight();
  for (size_t x = 0; x < width; ++x) {
    if (Differs(picture, empty, x, 0) || Differs(picture, empty, x, height - 1)) return true;
  }
  for (size_t y = 0; y < height; ++y) {
    if (Differs(picture, empty, 0, y) || Differs(picture, empty, width - 1, y)) return true;
  }
  return false;
}

}  // namespace

double PartThatDiffers(const Ogre::Image& a, const Ogre::Image& b) {
  size_t count = 0;
  for (size_t y = 0; y < a.getHeight(); ++y) {
    for (size_t x = 0; x < a.getWidth(); ++x)
      count += Differs(a, b, x, y) ? 1 : 0;
  }
  return static_cast<double>(count) / static_cast<double>(a.getWidth() * a.getHeight());
}

Checks::Checks(const Character& character, std::vector<MovingVertex> rest)
    : character_(character),
      rest_(std::move(rest)),
      rest_handles_(character.Handles()) {}

void Checks::Expect(bool holds, int frame, const std::string& what) {
  if (holds) return;
  ++num_failures_;
  std::fprintf(stderr, "frame %d: %s\n", frame, what.c_str());
}

void Checks::LookAtFrame(int frame) {
  const std::vector<MovingVertex> drawn = character_.ReadBack();
  const std::vector<MovingVertex> expected = character_.SkinElsewhere();
  Expect(std::memcmp(drawn.data(), expected.data(), drawn.size() * sizeof(MovingVertex)) == 0,
         frame, "OGRE's vertices are not those of limberSkin");
  const Ogre::AxisAlignedBox& box = character_.entity()->getBoundingBox();
  const auto outside = std::count_if(drawn.begin(), drawn.end(), [&](const MovingVertex& vertex) {
    return !box.contains(VectorOf(vertex.position));
  });
  Expect(outside == 0, frame, std::to_string(outside) + " vertices are outside of the box");
  const std::vector<LimberHandleState> handles = character_.Handles();
  for (size_t handle = 0; handle < handles.size(); ++handle) {
    if (handles[handle].pinned != 0) LookAtHandle(frame, handle, drawn, handles[handle]);
  }
}

void Checks::LookAtHandle(int frame, size_t handle, const std::vector<MovingVertex>& skin,
                          const LimberHandleState& state) {
  const float diagonal = character_.info().diagonal;
  const Ogre::Vector3 target = VectorOf(state.target);
  const Ogre::Vector3 rest = VectorOf(rest_handles_[handle].position);
  size_t nearest = 0;
  float nearest_distance = diagonal, around = 0;
  for (size_t v = 0; v < skin.size(); ++v) {
    const float distance = rest.distance(VectorOf(rest_[v].position));
    if (distance < kAround * diagonal)
      around = std::max(around, target.distance(VectorOf(skin[v].position)));
    if (distance < nearest_distance) {
      nearest = v;
      nearest_distance = distance;
    }
  }
  const float miss = target.distance(VectorOf(skin[nearest].position)) / diagonal;
  worst_miss_ = std::max(worst_miss_, miss);
  farthest_ = std::max(farthest_, target.distance(rest) / diagonal);
  const std::string name = "handle " + std::to_string(handle);
  Expect(miss < kAtTarget, frame, name + ": its vertex is off by " + Number(miss));
  Expect(around < kStretched * kAround * diagonal, frame,
         name + ": its surroundings are off by " + Number(around / diagonal));
}

void Checks::LookAtPicture(int frame, const Ogre::Image& picture, const Ogre::Image& empty) {
  const double cover = PartThatDiffers(picture, empty);
  Expect(cover > kLeastCover && cover < kMostCover, frame,
         "the character covers " + Number(cover) + " of the picture");
  Expect(!TouchesTheBorder(picture, empty), frame, "the character is cut by the picture's border");
}

void Checks::LookAtPart(const Ogre::Image& whole, const Ogre::Image& without) {
  const double part = PartThatDiffers(whole, without);
  Expect(part > kLeastPart, 0, "a part takes only " + Number(part) + " of the picture");
}

void Checks::LookAtChange(const Ogre::Image& rest, const Ogre::Image& dragged) {
  const double change = PartThatDiffers(rest, dragged);
  Expect(change > kLeastChange, 0, "dragging changes only " + Number(change) + " of the picture");
  Expect(farthest_ > kLeastDrag, 0, "the farthest target was only " + Number(farthest_) + " away");
}
