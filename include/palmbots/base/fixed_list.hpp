// SPDX-License-Identifier: Apache-2.0
// A list of a few items, stored in place: no memory is allocated.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <memory>

namespace palmbots {

// At most `most` items. The places behind them are neither initialized nor copied, so that a list
// costs what is in it.
template <class Item, std::size_t most>
class FixedList {
 public:
  static constexpr std::size_t capacity = most;

  constexpr FixedList() {}  // not defaulted: `{}` would initialize all places
  constexpr FixedList(std::initializer_list<Item> items) {
    for (const Item& item : items) push_back(item);
  }
  constexpr FixedList(const FixedList& other) { *this = other; }
  constexpr FixedList& operator=(const FixedList& other) {
    std::uninitialized_copy(other.begin(), other.end(), items_);
    size_ = other.size_;
    return *this;
  }

  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == most; }
  constexpr Item& operator[](std::size_t i) { return items_[i]; }
  constexpr const Item& operator[](std::size_t i) const { return items_[i]; }
  constexpr Item* begin() { return items_; }
  constexpr Item* end() { return items_ + size_; }
  constexpr const Item* begin() const { return items_; }
  constexpr const Item* end() const { return items_ + size_; }

  constexpr bool contains(const Item& item) const {
    return std::find(begin(), end(), item) != end();
  }

  constexpr void push_back(const Item& item) { std::construct_at(items_ + size_++, item); }
  // Only the first ones.
  constexpr void keep(std::size_t size) { size_ = size; }
  constexpr void clear() { size_ = 0; }

 private:
  union {
    Item items_[most];  // in a union, so that it is not initialized
  };
  std::size_t size_ = 0;
};

}  // namespace palmbots
