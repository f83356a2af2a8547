#include "core/status.h"

#include "core/out_of_memory.h"
#include "core/vector.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>

namespace limber {
namespace {

TEST(Status, EveryCode_HasANameOfItsOwn) {
  std::set<std::string> names;
  constexpr int kNumCodes = static_cast<int>(StatusCode::kInternal) + 1;
  for (int code = 0; code < kNumCodes; ++code)
    names.insert(StatusCodeName(static_cast<StatusCode>(code)));
  EXPECT_EQ(names.size(), static_cast<size_t>(kNumCodes));
  EXPECT_EQ(names.count("unknown"), 0u);
}

TEST(Status, Context_GoesInFrontOfFailuresOnly) {
  const Status failure = Error(StatusCode::kMalformed, "element %d", 7).WithContext("file");
  EXPECT_EQ(failure.message(), "file: element 7");
  EXPECT_EQ(failure.code(), StatusCode::kMalformed);
  EXPECT_TRUE(Status().WithContext("file").ok());
}

TEST(CatchOutOfMemory, FailedAllocations_BecomeAStatus) {
  const Status too_much = CatchOutOfMemory("thing", []() -> Status { throw std::bad_alloc(); });
  EXPECT_EQ(too_much.code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(too_much.message().rfind("thing: ", 0), 0u) << too_much.message();
  const Result<Vector<double>> too_long = CatchOutOfMemory("", []() -> Result<Vector<double>> {
    return Vector<double>(Vector<double>().max_size() + 1);
  });
  EXPECT_EQ(too_long.status().code(), StatusCode::kOutOfMemory);
}

TEST(CatchOutOfMemory, OtherResults_Pass) {
  EXPECT_EQ(*CatchOutOfMemory("", []() -> Result<int> { return 3; }), 3);
  const auto failing = []() -> Result<int> { return Error(StatusCode::kNotFound, "no"); };
  EXPECT_EQ(CatchOutOfMemory("", failing).status().message(), "no");
  bool passed = false;
  try {
    (void)CatchOutOfMemory("", []() -> Status { throw std::runtime_error("bug"); });
  } catch (const std::runtime_error&) {
    passed = true;
  }
  EXPECT_TRUE(passed) << "a bug is no shortage of memory";
}

}  // namespace
}  // namespace limber
