// Makes text that came from a file (names, URIs, a library's words about it) fit to stand in a
// message: one line, of bounded length, that no terminal obeys.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace limber {

inline constexpr size_t kLongestPrintable = 80;  // bytes

// The text with control characters (also those of Unicode: C1, line separators, marks that reverse
// the direction of writing), backslashes and bytes that are not UTF-8 as C escapes ("\n", "\x1B"),
// cut before it exceeds `most` bytes; "..." then follows.
std::string Printable(std::string_view text, size_t most = kLongestPrintable);

// The same between double quotes, with quotes inside escaped.
std::string Quoted(std::string_view text, size_t most = kLongestPrintable);

}  // namespace limber
