// Handles may be called anything; their files may not.
#include "cli/handle_file_names.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <set>

namespace limber::cli {
namespace {

Vector<std::string> NamesFor(const Vector<std::string>& handles) {
  Vector<RigHandle> rig_handles;
  for (const std::string& name : handles)
    rig_handles.emplace_back().name = name;
  return HandleFileNames(rig_handles);
}

TEST(HandleFileNames, PlainNamesStay) {
  const Vector<std::string> plain = {"tail_tip", "Foot.L", "ear-2", "sch\u00f6n"};
  EXPECT_EQ(NamesFor(plain), plain);
}

TEST(HandleFileNames, NoNameLeavesTheFolder) {
  for (const std::string& name : NamesFor({"../../etc/x", "a\\b", "c:d", "line\nbreak", "a*?"}))
    EXPECT_EQ(name.find_first_of("/\\:\n*?"), std::string::npos) << name;
}

TEST(HandleFileNames, NoTwoAreTheSame_InAnyCase) {
  const auto names = NamesFor({"a b", "a_b", "A_B", "a_b_1", "a/b", "", ""});
  std::set<std::string> different;
  for (std::string name : names) {
    for (char& c : name)
      c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    different.insert(name);
  }
  EXPECT_EQ(different.size(), names.size());
}

TEST(HandleFileNames, LongNamesAreCutBetweenCharacters) {
  std::string umlauts;
  for (int i = 0; i < 300; ++i)
    umlauts += "\u00e4";
  const auto names = NamesFor({"x" + umlauts, umlauts, umlauts});
  for (const std::string& name : names) {
    EXPECT_GE(name.size(), 90u);
    EXPECT_LE(name.size(), 110u);
  }
  EXPECT_EQ(names[0].size() % 2, 1u) << "one byte and whole characters of two";
  EXPECT_EQ(names[1].size() % 2, 0u);
}

}  // namespace
}  // namespace limber::cli
