// The packing of a baked file's tables: what comes back, what it takes, and what damage does.
#include "rig/packed_numbers.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace limber {
namespace {

using Numbers = Vector<float>;
using Bytes = Vector<uint8_t>;

Numbers Unpacked(const Bytes& bytes, size_t count, int exponent) {
  const auto numbers = UnpackNumbers(bytes, count, exponent);
  EXPECT_TRUE(numbers.ok()) << numbers.status().message();
  return numbers.ok() ? *numbers : Numbers();
}

StatusCode CodeOf(const Bytes& bytes, size_t count, int exponent) {
  return UnpackNumbers(bytes, count, exponent).status().code();
}

// Of very different sizes, with zeros, `count` of them.
Numbers MixedNumbers(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  Numbers numbers(count);
  for (float& x : numbers)
    x = random() % 4 == 0 ? 0.0f
                          : normal(random) * std::exp2(static_cast<float>(random() % 30) - 25);
  return numbers;
}

TEST(PackedNumbers, AreTheNearestMultiples) {
  for (const size_t count : {0, 1, 15, 16, 17, 1000}) {
    for (const int bits : {2, 12, 23, 30}) {
      const Numbers numbers = MixedNumbers(count, static_cast<unsigned>(count) + 7);
      const int exponent = PackingExponent(numbers, bits);
      const Numbers back = Unpacked(PackNumbers(numbers, exponent), count, exponent);
      ASSERT_EQ(back.size(), count);
      float largest = 0;
      for (size_t i = 0; i < count; ++i) {
        largest = std::max(largest, std::abs(numbers[i]));
        const double step = std::ldexp(1.0, exponent);
        const double nearest = std::round(static_cast<double>(numbers[i]) / step) * step;
        EXPECT_EQ(back[i], static_cast<float>(nearest)) << i;
      }
      if (count > 0) {
        EXPECT_LE(std::ldexp(1.0, exponent), std::ldexp(static_cast<double>(largest), 1 - bits));
      }
    }
  }
}

TEST(PackedNumbers, PackedAgain_ChangeNoByte) {
  const Numbers numbers = MixedNumbers(500, 3);
  const int exponent = PackingExponent(numbers, 21);
  const Bytes bytes = PackNumbers(numbers, exponent);
  EXPECT_EQ(PackNumbers(Unpacked(bytes, 500, exponent), exponent), bytes);
}

TEST(PackedNumbers, WholeNumbers_AreExact) {
  Numbers numbers;
  for (int i = -300; i < 300; ++i)
    numbers.push_back(static_cast<float>(i * i * i));
  EXPECT_EQ(Unpacked(PackNumbers(numbers, 0), numbers.size(), 0), numbers);
}

// The largest integers of either sign, and the largest of one beside the smallest.
TEST(PackedNumbers, Extremes_ComeBack) {
  const Numbers numbers = {0x1p30f, -0x1p30f, 0x1p30f - 64, 0, 1, -1, 0x1p30f};
  EXPECT_EQ(Unpacked(PackNumbers(numbers, 0), numbers.size(), 0), numbers);
  const Numbers large = {3e38f, -3e38f, 1e38f};
  const int exponent = PackingExponent(large, 24);
  const Numbers back = Unpacked(PackNumbers(large, exponent), 3, exponent);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(back[i] / large[i], 1, 0x1p-23);
}

// By hand, from the words of the header. The block 3, -1, 0 folds to 6, 1, 0, for which r = 1 is
// the shortest: 10000, then 1110 0, 0 1, 0 0, each bit the next higher one.
TEST(PackedNumbers, Bits_AreThoseOfTheFormat) {
  const Bytes bytes = PackNumbers(Numbers{3, -1, 0}, 0);
  EXPECT_EQ(bytes, (Bytes{0b11100001, 0b00001000}));
  EXPECT_EQ(PackNumbers(Numbers(16, 0.0f), 0), (Bytes{0b00011111}));
}

TEST(PackedNumbers, ZerosAndSmallNumbers_TakeLittle) {
  EXPECT_LE(PackNumbers(Numbers(1600, 0.0f), 0).size(), 63u);  // five bits a block
  Numbers numbers = MixedNumbers(1600, 5);
  numbers[0] = 100;
  const int exponent = PackingExponent(numbers, 23);
  std::fill(numbers.begin() + 16, numbers.end(), std::ldexp(1.0f, exponent));
  const size_t small_bits = 1584 * 3 + 1584 / 16 * 5;
  EXPECT_LE(PackNumbers(numbers, exponent).size(), 16 * 5 + small_bits / 8);
}

TEST(UnpackNumbers, WrongCounts_AreMalformed) {
  const Numbers numbers = MixedNumbers(100, 9);
  const int exponent = PackingExponent(numbers, 20);
  Bytes bytes = PackNumbers(numbers, exponent);
  EXPECT_EQ(CodeOf(bytes, 84, exponent), StatusCode::kMalformed) << "a block is left";
  EXPECT_EQ(CodeOf(bytes, 116, exponent), StatusCode::kMalformed) << "a block is missing";
  EXPECT_EQ(CodeOf(bytes, size_t{1} << 60, exponent), StatusCode::kMalformed);
  EXPECT_EQ(CodeOf({}, 1, 0), StatusCode::kMalformed);
  EXPECT_EQ(CodeOf(bytes, 100, kMostPackingExponent + 1), StatusCode::kMalformed);
  EXPECT_EQ(CodeOf(bytes, 100, kLeastPackingExponent - 1), StatusCode::kMalformed);
  bytes.push_back(0);
  EXPECT_EQ(CodeOf(bytes, 100, exponent), StatusCode::kMalformed) << "a byte too many";
  bytes.resize(bytes.size() - 2);
  EXPECT_EQ(CodeOf(bytes, 100, exponent), StatusCode::kMalformed) << "a byte too few";
}

// A unary number that never ends must not be believed: the integer would be out of range.
TEST(UnpackNumbers, NumbersOutOfRange_AreMalformed) {
  Bytes bytes(1 << 10, 0xff);
  bytes[0] = 0b11111110;  // r = 30
  const auto result = UnpackNumbers(bytes, 16, 0);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.status().message().find("out of range"), std::string::npos);
}

// Any bytes at all: numbers or one refusal, never a read beyond the end.
TEST(UnpackNumbers, AnyDamage_IsRefusedOrGivesFiniteNumbers) {
  std::mt19937 random(11);
  const Numbers numbers = MixedNumbers(200, 13);
  const Bytes good = PackNumbers(numbers, -20);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = good;
    for (int hits = 1 + static_cast<int>(random() % 4); hits > 0; --hits)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    const auto result = UnpackNumbers(bytes, 200, kMostPackingExponent);
    if (!result.ok()) {
      EXPECT_EQ(result.status().code(), StatusCode::kMalformed);
      ++refused;
      continue;
    }
    for (const float number : *result)
      ASSERT_TRUE(std::isfinite(number));
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace limber
