// The player as a user has it: a window on a virtual screen, a synthetic mouse, pictures of the
// screen. Every run has the validation layer on with synchronization validation, and fails if it
// says a word.
#include "viewer/play_window.h"

#include "play_rigs.h"
#include "support/temporary_folder.h"
#include "viewer/image.h"
#include "viewer/play_controls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace limber::viewer {
namespace {

// As in play_host.cpp.
constexpr int kWidth = 640, kHeight = 480;

bool HasProgram(const char* name) {
  return std::system(("command -v " + std::string(name) + " >/dev/null 2>&1").c_str()) == 0;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Pixel {
  int x = 0, y = 0;
};

// The same character and controls in this process, to know what belongs where on the screen.
struct Twin {
  explicit Twin(const std::shared_ptr<const Rig>& rig)
      : character(PlayCharacter::Create(rig, {})),
        controls(&*character, kWidth, kHeight) {}

  Pixel Dot(const char* name) const {
    const auto handle = static_cast<size_t>(character->rig().FindHandle(name));
    const std::array<float, 3> at =
        controls.camera().Project(character->handle_positions()[handle], static_cast<float>(width),
                                  static_cast<float>(height));
    return {static_cast<int>(at[0]), static_cast<int>(at[1])};
  }

  void Drag(PointerButton button, Pixel from, Pixel to) {
    controls.PointerMoved(static_cast<float>(from.x), static_cast<float>(from.y));
    EXPECT_TRUE(controls.ButtonPressed(button, false, false).ok());
    controls.PointerMoved(static_cast<float>(to.x), static_cast<float>(to.y));
    controls.ButtonReleased(button);
  }

  int width = kWidth, height = kHeight;
  Result<PlayCharacter> character;
  PlayControls controls;
};

class PlayWindow : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"xvfb-run", "xdotool", "import", "convert"}) {
      if (!HasProgram(program)) GTEST_SKIP() << program << " is not installed";
    }
  }

  std::string File(const std::string& name) const { return (folder_.path() / name).string(); }

  // Runs the player with these steps (play_session.sh) and expects it to end well.
  void Play(const std::string& character, const std::string& steps) {
    std::ofstream(File("scenario")) << steps;
    const std::string command = "xvfb-run -a -s '-screen 0 800x600x24' '" LIMBER_PLAY_SESSION
                                "' '" +
                                std::string(LIMBER_PLAY_HOST) + "' " + character + " '" +
                                folder_.path().string() + "' '" + File("scenario") + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << ReadText(File("log"));
    EXPECT_EQ(ReadText(File("log")), "");
  }

  Image Shot(const std::string& name) const {
    Result<Image> image = ReadPng(File(name + ".png"));
    EXPECT_TRUE(image.ok()) << image.status().message();
    return image.ok() ? std::move(*image) : Image();
  }

  test::TemporaryFolder folder_;
};

std::string Step(const char* name, std::initializer_list<int> numbers) {
  std::ostringstream step;
  step << name;
  for (const int number : numbers)
    step << ' ' << number;
  step << '\n';
  return step.str();
}

const uint8_t* PixelAt(const Image& image, int x, int y) {
  static const uint8_t kOutside[4] = {};
  if (x < 0 || y < 0 || x >= static_cast<int>(image.width) || y >= static_cast<int>(image.height)) {
    return kOutside;
  }
  return image.pixel(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
}

// Pixels of the square about `at` that differ by more than 16 of 255 in a channel.
int Changed(const Image& a, const Image& b, Pixel at, int radius) {
  if (a.width != b.width || a.height != b.height) return -1;
  int changed = 0;
  for (int y = at.y - radius; y <= at.y + radius; ++y) {
    for (int x = at.x - radius; x <= at.x + radius; ++x) {
      const uint8_t* p = PixelAt(a, x, y);
      const uint8_t* q = PixelAt(b, x, y);
      int most = 0;
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(p[c] - q[c]));
      if (most > 16) ++changed;
    }
  }
  return changed;
}

int ChangedAnywhere(const Image& a, const Image& b) {
  return Changed(a, b, {400, 300}, 400);
}

