// Counts of something that happens to robots of many carries at once (bits.hpp).
#pragma once

#include "palmbots/bits.hpp"
#include "palmbots/registers.hpp"

namespace palmbots {

// A number below 256 of each of 64.
class ByteRow {
 public:
  std::uint32_t of(std::size_t i) const { return rows_[i / width][i % width]; }

  // Adds one to those whose bit is set.
  void count(Bits which) {
    for (std::size_t j = 0; j < parts; ++j) rows_[j] -= where(which, j);
  }
  // Makes them 0.
  void clear(Bits which) {
    for (std::size_t j = 0; j < parts; ++j) rows_[j] &= ~where(which, j);
  }

 private:
  static constexpr std::size_t width = register_bytes;
  static constexpr std::size_t parts = 64 / width;
  typedef std::uint8_t Row __attribute__((vector_size(width)));
  typedef Bits Words __attribute__((vector_size(width)));

  // All bits of the bytes of part j whose bit is set.
  static Row where(Bits which, std::size_t j) {
    const Bits own = which >> width * j % 64;
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      const Row bit = {(1 << k % 8)...};
      return (Row)((eightfold(own) & bit) == bit);
    }(std::make_index_sequence<width>());
  }

  // Every byte of a word eight times, as many as there is room for.
#if defined(__SSSE3__)
  static Row eightfold(Bits word) {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      const Row bytes = (Row)(Words{} + word);
      return __builtin_shufflevector(bytes, bytes, (k / 16 * 16 + k / 8)...);
    }(std::make_index_sequence<width>());
  }
#else
  static Row eightfold(Bits word) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
      return (Row)Words{((word >> 8 * i & 0xFF) * 0x0101010101010101)...};
    }(std::make_index_sequence<width / 8>());
  }
#endif

  std::array<Row, parts> rows_{};
};

// Counts something of each robot.
class BitCounts {
 public:
  void add(BothBits which) {
    for (const std::size_t side : {left, right}) recent_[side].count(which[side]);
    if (++adds_ == 255) collect();
  }

  // Begins anew.
  void clear(BothBits which) {
    for (const std::size_t side : {left, right}) recent_[side].clear(which[side]);
    const BothBits large = large_ & which;
    if (either(large) == 0) [[likely]]
      return;
    for (const std::size_t side : {left, right}) {
      each_bit(large[side], [&](int i) { before_[side][static_cast<std::size_t>(i)] = 0; });
    }
    large_ &= ~large;
  }

  std::uint32_t of(std::size_t side, int i) const {
    const auto place = static_cast<std::size_t>(i);
    return before_[side][place] + recent_[side].of(place);
  }

 private:
  // Before a number of a row is full.
  [[gnu::noinline]] void collect() {
    adds_ = 0;
    large_ = BothBits{};
    for (const std::size_t side : {left, right}) {
      for (std::size_t i = 0; i < 64; ++i) {
        before_[side][i] += recent_[side].of(i);
        large_[side] |= Bits{before_[side][i] != 0} << i;
      }
      recent_[side] = {};
    }
  }

  PerSide<ByteRow> recent_{};
  PerSide<std::array<std::uint32_t, 64>> before_{};
  BothBits large_{};        // of whom `before_` is not 0
  std::uint32_t adds_ = 0;  // since `recent_` was 0
};

// What two robots have sent to each other.
inline void tell_links(int i, const BitCounts& sent, const BitCounts& lost, Traffic& traffic) {
  traffic.sent = 0;
  traffic.lost = 0;
  for (const std::size_t side : {left, right}) {
    LinkCounts& link = traffic.links[side];
    traffic.sent += link.sent = sent.of(side, i);
    traffic.lost += link.lost = lost.of(side, i);
  }
}

}  // namespace palmbots
