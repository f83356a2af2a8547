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

  // One frame through the default camera; empty where drawing failed.
  static Image Draw(HeadlessRenderer* headless, const test::SkinPose& pose,
                    std::span<const HandleDot> dots = {}) {
    Image image;
    const Status drawn =
        headless->RenderFrame(pose.view(), headless->DefaultCamera(), dots, &image);
    EXPECT_TRUE(drawn.ok()) << drawn.message();
    return image;
  }

  // Draws a character once against the stored picture of that name, without a word from Vulkan.
  Image ExpectPicture(const CharacterSource& source, const test::SkinPose& pose,
                      const std::string& name, std::span<const HandleDot> dots = {}) {
    auto headless = Make(source);
    if (headless == nullptr) return {};
    Image image = Draw(headless.get(), pose, dots);
    ExpectGolden(image, name);
    ExpectSilence(*headless);
    return image;
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

// One material, whose base colour is `color`.
void PutTexture(CharacterSource* source, const Image& color, bool nearest = false) {
  Material material;
  material.base_color_texture.image = 0;
  material.base_color_texture.nearest = nearest;
  source->materials.materials = {material};
  source->materials.images = {color};
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

// A normal map of round bumps in rows.
Image Bumps() {
  constexpr int kSide = 64;
  Image image;
  image.width = image.height = kSide;
  const auto wave = [](int pixel) { return 127.5 + 60 * std::sin(pixel * 0.589); };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (const double channel : {wave(x), wave(y), 230.0, 255.0}) {
        image.rgba.push_back(static_cast<uint8_t>(channel));
      }
    }
  }
  return image;
}

// A square of side 2 in the xy plane.
test::SkinFixture FlatSquare() {
  test::SkinFixture fixture;
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
  return fixture;
}

TEST_F(GoldenTest, BentCylinderWithHandles) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(40, 48);
  const HandleDot dots[] = {{{0, 0.05f, 0.2f}, true, false, false},
                            {{0.2f, 1.0f, 0.2f}, false, false, false},
                            {{0.55f, 1.6f, 0}, true, true, false},
                            {{0.3f, 1.3f, 0}, true, false, true}};
  ExpectPicture(Source(fixture), test::CylinderPose(fixture, 0.7), "bent_cylinder", dots);
}

TEST_F(GoldenTest, TexturedSphere) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(48, 24);
  fixture.mesh.primitives[0].material = 0;
  CharacterSource source = Source(fixture);
  PutTexture(&source, Checkers());
  ExpectPicture(source, test::RestPose(fixture), "textured_sphere");
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
  source.materials.materials = {material};
  source.materials.images = {Bumps()};
  ExpectPicture(source, test::RestPose(fixture), "normal_map");
}

TEST_F(GoldenTest, FlatCharacter_KeepsThePicturesColours) {
  const test::SkinFixture fixture = FlatSquare();
  CharacterSource source = Source(fixture);
  source.dimension = 2;
  PutTexture(&source, Checkers(), true);
  const Image image = ExpectPicture(source, test::RestPose(fixture), "flat_square");
  ASSERT_FALSE(image.rgba.empty());
  // The stripe is on the left, as in the picture, and its colour is the painted one.
  const uint8_t* stripe = image.pixel(kWidth / 2 - 73, kHeight / 2);
  EXPECT_NEAR(stripe[0], 230, 3);
  EXPECT_NEAR(stripe[1], 90, 3);
  EXPECT_NEAR(stripe[2], 60, 3);
}

// The CPU's result as a character of its own, to be drawn at rest, whose example shapes fill
// `bounds`: light and shadow are laid out by them.
test::SkinFixture Frozen(const test::SkinFixture& fixture, const DeformedMesh& result,
                         const Bounds& bounds) {
  test::SkinFixture still;
  still.mesh = fixture.mesh;
  still.mesh.num_handles = 1;
  still.mesh.num_shapes = 3;
  const size_t count = fixture.mesh.num_solve_vertices;
  still.mesh.weights.assign(count, 1.0f);
  still.mesh.shape_positions.assign(result.solve_positions.begin(), result.solve_positions.end());
  still.mesh.shape_positions.resize(3 * count, bounds.low);
  still.mesh.shape_positions[2 * count] = bounds.high;
  still.mesh.rest_normals.assign(result.normals.begin(), result.normals.end());
  return still;
}

TEST_F(GoldenTest, SkinnedOnTheGpu_LooksLikeSkinnedOnTheCpu) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(40, 48);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.9);
  Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(cpu.ok());
  ASSERT_TRUE(cpu->Skin(pose.view()).ok());
  auto moving = Make(Source(fixture));
  ASSERT_NE(moving, nullptr);
  const test::SkinFixture still = Frozen(fixture, cpu->result(), moving->renderer().bounds());
  auto posed = Make(Source(still));
  ASSERT_NE(posed, nullptr);
  OrbitCamera camera = moving->DefaultCamera();
  camera.Orbit(0.4f, 0.1f);
  Image gpu, reference, other;
  ASSERT_TRUE(moving->RenderFrame(pose.view(), camera, {}, &gpu).ok());
  ASSERT_TRUE(posed->RenderFrame(test::RestPose(still).view(), camera, {}, &reference).ok());
  ExpectSame(gpu, reference, "GPU against CPU");
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
  const Image first = Draw(headless.get(), pose), second = Draw(headless.get(), pose);
  ASSERT_FALSE(first.rgba.empty());
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