// The strong orange of a pinned dot within two pixels of there: nothing else is so saturated.
bool HasDot(const Image& image, Pixel at) {
  for (int y = at.y - 2; y <= at.y + 2; ++y) {
    for (int x = at.x - 2; x <= at.x + 2; ++x) {
      const uint8_t* p = PixelAt(image, x, y);
      if (p[0] - p[2] > 100) return true;
    }
  }
  return false;
}

bool IsBlack(const Image& image, Pixel at) {
  const uint8_t* p = PixelAt(image, at.x, at.y);
  return p[0] + p[1] + p[2] == 0;
}

TEST_F(PlayWindow, DragHover_Reset) {
  Twin twin(test::BakeCylinder());
  const Pixel from = twin.Dot("top"), to = {from.x + 120, from.y + 60}, bottom = twin.Dot("bottom");
  twin.Drag(PointerButton::kLeft, from, to);
  const Pixel dropped = twin.Dot("top");
  Play("cylinder", Step("hover", {5, 470}) + "shot before\n" +                    //
                       Step("hover", {from.x, from.y}) + "shot hover before\n" +  //
                       Step("drag 1", {from.x, from.y, to.x, to.y}) +             //
                       Step("hover", {5, 470}) + "shot after hover\n" +           //
                       "key r\nshot reset after\nkey h\nshot no_dots reset\n");
  const Image before = Shot("before"), after = Shot("after"), reset = Shot("reset");
  ASSERT_GT(before.width, 0u);
  EXPECT_TRUE(HasDot(before, from));
  EXPECT_FALSE(HasDot(before, dropped));
  EXPECT_TRUE(HasDot(after, dropped)) << "the dot is where the pointer dropped it";
  EXPECT_FALSE(HasDot(after, from));
  EXPECT_TRUE(HasDot(after, bottom)) << "the other handle stayed";
  EXPECT_GT(Changed(before, after, {dropped.x, dropped.y + 20}, 15), 300) << "and the skin came";
  EXPECT_EQ(Changed(before, after, {40, 40}, 30), 0) << "not so the far corner";
  EXPECT_GT(Changed(before, Shot("hover"), from, 12), 20) << "a dot shines under the pointer";
  EXPECT_EQ(Changed(before, Shot("hover"), bottom, 12), 0);
  EXPECT_LE(ChangedAnywhere(before, reset), 20) << "R brings the rest pose back";
  EXPECT_FALSE(HasDot(Shot("no_dots"), from)) << "H hides the dots";
}

TEST_F(PlayWindow, OrbitZoomPanAndFrame) {
  Twin twin(test::BakeCylinder());
  twin.Drag(PointerButton::kLeft, {30, 30}, {130, 110});
  const Pixel orbited = twin.Dot("top");
  twin.Drag(PointerButton::kMiddle, {30, 30}, {90, 70});
  const Pixel panned = twin.Dot("top");
  twin.controls.Scrolled(1);
  const Pixel zoomed = twin.Dot("top");
  ASSERT_TRUE(twin.controls.KeyPressed(PlayKey::kFrame).ok());
  const Pixel framed = twin.Dot("top");
  Play("cylinder", Step("hover", {5, 470}) + "shot before\n" +                         //
                       Step("drag 1", {30, 30, 130, 110}) + Step("hover", {5, 470}) +  //
                       "shot orbited before\n" +                                       //
                       Step("drag 2", {30, 30, 90, 70}) + "shot panned orbited\n" +    //
                       "scroll_in\nshot zoomed panned\nkey f\nshot framed zoomed\n");
  EXPECT_TRUE(HasDot(Shot("orbited"), orbited));
  EXPECT_GT(ChangedAnywhere(Shot("before"), Shot("orbited")), 1000);
  EXPECT_TRUE(HasDot(Shot("panned"), panned));
  EXPECT_TRUE(HasDot(Shot("zoomed"), zoomed));
  EXPECT_GT(std::abs(zoomed.y - panned.y) + std::abs(zoomed.x - panned.x), 5);
  EXPECT_TRUE(HasDot(Shot("framed"), framed));
}

TEST_F(PlayWindow, SkinPulledAndLetGo_HandlesStay) {
  const Twin twin(test::BakeCylinder());
  const Pixel top = twin.Dot("top"), skin = {top.x, top.y + 60};
  Play("cylinder", "shot before\n" + Step("drag 1", {skin.x, skin.y, skin.x - 70, skin.y + 10}) +
                       Step("hover", {5, 470}) + "shot after\n");
  EXPECT_TRUE(HasDot(Shot("after"), top));
  EXPECT_TRUE(HasDot(Shot("after"), twin.Dot("bottom")));
}

