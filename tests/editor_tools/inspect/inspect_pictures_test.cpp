// The colours arrive in the picture: at a handle the top of the scale, far away its bottom.
#include "inspect/colored_character.h"
#include "runtime/skin_vulkan/test_device.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"
#include "viewer/headless.h"

#include <gtest/gtest.h>

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

Drawn Draw(const std::shared_ptr<const Rig>& rig, const ColoredCharacter& character) {
  viewer::HeadlessOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.validation = true;
  auto renderer = viewer::HeadlessRenderer::Create(character.Source(), options);
  EXPECT_TRUE(renderer.ok()) << renderer.status().message();
  Drawn drawn{{}, (*renderer)->DefaultCamera(), rig};
  const PoseState state = PoseState::Create(rig).value();
  const Status status =
      (*renderer)->RenderFrame(state.transforms(), drawn.camera, {}, &drawn.image);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE((*renderer)->validation_log().messages().empty());
  return drawn;
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
  std::vector<int> groups;
  for (uint32_t v = 0; v < rig->mesh().num_solve_vertices; ++v)
    groups.push_back(test::ShapePosition(*rig, 0, v).x() < 0.5 ? 0 : 1);
  const std::vector<Color> colors = Palette(2);
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

}  // namespace
}  // namespace limber::inspect
