// SPDX-License-Identifier: Apache-2.0
// Truth values of many carries at once: a bit a carry, or a bit a robot.
//
// What a team does in every tick is done here for sixty-four of them by operations on words,
// without a branch. Bit i of a word tells of carry i.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/side.hpp"

namespace palmbots {

// A truth value of each of 64 carries.
using CarryMask = std::uint64_t;

// The same of their left robots, [left], and of their right ones, [right].
typedef CarryMask RobotMask __attribute__((vector_size(2 * sizeof(CarryMask))));

inline RobotMask both_at(int i) { return RobotMask{} + (CarryMask{1} << i); }
inline CarryMask either(RobotMask words) { return words[left] | words[right]; }
// Those of the partners.
inline RobotMask swapped(RobotMask words) { return RobotMask{words[right], words[left]}; }

// Calls visit(i) for every bit set.
template <class Visit>
void for_each_bit(CarryMask bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

// A number of each robot, from 0 to `most`; what would be more stays `most`.
class BitslicedCounter {
 public:
  static constexpr std::uint32_t most = 255;

  void assign(RobotMask whose, std::uint32_t value) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (value >> k & 1) != 0 ? planes_[k] | whose : planes_[k] & ~whose;
    }
  }
  void assign(RobotMask whose, const BitslicedCounter& values) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (planes_[k] & ~whose) | (values.planes_[k] & whose);
    }
  }

  // One more for everybody.
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

  // Whose number is no less than that one's.
  RobotMask at_least(const BitslicedCounter& that) const {
    RobotMask found = ~RobotMask{};
    for (std::size_t k = 0; k < planes; ++k) {
      found = (planes_[k] & ~that.planes_[k]) | ((planes_[k] | ~that.planes_[k]) & found);
    }
    return found;
  }

  // Those of the partners.
  BitslicedCounter swapped() const {
    BitslicedCounter found;
    for (std::size_t k = 0; k < planes; ++k) found.planes_[k] = palmbots::swapped(planes_[k]);
    return found;
  }

 private:
  static constexpr std::size_t planes = 8;
  std::array<RobotMask, planes> planes_{};
};

// A count of each robot, as control/lease_state.hpp needs it: time passes tick by tick.
[[gnu::always_inline]] inline void advance(BitslicedCounter& since, std::uint16_t,
                                           const BitslicedCounter&) {
  since.increment();
}
[[gnu::always_inline]] inline void reset_where(BitslicedCounter& since, RobotMask whose) {
  since.assign(whose, 0);
}
[[gnu::always_inline]] inline RobotMask at_least(const BitslicedCounter& since,
                                                 const BitslicedCounter& least) {
  return since.at_least(least);
}

}  // namespace palmbots
