// Pictures of characters made in code, on lavapipe, against stored ones and against each other.
//
// LIMBER_UPDATE_GOLDEN=1 writes the stored pictures anew; look at them before they are committed.
#include "runtime/skin/skin_fixtures.h"
#include "runtime/skin_vulkan/test_device.h"
#include "skin/cpu_skinner.h"
#include "viewer/headless.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace limber::viewer {
namespace {

constexpr uint32_t kWidth = 240, kHeight = 180;

struct Difference {
  double mean = 0;       // of all channels, in codes of 255
  double far_share = 0;  // pixels with a channel further off than 8 codes
};

Difference Compare(const Image& a, const Image& b) {
  Difference difference;
  size_t far_pixels = 0;
  for (size_t i = 0; i < a.rgba.size(); i += 4) {
    bool far_off = false;
    for (size_t c = i; c < i + 4; ++c) {
      const int delta = std::abs(int{a.rgba[c]} - int{b.rgba[c]});
      difference.mean += delta;
      far_off = far_off || delta > 8;
    }
    far_pixels += far_off ? 1 : 0;
  }
  difference.mean /= static_cast<double>(a.rgba.size());
  difference.far_share = 4.0 * static_cast<double>(far_pixels) / static_cast<double>(a.rgba.size());
  return difference;
}

void ExpectSame(const Image& found, const Image& expected, const std::string& name) {
  ASSERT_EQ(found.width, expected.width) << name;
  ASSERT_EQ(found.height, expected.height) << name;
  const Difference difference = Compare(found, expected);
  EXPECT_LT(difference.mean, 1.0) << name;
  EXPECT_LT(difference.far_share, 0.005) << name;
}

// Compares with tests/editor_tools/viewer/golden/<name>.png. Where it differs the found picture is
// written to the build folder.
void ExpectGolden(const Image& found, const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::path(LIMBER_SOURCE_DIR) / "tests/editor_tools/viewer/golden";
  const std::filesystem::path path = folder / (name + ".png");
  if (std::getenv("LIMBER_UPDATE_GOLDEN") != nullptr) {
    ASSERT_TRUE(WritePng(path, found).ok());
    return;
  }
  const Result<Image> stored = ReadPng(path);
  ASSERT_TRUE(stored.ok()) << stored.status().message();
  ExpectSame(found, *stored, name);
  if (testing::Test::HasFailure()) {
    const std::filesystem::path out = std::filesystem::path(LIMBER_BINARY_DIR) / (name + ".png");
    EXPECT_TRUE(WritePng(out, found).ok());
    ADD_FAILURE() << "found picture: " << out;
  }
}

class GoldenTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string reason = test::PrepareVulkan();
    if (!reason.empty()) GTEST_SKIP() << "no Vulkan device: " << reason;
  }

  std::unique_ptr<HeadlessRenderer> Make(const CharacterSource& source) {
    HeadlessOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.validation = true;
    auto made = HeadlessRenderer::Create(source, options);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return made.ok() ? std::move(*made) : nullptr;
  }

  static void ExpectSilence(const HeadlessRenderer& headless) {
    for (const std::string& message : headless.validation_log().messages()) {
      ADD_FAILURE() << message;
    }
    EXPECT_EQ(headless.validation_log().count(), 0);
  }
};

CharacterSource Source(const test::SkinFixture& fixture) {
  CharacterSource source;
  source.mesh = &fixture.mesh;
  source.space = fixture.space;
  return source;
}

// A checkerboard in two colours with a stripe, so that wrongly laid coordinates show.
Image Checkers() {
  Image image;
  image.width = image.height = 64;
  for (uint32_t y = 0; y < 64; ++y) {
    for (uint32_t x = 0; x < 64; ++x) {
      const bool dark = (x / 8 + y / 8) % 2 == 1, stripe = x < 8;
      const std::array<uint8_t, 4> color = stripe ? std::array<uint8_t, 4>{230, 90, 60, 255}
                                           : dark ? std::array<uint8_t, 4>{60, 110, 150, 255}
                                                  : std::array<uint8_t, 4>{235, 225, 205, 255};
      image.rgba.insert(image.rgba.end(), color.begin(), color.end());
    }
  }
  return image;
}

