// SPDX-License-Identifier: Apache-2.0
// Tactile sensor: switch zones along the palm, labelled −, 0, + (paper, Figure 7).
//
// A zone labelled 0 may overlap the others and takes precedence over them; this is our reading of
// the caption of Figure 7. A contact outside all zones closes no switch and reads 0 (assumed). Both
// robots have the same layout, in the outward coordinate p.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "palmbots/control/messages.hpp"

namespace palmbots {

inline constexpr std::size_t max_zones = 16;

// A switch zone: an interval of the contact coordinate p and its label.
template <class Real>
struct Zone {
  Sign sign;
  Real from;  // [m], closed
  Real to;    // [m], closed
};

// The sensor of one palm.
template <class Real>
class TactileSensor {
 public:
  TactileSensor() = default;
  TactileSensor(const std::array<Zone<Real>, max_zones>& zones, std::size_t count,
                double false_rate)
      : false_words_(threshold(false_rate)) {
    for (std::size_t i = 0; i < count; ++i) {
      add_edge(zones[i].from);
      add_edge(zones[i].to);
    }
    // The reading is constant between two edges. Because zones are closed it may differ on an edge
    // itself. `changes_` holds the coordinates from which on the reading is a different one.
    readings_[0] = covered(zones, count, between(0));
    for (std::size_t i = 0; i < edge_count_; ++i) {
      change_at(edges_[i], covered(zones, count, edges_[i]));
      change_at(std::nextafter(edges_[i], std::numeric_limits<Real>::infinity()),
                covered(zones, count, between(i + 1)));
    }
  }

  // The sign at contact coordinate p [m] with perfect switches.
  constexpr Sign sign(Real p) const {
    std::size_t passed = 0;
    for (std::size_t i = 0; i < change_count_; ++i) passed += p >= changes_[i] ? 1U : 0U;
    return readings_[passed];
  }

  // The interval around p in which perfect switches give the same sign: `from` ≤ p < `until` [m].
  struct Stretch {
    Real from;
    Real until;
    Sign sign;
  };
  constexpr Stretch stretch(Real p) const {
    constexpr Real inf = std::numeric_limits<Real>::infinity();
    Stretch found{-inf, inf, readings_[0]};
    for (std::size_t i = 0; i < change_count_; ++i) {
      if (p < changes_[i]) {
        found.until = changes_[i];
        break;
      }
      found.from = changes_[i];
      found.sign = readings_[i + 1];
    }
    return found;
  }

  // The outward coordinates [m] from which on the sensor reads 0 or +, and from which on it reads
  // +. Exists only if the reading never decreases outward.
  struct Steps {
    Real not_negative;
    Real positive;
  };
  constexpr std::optional<Steps> steps() const {
    constexpr Real inf = std::numeric_limits<Real>::infinity();
    const auto from = [&](Sign sign) {
      for (std::size_t i = 0; i <= change_count_; ++i) {
        if (readings_[i] >= sign) return i == 0 ? -inf : changes_[i - 1];
      }
      return inf;
    };
    for (std::size_t i = 0; i < change_count_; ++i) {
      if (readings_[i + 1] < readings_[i]) return std::nullopt;
    }
    return Steps{from(Sign::zero), from(Sign::positive)};
  }

  constexpr bool has_false_readings() const { return false_words_ > 0; }
  // A reading is false if a 32-bit random word is below this number.
  constexpr std::uint64_t false_words() const { return false_words_; }

  // The sign at p with false readings: one of the two wrong signs at a given rate. `chance` and
  // `which` are random words.
  constexpr Sign sign(Real p, std::uint32_t chance, std::uint32_t which) const {
    const Sign truth = sign(p);
    if (chance >= false_words_) return truth;
    const int turn = (which & 1) != 0 ? 1 : 2;
    return static_cast<Sign>((static_cast<int>(truth) + 1 + turn) % 3 - 1);
  }

 private:
  // The rate as a threshold for a 32-bit draw: 0 → 0, 1 → 2³².
  static constexpr std::uint64_t threshold(double rate) {
    return static_cast<std::uint64_t>(rate * 4294967296.0);
  }

  void add_edge(Real at) {
    constexpr Real inf = std::numeric_limits<Real>::infinity();
    if (at == inf || at == -inf) return;
    std::size_t place = 0;
    while (place < edge_count_ && edges_[place] < at) ++place;
    if (place < edge_count_ && edges_[place] == at) return;
    for (std::size_t i = edge_count_; i > place; --i) edges_[i] = edges_[i - 1];
    edges_[place] = at;
    ++edge_count_;
  }

  void change_at(Real from, Sign reading) {
    if (reading == readings_[change_count_]) return;
    changes_[change_count_] = from;
    readings_[++change_count_] = reading;
  }

  // A coordinate strictly between edge i − 1 and edge i.
  constexpr Real between(std::size_t i) const {
    if (edge_count_ == 0) return Real(0);
    if (i == 0) return edges_[0] - Real(1);
    if (i == edge_count_) return edges_[i - 1] + Real(1);
    return Real(0.5) * (edges_[i - 1] + edges_[i]);
  }

  static Sign covered(const std::array<Zone<Real>, max_zones>& zones, std::size_t count, Real p) {
    Sign seen = Sign::zero;
    for (std::size_t i = 0; i < count; ++i) {
      if (p < zones[i].from || p > zones[i].to) continue;
      if (zones[i].sign == Sign::zero) return Sign::zero;
      seen = zones[i].sign;
    }
    return seen;
  }

  std::array<Real, 2 * max_zones> edges_{};
  std::size_t edge_count_ = 0;
  std::array<Real, 4 * max_zones> changes_{};
  std::size_t change_count_ = 0;
  std::array<Sign, 4 * max_zones + 1> readings_{};
  std::uint64_t false_words_ = 0;
};

}  // namespace palmbots
