// SPDX-License-Identifier: Apache-2.0
// Bit-sliced counters of events, for the robots of 64 carries at once (batch/bitslice.hpp).
#pragma once

#include "palmbots/base/simd_registers.hpp"
#include "palmbots/batch/bitslice.hpp"

namespace palmbots {

// 64 counts below 256.
class ByteCounters {
 public:
  std::uint32_t of(std::size_t i) const { return rows_[i / width][i % width]; }

  // Adds one to the counts whose bit is set.
  void count(CarryMask which) {
    for (std::size_t j = 0; j < parts; ++j) rows_[j] -= where(which, j);
  }
  // Resets the counts whose bit is set.
  void clear(CarryMask which) {
    for (std::size_t j = 0; j < parts; ++j) rows_[j] &= ~where(which, j);
  }

 private:
  static constexpr std::size_t width = register_bytes;
  static constexpr std::size_t parts = 64 / width;
  typedef std::uint8_t Row __attribute__((vector_size(width)));
  typedef CarryMask Words __attribute__((vector_size(width)));

  // The bytes of part j, each all ones if its bit is set and zero otherwise.
  static Row where(CarryMask which, std::size_t j) {
    const CarryMask own = which >> width * j % 64;
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      const Row bit = {(1 << k % 8)...};
      return (Row)((eightfold(own) & bit) == bit);
    }(std::make_index_sequence<width>());
  }

  // Every byte of a word repeated eight times, for as many bytes as fit into the register.
#if defined(__SSSE3__)
  static Row eightfold(CarryMask word) {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      const Row bytes = (Row)(Words{} + word);
      return __builtin_shufflevector(bytes, bytes, (k / 16 * 16 + k / 8)...);
    }(std::make_index_sequence<width>());
  }
#else
  static Row eightfold(CarryMask word) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
      return (Row)Words{((word >> 8 * i & 0xFF) * 0x0101010101010101)...};
    }(std::make_index_sequence<width / 8>());
  }
#endif

  std::array<Row, parts> rows_{};
};

// A count of events for each robot.
class BitslicedCounts {
 public:
  void add(RobotMask which) {
    for (const std::size_t side : {left, right}) recent_[side].count(which[side]);
    if (++adds_ == 255) collect();
  }

  // Resets the counts of these robots.
  void clear(RobotMask which) {
    for (const std::size_t side : {left, right}) recent_[side].clear(which[side]);
    const RobotMask large = large_ & which;
    if (either(large) == 0) [[likely]]
      return;
    for (const std::size_t side : {left, right}) {
      for_each_bit(large[side], [&](int i) { before_[side][static_cast<std::size_t>(i)] = 0; });
    }
    large_ &= ~large;
  }

  std::uint32_t of(std::size_t side, int i) const {
    const auto place = static_cast<std::size_t>(i);
    return before_[side][place] + recent_[side].of(place);
  }

 private:
  // Empties the byte counters before one of them overflows.
  [[gnu::noinline]] void collect() {
    adds_ = 0;
    large_ = RobotMask{};
    for (const std::size_t side : {left, right}) {
      for (std::size_t i = 0; i < 64; ++i) {
        before_[side][i] += recent_[side].of(i);
        large_[side] |= CarryMask{before_[side][i] != 0} << i;
      }
      recent_[side] = {};
    }
  }

  PerSide<ByteCounters> recent_{};
  PerSide<std::array<std::uint32_t, 64>> before_{};
  RobotMask large_{};       // robots with `before_` ≠ 0
  std::uint32_t adds_ = 0;  // since `recent_` was reset
};

}  // namespace palmbots