TEST_F(GoldenTest, BentCylinderWithHandles) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(40, 48);
  auto headless = Make(Source(fixture));
  ASSERT_NE(headless, nullptr);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.7);
  const HandleDot dots[] = {{{0, 0.05f, 0.2f}, true, false, false},
                            {{0.2f, 1.0f, 0.2f}, false, false, false},
                            {{0.55f, 1.6f, 0}, true, true, false},
                            {{0.3f, 1.3f, 0}, true, false, true}};
  Image image;
  ASSERT_TRUE(headless->RenderFrame(pose.view(), headless->DefaultCamera(), dots, &image).ok());
  ExpectGolden(image, "bent_cylinder");
  ExpectSilence(*headless);
}

TEST_F(GoldenTest, TexturedSphere) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(48, 24);
  test::SkinFixture textured = fixture;
  textured.mesh.primitives[0].material = 0;
  CharacterSource source = Source(textured);
  Material material;
  material.base_color_texture.image = 0;
  source.materials.materials = {material};
  source.materials.images = {Checkers()};
  auto headless = Make(source);
  ASSERT_NE(headless, nullptr);
  Image image;
  ASSERT_TRUE(
      headless->RenderFrame(test::RestPose(textured).view(), headless->DefaultCamera(), {}, &image)
          .ok());
  ExpectGolden(image, "textured_sphere");
  ExpectSilence(*headless);
}

TEST_F(GoldenTest, NormalMapAndBlending) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(48, 24);
  fixture.mesh.primitives[0].material = 0;
  CharacterSource source = Source(fixture);
  Material material;
  material.base_color = {0.3f, 0.5f, 0.8f, 0.8f};
  material.alpha_mode = AlphaMode::kBlend;
  material.normal_texture.image = 0;
  material.roughness = 0.3f;
  Image bumps;
  bumps.width = bumps.height = 64;
  for (int i = 0; i < 64 * 64; ++i) {
    const double x = std::sin(i % 64 * 0.589), y = std::sin(i / 64 * 0.589);
    for (const double channel : {127.5 + 60 * x, 127.5 + 60 * y, 230.0, 255.0}) {
      bumps.rgba.push_back(static_cast<uint8_t>(channel));
    }
  }
  source.materials.materials = {material};
  source.materials.images = {bumps};
  auto headless = Make(source);
  ASSERT_NE(headless, nullptr);
  Image image;
  ASSERT_TRUE(
      headless->RenderFrame(test::RestPose(fixture).view(), headless->DefaultCamera(), {}, &image)
          .ok());
  ExpectGolden(image, "normal_map");
  ExpectSilence(*headless);
}

TEST_F(GoldenTest, FlatCharacter_KeepsThePicturesColours) {
  test::SkinFixture fixture;  // a square of side 2 in the xy plane
  SkinMesh& mesh = fixture.mesh;
  mesh.num_handles = mesh.num_shapes = 1;
  mesh.num_solve_vertices = mesh.num_draw_vertices = 4;
  mesh.weights.assign(4, 1.0f);
  mesh.shape_positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.solve_vertex = {0, 1, 2, 3};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  mesh.texcoords = {0, 1, 1, 1, 1, 0, 0, 0};
  SkinPrimitive primitive;
  primitive.num_vertices = 4;
  primitive.num_triangles = 2;
  primitive.material = 0;
  mesh.primitives = {primitive};
  CharacterSource source = Source(fixture);
  source.dimension = 2;
  Material material;
  material.base_color_texture.image = 0;
  material.base_color_texture.nearest = true;
  source.materials.materials = {material};
  source.materials.images = {Checkers()};
  auto headless = Make(source);
  ASSERT_NE(headless, nullptr);
  Image image;
  ASSERT_TRUE(
      headless->RenderFrame(test::RestPose(fixture).view(), headless->DefaultCamera(), {}, &image)
          .ok());
  ExpectGolden(image, "flat_square");
  // The stripe is on the left, as in the picture, and its colour is the painted one.
  const uint8_t* stripe = image.pixel(kWidth / 2 - 73, kHeight / 2);
  EXPECT_NEAR(stripe[0], 230, 3);
  EXPECT_NEAR(stripe[1], 90, 3);
  EXPECT_NEAR(stripe[2], 60, 3);
  ExpectSilence(*headless);
}

