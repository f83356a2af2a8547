// Turns the exceptions of failed allocations into a Status, around work that allocates by amounts
// that a file or a caller names.
#pragma once

#include "core/status.h"

#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace limber {

// kOutOfMemory; "context: " is in front of the message unless it is empty. Throws nothing.
Status OutOfMemory(std::string_view context);

// What `work()` returns, a Status or a Result; kOutOfMemory when an allocation failed in it, or
// asked for more than a container can ever hold. Other exceptions pass.
template <class Work>
auto CatchOutOfMemory(std::string_view context, Work&& work) -> decltype(work()) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::bad_alloc&) {
    return OutOfMemory(context);
  } catch (const std::length_error&) {
    return OutOfMemory(context);
  }
}

}  // namespace limber
