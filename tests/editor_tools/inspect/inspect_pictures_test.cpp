// The colours arrive in the picture: at a handle the top of the scale, far away its bottom; each
// group's own; those of the examples that the pose is made of.
#include "core/vector.h"
#include "inspect/colored_character.h"
#include "inspect/group_colors.h"
#include "runtime/skin_vulkan/test_device.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"
#include "viewer/headless.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace limber::inspect {
namespace {

constexpr uint32_t kWidth = 320, kHeight = 240;

struct Drawn {
  viewer::Image image;
  viewer::OrbitCamera camera;
  std::shared_ptr<const Rig> rig;

  // The pixel where a solve vertex at rest is seen, a little towards the middle: off the outline.
  const uint8_t* At(uint32_t vertex) const {
    const Eigen::Vector3d middle(0.5, 0, 0);
    const Eigen::Vector3d p = 0.96 * test::ShapePosition(*rig, 0, vertex) + 0.04 * middle;
    const auto place = camera.Project({float(p.x()), float(p.y()), float(p.z())}, kWidth, kHeight);
    return image.pixel(static_cast<uint32_t>(place[0]), static_cast<uint32_t>(place[1]));
  }
};

Drawn Draw(const PoseState& state, const std::shared_ptr<const Rig>& rig,
           const ColoredCharacter& character) {
  viewer::HeadlessOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.validation = true;
  auto renderer = viewer::HeadlessRenderer::Create(character.Source(), options);
  EXPECT_TRUE(renderer.ok()) << renderer.status().message();
  Drawn drawn{{}, (*renderer)->DefaultCamera(), rig};
  const Status status =
      (*renderer)->RenderFrame(state.transforms(), drawn.camera, {}, &drawn.image);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE((*renderer)->validation_log().messages().empty());
  return drawn;
}

Drawn Draw(const std::shared_ptr<const Rig>& rig, const ColoredCharacter& character) {
  return Draw(PoseState::Create(rig).value(), rig, character);
}

class InspectPictures : public testing::Test {
 protected:
  void SetUp() override {
    const std::string reason = test::PrepareVulkan();
    if (!reason.empty()) GTEST_SKIP() << "no Vulkan device: " << reason;
  }
};

// Red and blue beside each other tell the ends of the scale apart in any light.
double Yellowness(const uint8_t* pixel) {
  return (double{1} * pixel[0] + pixel[1]) / 2 - pixel[2];
}

bool Near(const uint8_t* pixel, const std::array<uint8_t, 4>& color) {
  for (size_t channel = 0; channel < 3; ++channel) {
    if (std::abs(pixel[channel] - color[channel]) > 3) return false;
  }
  return true;
}

Oklab FromPixel(const uint8_t* pixel) {
  Color linear;
  for (size_t channel = 0; channel < 3; ++channel) {
    const double code = pixel[channel] / 255.0;
    linear[channel] = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
  }
  return ToOklab(linear);
}

TEST_F(InspectPictures, Weights_AreYellowAtTheirHandleAndBlueAtOthers) {
  const auto rig = test::BakeInMemory(test::MakeStretchSquare(16));  // planar: drawn unlit
  ASSERT_NE(rig, nullptr);
  for (int handle : {0, 2}) {
    const Drawn drawn = Draw(rig, ColorByWeight(*rig, handle));
    for (int other = 0; other < rig->num_handles(); ++other) {
      const double yellowness = Yellowness(drawn.At(rig->tables().handles[size_t(other)].vertex));
      if (other == handle) {
        EXPECT_GT(yellowness, 40) << handle;
      } else {
        EXPECT_LT(yellowness, -30) << handle << " at " << other;
      }
    }
  }
}

TEST_F(InspectPictures, Groups_HaveTheirColours) {
  const auto rig = test::BakeInMemory(test::MakeStretchSquare(16));
  ASSERT_NE(rig, nullptr);
  Vector<int> groups;
  for (uint32_t v = 0; v < rig->mesh().num_solve_vertices; ++v)
    groups.push_back(test::ShapePosition(*rig, 0, v).x() < 0.5 ? 0 : 1);
  const Vector<Color> colors = Palette(2);
  const Drawn drawn = Draw(rig, ColorByGroup(*rig, groups, colors));
  const auto& handles = rig->tables().handles;
  for (const size_t side : {0u, 1u}) {
    const Eigen::Vector3d rim = test::ShapePosition(*rig, 0, handles[2 * side].vertex);
    const float inside = side == 0 ? 0.1f : -0.1f;
    const auto place =
        drawn.camera.Project({float(rim.x()) + inside, float(rim.y()), 0}, kWidth, kHeight);
    const uint8_t* pixel =
        drawn.image.pixel(static_cast<uint32_t>(place[0]), static_cast<uint32_t>(place[1]));
    const auto expected = ToBytes(colors[side]);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(pixel[channel], expected[size_t(channel)], 6) << "side " << side;
  }
}

// Lines darken what is there and nothing else; from a handle to the far side they cross each tenth
// that is wide enough for them, once.
TEST_F(InspectPictures, Weights_HaveALineAtEachTenth) {
  const auto rig = test::BakeInMemory(test::MakeStretchSquare(16));
  ASSERT_NE(rig, nullptr);
  ColoredCharacter character = ColorByWeight(*rig, 0);
  const Drawn lined = Draw(rig, character);
  character.materials.materials[0].contours = false;
  const Drawn plain = Draw(rig, character);
  const auto darkening = [&](uint32_t x, uint32_t y) {
    return plain.image.pixel(x, y)[1] - lined.image.pixel(x, y)[1];
  };
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x)
      ASSERT_GE(darkening(x, y), -1) << x << ", " << y;
  }
  int num_lines = 0;
  for (uint32_t x = 1; x < kWidth; ++x)
    num_lines += darkening(x, kHeight / 2) > 10 && darkening(x - 1, kHeight / 2) <= 10 ? 1 : 0;
  EXPECT_GE(num_lines, 5);
  EXPECT_LE(num_lines, 9);
}

