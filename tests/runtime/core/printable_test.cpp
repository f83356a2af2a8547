#include "core/printable.h"

#include <gtest/gtest.h>

namespace limber {
namespace {

TEST(Printable, OrdinaryText_StaysAsItIs) {
  for (const char* text :
       {"", "left hand", "a'b", "\"quoted\"", "\xC3\xA4 \xE6\x89\x8B \xF0\x9F\x90\xB4"})
    EXPECT_EQ(Printable(text), text);
  EXPECT_EQ(Quoted("hand"), "\"hand\"");
}

TEST(Printable, ControlCharacters_AreEscaped) {
  EXPECT_EQ(Printable("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(Printable("\x1B[2J\x7F"), "\\x1B[2J\\x7F") << "a terminal's escape";
  EXPECT_EQ(Printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(Printable("\xC2\x85"), "\\xC2\\x85") << "C1: next line";
  EXPECT_EQ(Printable("\xE2\x80\xA8"), "\\xE2\\x80\\xA8") << "U+2028, line separator";
  EXPECT_EQ(Printable("\xE2\x80\xAE"
                      "fdp.exe"),
            "\\xE2\\x80\\xAE"
            "fdp.exe")
      << "U+202E, right to left from here";
  EXPECT_EQ(Printable("a\\nb"), "a\\\\nb") << "no text looks like an escaped other one";
}

TEST(Printable, WhatIsNotUtf8_IsEscapedByteByByte) {
  EXPECT_EQ(Printable("\xFFz"), "\\xFFz");
  EXPECT_EQ(Printable("\xC3"), "\\xC3") << "cut short";
  EXPECT_EQ(Printable("\xC0\xAF"), "\\xC0\\xAF") << "an overlong slash";
  EXPECT_EQ(Printable("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "a surrogate";
  EXPECT_EQ(Printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80") << "above U+10FFFF";
}

TEST(Printable, LongText_IsCutBetweenCharacters) {
  EXPECT_EQ(Printable(std::string(80, 'a')), std::string(80, 'a'));
  EXPECT_EQ(Printable(std::string(81, 'a')), std::string(80, 'a').append("..."));
  EXPECT_EQ(Printable("abc\xC3\xA4", 4), "abc...");
  EXPECT_EQ(Printable("abc\n", 4), "abc...") << "nor within an escape";
  EXPECT_LT(Quoted(std::string(1 << 20, '"')).size(), kLongestPrintable + 6);
}

TEST(Quoted, QuotesInside_CannotEndIt) {
  EXPECT_EQ(Quoted("a\"; rm"), "\"a\\\"; rm\"");
  EXPECT_EQ(Quoted("a\\"), "\"a\\\\\"");
}

}  // namespace
}  // namespace limber
