// Accessors: every layout that glTF allows, and every way to leave the buffer.
#include "core/vector.h"
#include "load/gltf_accessor.h"
#include "runtime/load/small_gltf.h"

#include <gtest/gtest.h>

#include <limits>

namespace limber::test {
namespace {

using Floats = Vector<float>;
using Json = nlohmann::ordered_json;

Result<Floats> Read(const SmallGltf& gltf, size_t accessor, int components,
                    int64_t expected_count = -1) {
  const auto file = gltf.Parse();
  if (!file.ok()) return file.status();
  AccessorRequest request{static_cast<int>(accessor), components, "place", expected_count};
  return ReadFloats(*file, request);
}

void ExpectFloats(const Result<Floats>& read, const Floats& expected) {
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(*read, expected);
}

TEST(Accessor, StridedVectors_SkipWhatLiesBetween) {
  SmallGltf gltf;
  const size_t view = gltf.AddView<float>({9, 1, 2, 9, 3, 4, 9, 5, 6}, 12);
  const size_t accessor = gltf.AddAccessor({{"bufferView", view},
                                            {"byteOffset", 4},
                                            {"componentType", 5126},
                                            {"count", 3},
                                            {"type", "VEC2"}});
  ExpectFloats(Read(gltf, accessor, 2), {1, 2, 3, 4, 5, 6});
}

TEST(Accessor, NormalisedIntegers_CoverTheirRange) {
  SmallGltf gltf;
  const auto add = [&gltf](size_t view, int type, int count, bool normalised) {
    return gltf.AddAccessor({{"bufferView", view},
                             {"componentType", type},
                             {"count", count},
                             {"type", "SCALAR"},
                             {"normalized", normalised}});
  };
  ExpectFloats(Read(gltf, add(gltf.AddView<int8_t>({-128, -127, 0, 127}), 5120, 4, true), 1),
               {-1, -1, 0, 1});
  ExpectFloats(Read(gltf, add(gltf.AddView<uint8_t>({0, 51, 255}), 5121, 3, true), 1),
               {0, 0.2f, 1});
  ExpectFloats(Read(gltf, add(gltf.AddView<int16_t>({-32768, 0, 32767}), 5122, 3, true), 1),
               {-1, 0, 1});
  ExpectFloats(Read(gltf, add(gltf.AddView<uint16_t>({0, 65535}), 5123, 2, true), 1), {0, 1});
  ExpectFloats(Read(gltf, add(gltf.AddView<int16_t>({-32768, 7}), 5122, 2, false), 1), {-32768, 7});
}

TEST(Accessor, Sparse_ReplacesElementsOfABaseOrOfZeros) {
  SmallGltf gltf;
  const size_t indices = gltf.AddView<uint16_t>({1, 3});
  const size_t values = gltf.AddView<float>({10, 30});
  const Json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}};
  const size_t base = gltf.AddView<float>({1, 2, 3, 4});
  const size_t over_base = gltf.AddAccessor({{"bufferView", base},
                                             {"componentType", 5126},
                                             {"count", 4},
                                             {"type", "SCALAR"},
                                             {"sparse", sparse}});
  const size_t over_zeros = gltf.AddAccessor(
      {{"componentType", 5126}, {"count", 4}, {"type", "SCALAR"}, {"sparse", sparse}});
  const size_t only_zeros =
      gltf.AddAccessor({{"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
  ExpectFloats(Read(gltf, over_base, 1), {1, 10, 3, 30});
  ExpectFloats(Read(gltf, over_zeros, 1), {0, 10, 0, 30});
  ExpectFloats(Read(gltf, only_zeros, 3), {0, 0, 0, 0, 0, 0});
}

TEST(Accessor, SparseIndexOutOfRange_IsNamed) {
  SmallGltf gltf;
  const size_t indices = gltf.AddView<uint8_t>({4});
  const size_t accessor =
      gltf.AddAccessor({{"componentType", 5126},
                        {"count", 4},
                        {"type", "SCALAR"},
                        {"sparse",
                         {{"count", 1},
                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                          {"values", {{"bufferView", 0}}}}}});
  const auto read = Read(gltf, accessor, 1);
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.status().message().find("sparse index 0 is 4"), std::string::npos)
      << read.status().message();
}

TEST(Accessor, OneElementTooMany_IsRefusedInEveryLayout) {
  for (const int stride : {0, 12, 16, 252}) {
    for (const int offset : {0, 4}) {
      SmallGltf gltf;
      const size_t view =
          gltf.AddView<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, static_cast<size_t>(stride));
      const int step = stride == 0 ? 12 : stride;
      const int fits = 1 + (48 - offset - 12) / step;
      Json accessor = {{"bufferView", view},
                       {"byteOffset", offset},
                       {"componentType", 5126},
                       {"count", fits},
                       {"type", "VEC3"}};
      const size_t good = gltf.AddAccessor(accessor);
      accessor["count"] = fits + 1;
      const size_t bad = gltf.AddAccessor(accessor);
      EXPECT_TRUE(Read(gltf, good, 3).ok()) << stride << " " << offset;
      EXPECT_EQ(Read(gltf, bad, 3).status().code(), StatusCode::kMalformed)
          << stride << " " << offset;
    }
  }
}

TEST(Accessor, NotFinite_NamesAccessorAndElement) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    SmallGltf gltf;
    const size_t view = gltf.AddView<float>({0, 1, 2, 3, bad, 5});
    const size_t accessor = gltf.AddAccessor(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
    const auto read = Read(gltf, accessor, 2);
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.status().message(), "place (accessor 3): element 2 is not a finite number");
  }
}

TEST(Accessor, WrongTypeOrCount_IsRefused) {
  const SmallGltf gltf;
  EXPECT_FALSE(Read(gltf, 0, 4).ok());
  EXPECT_FALSE(Read(gltf, 0, 3, 4).ok());
  EXPECT_TRUE(Read(gltf, 0, 3, 3).ok());
  EXPECT_FALSE(Read(gltf, 99, 3).ok());
  EXPECT_FALSE(Read(gltf, static_cast<size_t>(-1), 3).ok());
}

TEST(Accessor, ZerosFromNothing_AreLimited) {
  SmallGltf gltf;
  const size_t accessor =
      gltf.AddAccessor({{"componentType", 5126}, {"count", 2147483647}, {"type", "VEC4"}});
  EXPECT_EQ(Read(gltf, accessor, 4).status().code(), StatusCode::kLimitExceeded);
}

TEST(Accessor, Indices_MustStayBelowTheBound) {
  const SmallGltf gltf;
  const auto file = gltf.Parse();
  ASSERT_TRUE(file.ok());
  const AccessorRequest request{2, 1, "indices"};
  const auto good = ReadIndices(*file, request, 3);
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, (Vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(ReadIndices(*file, request, 2).status().message(),
            "indices (accessor 2): element 2 is 2, allowed is below 2");
  EXPECT_FALSE(ReadIndices(*file, {0, 1, "floats"}, 3).ok());
}

}  // namespace
}  // namespace limber::test