// Posed exactly as an example, by the handles alone, the body has this example's colour.
TEST_F(InspectPictures, Examples_APosedExampleHasItsColour) {
  const auto rig = test::BakeInMemory(test::MakeStretchSquare(16));
  ASSERT_NE(rig, nullptr);
  const Vector<int> groups(rig->mesh().num_solve_vertices, 0);
  const Vector<Color> colors = ExampleColors(rig->tables().num_shapes());
  for (int s = 0; s < rig->tables().num_shapes(); ++s) {
    PoseState state = PoseState::Create(rig).value();
    for (const int handle : {0, 2}) {
      const auto p =
          test::ShapePosition(*rig, s, rig->tables().handles[static_cast<size_t>(handle)].vertex);
      ASSERT_TRUE(state.SetTarget(handle, {float(p.x()), float(p.y()), float(p.z())}).ok());
    }
    PoseOptions options;
    options.iterations = 60;
    ASSERT_TRUE(state.Solve(options, nullptr).ok());
    const auto mixed = MixedByBlendWeights(state.blend_weights(), colors);
    const Drawn drawn = Draw(state, rig, ColorByGroup(*rig, groups, mixed));
    const auto centre = test::ShapePosition(*rig, s, rig->tables().handles[1].vertex);
    const auto place =
        drawn.camera.Project({float(centre.x()), float(centre.y()), 0}, kWidth, kHeight);
    const uint8_t* pixel =
        drawn.image.pixel(static_cast<uint32_t>(place[0]), static_cast<uint32_t>(place[1]));
    const auto expected = ToBytes(colors[static_cast<size_t>(s)]);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(pixel[channel], expected[size_t(channel)], 8) << "example " << s;
  }
}

// Lit from above and in shadow below, a colour is still that colour: its hue and chroma near what
// they are, its lightness moved by less than what tells two steps of the palette apart.
TEST_F(InspectPictures, Shading_LeavesColoursReadable) {
  const auto rig = test::BakeInMemory(test::MakeBendCylinder(24, 24));
  ASSERT_NE(rig, nullptr);
  const Vector<int> groups(rig->mesh().num_solve_vertices, 0);
  double least = 1, most = 0;
  for (const Color& color : Palette(6)) {
    const Drawn drawn = Draw(rig, ColorByGroup(*rig, groups, {color}));
    const Oklab flat = ToOklab(color);
    for (uint32_t v = 0; v < rig->mesh().num_solve_vertices; ++v) {
      const Eigen::Vector3d p = 0.9 * test::ShapePosition(*rig, 0, v);
      const auto place =
          drawn.camera.Project({float(p.x()), float(p.y()), float(p.z())}, kWidth, kHeight);
      const Oklab seen = FromPixel(
          drawn.image.pixel(static_cast<uint32_t>(place[0]), static_cast<uint32_t>(place[1])));
      EXPECT_LT(std::hypot(seen.a - flat.a, seen.b - flat.b), 0.05) << v;
      EXPECT_LT(std::abs(seen.lightness - flat.lightness), 0.12) << v;
      least = std::min(least, seen.lightness - flat.lightness);
      most = std::max(most, seen.lightness - flat.lightness);
    }
  }
  EXPECT_GT(most - least, 0.05) << "the form is there";
}

// On a flat character, drawn without shading: as many colours as groups, each where it belongs.
TEST_F(InspectPictures, Groups_AreAsManyAsTheirColours) {
  const auto rig = test::BakeInMemory(test::MakeStretchSquare(16));
  ASSERT_NE(rig, nullptr);
  constexpr int kGroups = 9;
  Vector<int> groups;
  for (uint32_t v = 0; v < rig->mesh().num_solve_vertices; ++v) {
    const auto p = test::ShapePosition(*rig, 0, v);
    groups.push_back(std::min(2, int(3 * p.x())) + 3 * std::min(2, int(3 * (p.y() + 0.5))));
  }
  const Vector<Color> colors = GroupColors(rig->mesh(), groups, kGroups);
  const Drawn drawn = Draw(rig, ColorByGroup(*rig, groups, colors));
  Vector<int> num_pixels(kGroups, 0);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      for (size_t g = 0; g < colors.size(); ++g)
        num_pixels[g] += Near(drawn.image.pixel(x, y), ToBytes(colors[g])) ? 1 : 0;
    }
  }
  const int most = *std::max_element(num_pixels.begin(), num_pixels.end());
  for (const int count : num_pixels)
    EXPECT_GT(count, most / 3) << "a group that is not seen";
}

}  // namespace
}  // namespace limber::inspect
