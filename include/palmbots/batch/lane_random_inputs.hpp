// SPDX-License-Identifier: Apache-2.0
// Inputs of the random draws for several carries side by side.
#pragma once

#include <cstring>
#include <utility>

#include "palmbots/base/philox.hpp"

namespace palmbots {

// The inputs for n carries side by side.
template <int n>
struct LaneRandomInputs {
  std::array<std::uint64_t, n> seed;
  std::array<std::uint64_t, n> start;       // the tick at which the carry began
  std::array<std::uint64_t, n> left_leads;  // all bits: the left robot leads; none: the right one
  std::array<double, n> false_words;        // threshold of false readings
  std::array<double, n> loss_words;         // threshold of lost messages

  // The number of words in one draw, and in one part of a row.
  static constexpr std::size_t width = detail::draws_at_once;
  static constexpr std::size_t parts = n / width;
  static_assert(n % width == 0);

  static detail::Halves part(const std::array<std::uint64_t, n>& row, std::size_t p) {
    detail::Halves found;
    std::memcpy(&found, row.data() + p * width, sizeof found);
    return found;
  }

  std::uint32_t lanes_in_which_left_leads() const {
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < n; ++l) bits |= (left_leads[l] != 0 ? 1U : 0U) << l;
    return bits;
  }

  // The words of several ticks, in every lane.
  template <std::size_t ticks>
  class RandomBlock {
   public:
    explicit RandomBlock(const std::array<detail::Draws, ticks * parts>& words) : words_(words) {}

    // One of the words of a tick, for one part of the lanes. Its upper half is meaningless.
    detail::Halves word(std::size_t tick, std::size_t p, std::size_t which) const {
      return words_[tick * parts + p][which];
    }

   private:
    std::array<detail::Draws, ticks * parts> words_;
  };

  // Draws of a stream, from one of the stream's lanes, for several ticks that are `apart` from each
  // other, in all SIMD lanes. The draws are interleaved, so that none waits for another.
  template <std::size_t ticks>
  class LaneDraws {
   public:
    LaneDraws(const LaneRandomInputs& inputs, std::uint32_t stream, std::uint32_t lane,
              std::uint64_t first, std::uint64_t apart)
        : keys_(keys(inputs, std::make_index_sequence<parts>())),
          stream_(detail::Halves{} + stream),
          lane_(detail::Halves{} + lane),
          step_(ticks * apart) {
      for (std::size_t i = 0; i < ticks * parts; ++i) {
        tick_[i] = first + apart * (i / parts) - part(inputs.start, i % parts);
      }
    }

    [[gnu::always_inline]] RandomBlock<ticks> next() {
      std::array<detail::Draws, ticks * parts> counters;
      for (std::size_t i = 0; i < ticks * parts; ++i) {
        counters[i] = {tick_[i], stream_, lane_};
        tick_[i] += step_;
      }
      return RandomBlock<ticks>(detail::philox(counters, keys_));
    }

   private:
    template <std::size_t... p>
    static std::array<detail::Keys, parts> keys(const LaneRandomInputs& inputs,
                                                std::index_sequence<p...>) {
      return {detail::Keys(part(inputs.seed, p))...};
    }

    std::array<detail::Keys, parts> keys_;
    detail::Halves stream_;
    detail::Halves lane_;
    std::uint64_t step_;
    std::array<detail::Halves, ticks * parts> tick_;
  };

  // The number of interleaved draws, limited by the number of registers.
  static constexpr std::size_t in_turn = (width == 8 ? 4 : 2) / parts;
};

}  // namespace palmbots
