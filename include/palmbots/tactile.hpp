// The tactile sensor: switch zones along the palm, labelled −, 0, + (paper, Figure 7).
//
// A zone labelled 0 may overlap the others and wins over them: our reading of the caption of Figure
// 7. A contact in no zone presses no switch and reads 0 (assumed). Both robots have the same layout,
// in the outward coordinate p.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "palmbots/message.hpp"
#include "palmbots/philox.hpp"

namespace palmbots {

inline constexpr std::size_t max_zones = 16;

template <class Real>
struct Zone {
  Sign sign;
  Real from;  // [m], closed
  Real to;    // [m], closed
};

template <class Real>
class Tactile {
 public:
  Tactile() = default;
  Tactile(const std::array<Zone<Real>, max_zones>& zones, std::size_t count, double false_rate)
      : zones_(zones), count_(count), false_words_(threshold(false_rate)) {}

  // The sign at contact coordinate p [m] with perfect switches.
  constexpr Sign sign(Real p) const {
    Sign seen = Sign::zero;
    for (std::size_t i = 0; i < count_; ++i) {
      const Zone<Real>& zone = zones_[i];
      if (p < zone.from || p > zone.to) continue;
      if (zone.sign == Sign::zero) return Sign::zero;
      seen = zone.sign;
    }
    return seen;
  }

  constexpr bool has_false_readings() const { return false_words_ > 0; }

  // The same with false readings: one of the two wrong signs at a given rate.
  constexpr Sign sign(Real p, std::uint32_t chance, std::uint32_t which) const {
    const Sign truth = sign(p);
    if (chance >= false_words_) return truth;
    const int turn = (which & 1) != 0 ? 1 : 2;
    return static_cast<Sign>((static_cast<int>(truth) + 1 + turn) % 3 - 1);
  }

 private:
  // Rate 0 → 0, rate 1 → 2³², compared with a 32-bit draw.
  static constexpr std::uint64_t threshold(double rate) {
    return static_cast<std::uint64_t>(rate * 4294967296.0);
  }

  std::array<Zone<Real>, max_zones> zones_{};
  std::size_t count_ = 0;
  std::uint64_t false_words_ = 0;
};

}  // namespace palmbots
