#include "inspect/picture_layout.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limber::inspect {
namespace {

viewer::Image Plain(uint32_t width, uint32_t height, uint8_t value) {
  return {width, height, Vector<uint8_t>(size_t{width} * height * 4, value)};
}

TEST(ContactSheet, EveryPictureHasItsPlace) {
  for (const size_t count : {1u, 2u, 4u, 5u, 12u, 13u}) {
    ContactSheet contacts(count, 6, 4);
    for (size_t i = 0; i < count; ++i)
      contacts.Add(Plain(6, 4, static_cast<uint8_t>(10 * i)));
    const viewer::Image& sheet = contacts.image();
    const size_t columns = sheet.width / 6;
    ASSERT_EQ(sheet.width % 6, 0u);
    ASSERT_EQ(sheet.height % 4, 0u);
    ASSERT_GE(columns * (sheet.height / 4), count);
    EXPECT_LT(columns * (sheet.height / 4), count + columns) << "an empty row";
    for (size_t i = 0; i < count; ++i) {
      for (const uint32_t corner : {0u, 1u}) {
        const auto x = static_cast<uint32_t>(i % columns * 6 + corner * 5);
        const auto y = static_cast<uint32_t>(i / columns * 4 + corner * 3);
        EXPECT_EQ(sheet.pixel(x, y)[0], 10 * i);
      }
    }
  }
}

TEST(ContactSheet, OfManyPictures_IsOfASizeThatOpensAnywhere) {
  constexpr size_t kCount = 1024;  // as many handles as there may be
  ContactSheet contacts(kCount, 257, 192);
  for (size_t i = 0; i < kCount; ++i)
    contacts.Add(Plain(257, 192, static_cast<uint8_t>(i % 251)));
  const viewer::Image& sheet = contacts.image();
  EXPECT_LE(std::max(sheet.width, sheet.height), 4096u);
  EXPECT_GE(std::max(sheet.width, sheet.height), 2048u) << "no smaller than it needs to be";
  const uint32_t width = sheet.width / 32, height = sheet.height / 32;
  for (uint32_t i = 0; i < kCount; ++i)
    EXPECT_EQ(sheet.pixel((i % 32) * width + width / 2, (i / 32) * height + height / 2)[0],
              i % 251);
}

TEST(DrawLegend, RunsAlongTheLowerEdgeAlone) {
  viewer::Image picture = Plain(100, 120, 7);
  viewer::Image legend = Plain(2, 1, 50);
  legend.rgba[4] = 200;  // the right half's red
  DrawLegend(legend, &picture);
  EXPECT_EQ(picture.pixel(0, 119)[0], 50);
  EXPECT_EQ(picture.pixel(49, 119)[0], 50);
  EXPECT_EQ(picture.pixel(50, 119)[0], 200);
  EXPECT_EQ(picture.pixel(99, 119)[0], 200);
  EXPECT_EQ(picture.pixel(50, 100)[0], 7);
  viewer::Image tiny = Plain(3, 2, 7);
  DrawLegend(legend, &tiny);
  EXPECT_EQ(tiny.pixel(0, 0)[0], 50);
}

}  // namespace
}  // namespace limber::inspect
