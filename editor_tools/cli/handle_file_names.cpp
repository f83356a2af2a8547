#include "cli/handle_file_names.h"

#include "core/vector.h"

#include <algorithm>
#include <set>

namespace limber::cli {
namespace {

constexpr size_t kLongest = 100;  // bytes, well below the 255 of most file systems

bool IsAscii(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

bool IsPlain(char c) {
  const bool is_digit = c >= '0' && c <= '9';
  const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  return !IsAscii(c) || is_digit || is_letter || c == '-' || c == '.';
}

// The bytes of a UTF-8 character after its first.
bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

std::string Plain(std::string name) {
  if (name.size() > kLongest) {
    size_t end = kLongest;
    while (end > 0 && IsContinuation(name[end]))
      --end;
    name.resize(end);
  }
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !IsPlain(c); }, '_');
  return name;
}

std::string LowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

}  // namespace

Vector<std::string> HandleFileNames(const Vector<RigHandle>& handles) {
  std::set<std::string> taken;
  Vector<std::string> names;
  for (size_t h = 0; h < handles.size(); ++h) {
    std::string name = Plain(std::string(handles[h].name));
    while (!taken.insert(LowerCase(name)).second)
      name += "_" + std::to_string(h);
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace limber::cli
