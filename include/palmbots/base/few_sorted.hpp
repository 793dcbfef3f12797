// SPDX-License-Identifier: Apache-2.0
// Sorts a few items by insertion. Equal ones keep their order, and no memory is needed. The sorts of
// the C++ library are faster for many, and take several kilobytes of code for each type.
#pragma once

#include <cstddef>
#include <utility>

namespace palmbots {

// By their rank: items with a lower one come first.
template <class Item, class Rank>
constexpr void sort_few(Item* items, std::size_t count, Rank rank) {
  for (std::size_t i = 1; i < count; ++i) {
    Item moved = std::move(items[i]);
    std::size_t at = i;
    for (; at > 0 && rank(moved) < rank(items[at - 1]); --at) items[at] = std::move(items[at - 1]);
    items[at] = std::move(moved);
  }
}

template <class Item>
constexpr void sort_few(Item* items, std::size_t count) {
  sort_few(items, count, [](const Item& item) -> const Item& { return item; });
}

}  // namespace palmbots
