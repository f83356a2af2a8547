// Vectors and strings whose memory comes from the source of the moment (core/memory_source.h): what
// the runtime keeps is made of them.
#pragma once

#include "core/memory_source.h"

#include <string>
#include <vector>

namespace limber {

template <class T>
using Vector = std::vector<T, Allocator<T>>;

using String = std::basic_string<char, std::char_traits<char>, Allocator<char>>;

}  // namespace limber
