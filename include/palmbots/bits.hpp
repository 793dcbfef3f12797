// Truth values of many carries at once: a bit a carry, or a bit a robot.
//
// What a team does in every tick is done here for sixty-four of them by operations on words, without a
// branch. Bit i of a word tells of carry i.
#pragma once

#include <bit>
#include <utility>

#include "palmbots/metrics.hpp"

namespace palmbots {

// A truth value of each of 64 carries.
using Bits = std::uint64_t;

// The same of their left robots, [left], and of their right ones, [right].
typedef Bits BothBits __attribute__((vector_size(2 * sizeof(Bits))));

inline BothBits both_at(int i) { return BothBits{} + (Bits{1} << i); }
inline Bits either(BothBits words) { return words[left] | words[right]; }
// Those of the partners.
inline BothBits swapped(BothBits words) { return BothBits{words[right], words[left]}; }

// Calls visit(i) for every bit set.
template <class Visit>
void each_bit(Bits bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

// A number of each robot, from 0 to `most`; what would be more stays `most`.
class NumberBits {
 public:
  static constexpr std::uint32_t most = 255;

  void put(BothBits whose, std::uint32_t value) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (value >> k & 1) != 0 ? planes_[k] | whose : planes_[k] & ~whose;
    }
  }
  void put(BothBits whose, const NumberBits& values) {
    for (std::size_t k = 0; k < planes; ++k) {
      planes_[k] = (planes_[k] & ~whose) | (values.planes_[k] & whose);
    }
  }

  // One more for everybody.
  void count() {
    BothBits full = planes_[0];
    for (std::size_t k = 1; k < planes; ++k) full &= planes_[k];
    BothBits carry = ~full;
    for (BothBits& plane : planes_) {
      const BothBits before = plane;
      plane ^= carry;
      carry &= before;
    }
  }

  // Whose number is no less than that one's.
  BothBits at_least(const NumberBits& that) const {
    BothBits found = ~BothBits{};
    for (std::size_t k = 0; k < planes; ++k) {
      found = (planes_[k] & ~that.planes_[k]) | ((planes_[k] | ~that.planes_[k]) & found);
    }
    return found;
  }

  // Those of the partners.
  NumberBits swapped() const {
    NumberBits found;
    for (std::size_t k = 0; k < planes; ++k) found.planes_[k] = palmbots::swapped(planes_[k]);
    return found;
  }

 private:
  static constexpr std::size_t planes = 8;
  std::array<BothBits, planes> planes_{};
};

// What robots sense, and what they are told.
struct SensedBits {
  BothBits positive{};
  BothBits negative{};
  BothBits turned{};

  SensedBits& operator|=(const SensedBits& more) {
    positive |= more.positive;
    negative |= more.negative;
    turned |= more.turned;
    return *this;
  }

  // Signs that are false: the next one is read, of −, 0, +, −, …, if that is so once; else the one after.
  void falsify(BothBits wrong, BothBits once) {
    const BothBits zero = ~(positive | negative);
    const BothBits then_positive = (once & zero) | (~once & negative);
    const BothBits then_negative = (once & positive) | (~once & zero);
    positive = (positive & ~wrong) | (then_positive & wrong);
    negative = (negative & ~wrong) | (then_negative & wrong);
  }
};

// Whose program does not run, which leaves its robot at rest; and whose runs for the first time since.
struct HostBits {
  BothBits off{};
  BothBits boots{};
};

// Whose messages are lost if they are sent now: those of the robots, and those of the station to them.
struct LossBits {
  BothBits from_robot{};
  BothBits from_station{};
};

struct CommandBits {
  BothBits shallow{};  // otherwise steep
  BothBits away{};
  BothBits closer{};  // otherwise hold
  BothBits rest{};

  void remove(BothBits whose) {
    for (BothBits* one : {&shallow, &away, &closer, &rest}) *one &= ~whose;
  }
  // As switched_off().
  void switch_off(BothBits whose) {
    away &= ~whose;
    closer &= ~whose;
    rest |= whose;
  }
  // The carries in which they are others.
  Bits differ(const CommandBits& than) const {
    return either((shallow ^ than.shallow) | (away ^ than.away) | (closer ^ than.closer) |
                  (rest ^ than.rest));
  }
};

// How long the messages of each carry take, where they all take the same time.
class DelayBits {
 public:
  // May be that long [ticks].
  static constexpr std::uint32_t longest = 63;
  static constexpr bool take(std::uint32_t delay) { return delay > 0 && delay <= longest; }

  void put(int i, std::uint32_t delay) {
    of_[delay] |= both_at(i);
    there_are_ |= Bits{1} << delay;
  }
  void remove(int i) {
    for (std::uint32_t d = 0; d <= longest; ++d) {
      of_[d] &= ~both_at(i);
      if (either(of_[d]) == 0) there_are_ &= ~(Bits{1} << d);
    }
  }

  // Calls visit(row, whose) for every delay that there is: the row of a line, a ring of longest + 1 rows, at
  // which what is sent in this tick arrives, and whose messages do.
  template <class Visit>
  void each(std::uint64_t tick, Visit&& visit) const {
    each_bit(there_are_, [&](int delay) {
      const auto d = static_cast<std::size_t>(delay);
      visit((tick + d) % (longest + 1), of_[d]);
    });
  }

 private:
  std::array<BothBits, longest + 1> of_{};
  Bits there_are_ = 0;  // bit d: some take d ticks
};

// The teams of many carries at once, where there are such for a kind of team:
//   static bool take(const Team&)    whether such a team can go on in bits
//   void put(int i, const Team&)     as team i it does, from its first tick on
//   void remove(int i)               it is over, and does nothing any more
//   Bits step(tick, SensedBits, HostBits, LossBits)   one tick of all; in which of them commands are new
//   commands()
//   void tell(int i, ticks, Metrics&, Traffic&)   what is known of team i after so many ticks
//   static constexpr bool rest       whether robots are ever told to
//   static constexpr bool station    whether there is one
template <class Team>
struct TeamsInBits {
  static constexpr bool exist = false;
};

}  // namespace palmbots
