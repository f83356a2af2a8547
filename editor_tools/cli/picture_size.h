// "WxH" on the command line.
#pragma once

#include <cstdint>
#include <string>

namespace limber::cli {

// Reads "1280x720", each side from 1 to 8192, into width and height and returns an empty string;
// else a message for a wrong command line, both left as they were.
std::string ParseSize(const std::string& text, uint32_t* width, uint32_t* height);

}  // namespace limber::cli