TEST_F(GoldenTest, SkinnedOnTheGpu_LooksLikeSkinnedOnTheCpu) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(40, 48);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.9);
  // The CPU's result as a character of its own, drawn at rest.
  Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(cpu.ok());
  ASSERT_TRUE(cpu->Skin(pose.view()).ok());
  test::SkinFixture still;
  still.mesh = fixture.mesh;
  still.mesh.num_handles = still.mesh.num_shapes = 1;
  still.mesh.weights.assign(fixture.mesh.num_solve_vertices, 1.0f);
  still.mesh.shape_positions.assign(cpu->result().solve_positions.begin(),
                                    cpu->result().solve_positions.end());
  still.mesh.rest_normals.assign(cpu->result().normals.begin(), cpu->result().normals.end());
  // Light and shadow are laid out by the example shapes' box: make it the same.
  auto moving = Make(Source(fixture));
  ASSERT_NE(moving, nullptr);
  const Bounds bounds = moving->renderer().bounds();
  still.mesh.num_shapes = 3;
  const size_t count = still.mesh.num_solve_vertices;
  still.mesh.shape_positions.resize(3 * count, bounds.low);
  still.mesh.shape_positions[2 * count] = bounds.high;
  auto posed = Make(Source(still));
  ASSERT_NE(posed, nullptr);
  OrbitCamera camera = moving->DefaultCamera();
  camera.Orbit(0.4f, 0.1f);
  Image gpu, reference;
  ASSERT_TRUE(moving->RenderFrame(pose.view(), camera, {}, &gpu).ok());
  ASSERT_TRUE(posed->RenderFrame(test::RestPose(still).view(), camera, {}, &reference).ok());
  ExpectSame(gpu, reference, "GPU against CPU");
  Image other;
  ASSERT_TRUE(
      moving->RenderFrame(test::CylinderPose(fixture, 0.5).view(), camera, {}, &other).ok());
  EXPECT_GT(Compare(gpu, other).far_share, 0.02) << "the comparison sees nothing";
  ExpectSilence(*moving);
  ExpectSilence(*posed);
}

TEST_F(GoldenTest, TheSameFrameTwice_IsBitwiseEqual) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(24, 24);
  auto headless = Make(Source(fixture));
  ASSERT_NE(headless, nullptr);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.4);
  Image first, second;
  ASSERT_TRUE(headless->RenderFrame(pose.view(), headless->DefaultCamera(), {}, &first).ok());
  ASSERT_TRUE(headless->RenderFrame(pose.view(), headless->DefaultCamera(), {}, &second).ok());
  EXPECT_EQ(first.rgba, second.rgba);
  EXPECT_GT(headless->times().total_ms, 0);
  ExpectSilence(*headless);
}

TEST_F(GoldenTest, SizesThatCannotBeDrawn_AreRefused) {
  const test::SkinFixture fixture = test::MakeCubeFixture();
  for (const uint32_t side : {0u, 1u << 20}) {
    HeadlessOptions options;
    options.width = side;
    const auto made = HeadlessRenderer::Create(Source(fixture), options);
    EXPECT_EQ(made.status().code(), StatusCode::kInvalidArgument) << side;
  }
}

}  // namespace
}  // namespace limber::viewer
