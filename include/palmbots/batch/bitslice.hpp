// SPDX-License-Identifier: Apache-2.0
// Bit slices: truth values and counts of 64 carries at once, with one bit for each carry or robot.
//
// The work that a team does in every tick is done here for 64 teams by operations on words, without
// a branch. Bit i of a word belongs to carry i.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/side.hpp"

namespace palmbots {

// A truth value for each of 64 carries.
using CarryMask = std::uint64_t;

// A truth value for each of their robots: [left] holds the left robots, [right] the right ones.
typedef CarryMask RobotMask __attribute__((vector_size(2 * sizeof(CarryMask))));

// Both robots of carry i, and the carries in which either robot's bit is set.
inline RobotMask both_at(int i) { return RobotMask{} + (CarryMask{1} << i); }
inline CarryMask either(RobotMask words) { return words[left] | words[right]; }
// The truth values of the partners.
inline RobotMask swapped(RobotMask words) { return RobotMask{words[right], words[left]}; }

// Calls visit(i) for every bit set.
template <class Visit>
void for_each_bit(CarryMask bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

// A count of so many bits for each robot, from 0 to `most`, at which it saturates.
template <std::size_t bits>
class BitslicedCount {
 public:
  static constexpr std::uint32_t most = (1U << bits) - 1;

  void assign(RobotMask whose, std::uint32_t value) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (value >> k & 1) != 0 ? planes_[k] | whose : planes_[k] & ~whose;
    }
  }
  void assign(RobotMask whose, const BitslicedCount& values) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (planes_[k] & ~whose) | (values.planes_[k] & whose);
    }
  }

  // Adds one to every count.
  void increment() {
    RobotMask full = planes_[0];
    for (std::size_t k = 1; k < planes; ++k) full &= planes_[k];
    RobotMask carry = ~full;
    for (RobotMask& plane : planes_) {
      const RobotMask before = plane;
      plane ^= carry;
      carry &= before;
    }
  }

  // True for the robots whose count is at least that of `that`: the highest plane in which the two
  // differ decides.
  RobotMask at_least(const BitslicedCount& that) const {
    RobotMask found = ~RobotMask{};
    for (std::size_t k = 0; k < planes; ++k) {
      found ^= (found ^ planes_[k]) & (planes_[k] ^ that.planes_[k]);
    }
    return found;
  }

  // The counts of the partners.
  BitslicedCount swapped() const {
    BitslicedCount found;
    for (std::size_t k = 0; k < planes; ++k) found.planes_[k] = palmbots::swapped(planes_[k]);
    return found;
  }

 private:
  static constexpr std::size_t planes = bits;
  std::array<RobotMask, planes> planes_{};
};

using BitslicedCounter = BitslicedCount<8>;

// The functions of counts that control/transition_table.hpp has for one robot. Time passes tick by
// tick.
[[gnu::always_inline]] inline void advance(BitslicedCounter& since, std::uint16_t,
                                           const BitslicedCounter&) {
  since.increment();
}
[[gnu::always_inline]] inline void reset_where(BitslicedCounter& since, RobotMask whose) {
  since.assign(whose, 0);
}
[[gnu::always_inline]] inline void exhaust_where(BitslicedCounter& since, RobotMask whose,
                                                 const BitslicedCounter&) {
  since.assign(whose, BitslicedCounter::most);
}
[[gnu::always_inline]] inline RobotMask at_least(const BitslicedCounter& since,
                                                 const BitslicedCounter& least) {
  return since.at_least(least);
}

}  // namespace palmbots
