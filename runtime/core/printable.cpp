#include "core/printable.h"

#include <cstdint>

namespace limber {
namespace {

// Number of bytes of the UTF-8 character that the text begins with, and its code point; 0 where it
// is none (RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF).
size_t DecodeUtf8(std::string_view text, uint32_t* code_point) {
  static constexpr uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const auto lead = static_cast<uint8_t>(text[0]);
  const size_t length = lead < 0x80             ? 1
                        : (lead & 0xE0) == 0xC0 ? 2
                        : (lead & 0xF0) == 0xE0 ? 3
                        : (lead & 0xF8) == 0xF0 ? 4
                                                : 0;
  if (length == 0 || length > text.size()) return 0;
  *code_point = length == 1 ? lead : lead & (0x7Fu >> length);
  for (size_t i = 1; i < length; ++i) {
    const auto next = static_cast<uint8_t>(text[i]);
    if ((next & 0xC0) != 0x80) return 0;
    *code_point = *code_point << 6 | (next & 0x3Fu);
  }
  const bool surrogate = *code_point >= 0xD800 && *code_point < 0xE000;
  return *code_point < kSmallest[length] || *code_point > 0x10FFFF || surrogate ? 0 : length;
}

// Controls, line and paragraph separators, marks of direction.
bool IsControl(uint32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x61C || c == 0x200E || c == 0x200F ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

std::string Escaped(uint8_t byte) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  switch (byte) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    case '\\':
      return "\\\\";
    case '"':
      return "\\\"";
    default:
      return {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
  }
}

std::string Escape(std::string_view text, size_t most, bool escape_quotes) {
  std::string shown;
  while (!text.empty()) {
    uint32_t code_point = 0;
    const size_t decoded = DecodeUtf8(text, &code_point);
    const size_t length = decoded == 0 ? 1 : decoded;
    const bool plain = decoded > 0 && !IsControl(code_point) && code_point != '\\' &&
                       !(escape_quotes && code_point == '"');
    std::string piece;
    for (const char byte : text.substr(0, length))
      piece += plain ? std::string(1, byte) : Escaped(static_cast<uint8_t>(byte));
    if (shown.size() + piece.size() > most) return shown + "...";
    shown += piece;
    text.remove_prefix(length);
  }
  return shown;
}

}  // namespace

std::string Printable(std::string_view text, size_t most) {
  return Escape(text, most, false);
}

std::string Quoted(std::string_view text, size_t most) {
  return '"' + Escape(text, most, true) + '"';
}

}  // namespace limber