TEST_F(PlayWindow, PinKey_LetsTheHandleUnderThePointerGoAndHoldsItAgain) {
  const Twin twin(test::BakeCylinder());
  const Pixel top = twin.Dot("top");
  const std::string toggle =
      Step("hover", {top.x, top.y}) + "xdotool sleep 0.3\nkey p\n" + Step("hover", {5, 470});
  Play("cylinder", "shot before\n" + toggle + "shot free before\n" + toggle + "shot again free\n");
  EXPECT_TRUE(HasDot(Shot("before"), top));
  EXPECT_FALSE(HasDot(Shot("free"), top));
  EXPECT_TRUE(HasDot(Shot("again"), top));
}

TEST_F(PlayWindow, ResizedAndHidden_GoesOn) {
  Twin twin(test::BakeCylinder());
  twin.width = 420;
  twin.height = 300;
  twin.controls.Resized(420, 300);
  const Pixel small = twin.Dot("top");
  twin.width = 760;
  twin.height = 560;
  twin.controls.Resized(760, 560);
  const Pixel large = twin.Dot("top");
  Play("cylinder", Step("hover", {5, 5}) +
                       "shot before\nresize 420 300\nshot small before\nhide_and_show\n" +
                       "shot again\nresize 760 560\nshot large again\n");
  const Image at_small = Shot("small"), at_large = Shot("large");
  EXPECT_TRUE(HasDot(at_small, small));
  EXPECT_TRUE(IsBlack(at_small, {430, 150})) << "the screen beside the window";
  EXPECT_FALSE(IsBlack(at_small, {415, 295})) << "the picture fills the window";
  EXPECT_LE(ChangedAnywhere(at_small, Shot("again")), 20) << "hidden and shown again";
  EXPECT_TRUE(HasDot(at_large, large));
  EXPECT_FALSE(IsBlack(at_large, {755, 555}));
}

TEST_F(PlayWindow, Planar_IsDraggedAndPannedFaceOn) {
  Twin twin(test::BakeSquare());
  const Pixel right = twin.Dot("right"), to = {right.x + 100, right.y - 30};
  twin.Drag(PointerButton::kLeft, right, to);
  twin.Drag(PointerButton::kLeft, {560, 400}, {600, 440});  // background: pans
  const Pixel dropped = twin.Dot("right"), left = twin.Dot("left");
  Play("square", "shot before\n" + Step("drag 1", {right.x, right.y, to.x, to.y}) +  //
                     Step("drag 1", {560, 400, 600, 440}) +                          //
                     Step("hover", {5, 5}) + "shot after before\n");
  EXPECT_TRUE(HasDot(Shot("after"), dropped));
  EXPECT_TRUE(HasDot(Shot("after"), left));
}

TEST_F(PlayWindow, FramesAndScreenshot_WriteThePictureAndEnd) {
  const std::string command =
      "xvfb-run -a -s '-screen 0 800x600x24' '" + std::string(LIMBER_PLAY_HOST) +
      "' cylinder --frames 3 --screenshot '" + File("picture.png") + "' 2> '" + File("log") + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << ReadText(File("log"));
  const Image picture = Shot("picture");
  ASSERT_EQ(picture.width, static_cast<uint32_t>(kWidth));
  ASSERT_EQ(picture.height, static_cast<uint32_t>(kHeight));
  const Twin twin(test::BakeCylinder());
  EXPECT_TRUE(HasDot(picture, twin.Dot("top")));
  EXPECT_TRUE(HasDot(picture, twin.Dot("bottom")));
}

TEST_F(PlayWindow, NoDisplay_OneClearLine) {
  const std::string command = "env -u DISPLAY -u WAYLAND_DISPLAY '" +
                              std::string(LIMBER_PLAY_HOST) + "' cylinder 2> '" + File("log") + "'";
  EXPECT_NE(std::system(command.c_str()), 0);
  const std::string log = ReadText(File("log"));
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
  EXPECT_NE(log.find("no screen"), std::string::npos) << log;
  EXPECT_NE(log.find("limber render"), std::string::npos) << log;
}

}  // namespace
}  // namespace limber::viewer
