// Vulkan's way of listing things: asked once how many there are, and once more for them.
#pragma once

#include "core/vector.h"

#include <volk.h>

#include <cstdint>
#include <type_traits>

namespace limber::viewer {

// `ask(uint32_t* count, Item* items)` is one of Vulkan's listing functions; one that returns
// nothing counts as a success. What it says at last: VK_SUCCESS, VK_INCOMPLETE where the list grew
// in between (what was there is in `items`), or an error.
template <class Item, class Ask>
VkResult ListAll(const Ask& ask, Vector<Item>* items) {
  const auto call = [&ask](uint32_t* count, Item* out) {
    if constexpr (std::is_void_v<decltype(ask(count, out))>) {
      ask(count, out);
      return VK_SUCCESS;
    } else {
      return ask(count, out);
    }
  };
  uint32_t count = 0;
  VkResult result = call(&count, nullptr);
  items->resize(result == VK_SUCCESS ? count : 0);
  if (items->empty()) return result;
  result = call(&count, items->data());
  items->resize(result >= 0 ? count : 0);
  return result;
}

}  // namespace limber::viewer
