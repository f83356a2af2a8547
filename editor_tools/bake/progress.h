// How the long parts of a bake tell how far they are, and are told to stop.
#pragma once

#include <functional>

namespace limber::bake {

// Told before each stage and now and then within one; fraction runs from 0 to 1 over the whole.
// Returning false cancels: the call then ends with kInvalidArgument "cancelled".
using ProgressCallback = std::function<bool(const char* stage, double fraction)>;

}  // namespace limber::bake
