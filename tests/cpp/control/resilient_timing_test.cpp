// SPDX-License-Identifier: Apache-2.0
// Rounding without a library, and what limits a lease.
#include "palmbots/control/resilient_timing.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>

#include "support/check.hpp"

using palmbots::ResilientTiming;

namespace {

void rounds_as_the_library_does() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const auto same = [](double x) {
    CHECK(ResilientTiming::rounded_down(x) == std::floor(x));
    CHECK(ResilientTiming::rounded_up(x) == std::ceil(x));
  };
  for (const double whole :
       {0.0, 1.0, 2.0, 7.0, 60000.0, 4503599627370496.0, 9007199254740992.0, 1e18, 1e300}) {
    for (const double x : {whole, std::nextafter(whole, inf), std::nextafter(whole, -inf),
                           whole + 0.5, whole + 0.25}) {
      same(x);
      same(-x);
    }
  }
  same(inf);
  same(-inf);
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(ResilientTiming::rounded_down(none)));
}

// Ten ticks of delay, beacons every five, wheels that brake in six; a palm with 65 mm to spare.
constexpr palmbots::ResilientTimingInputs usual{
    .period = 0.01,
    .beacon = 0.05,
    .lease = 0,
    .watchdog = 0.1,
    .delay = 10,
    .braking = 6,
    .clock_ratio = 1,
    .shift = 0.0006,
    .room = 0.065,
    .drift = 0,
    .off_zone = 0,
};

void a_lease_has_two_limits() {
  using Problem = ResilientTiming::Problem;
  const auto with_lease = [](double lease) {
    auto in = usual;
    in.lease = lease;
    return ResilientTiming::of(in);
  };
  const ResilientTiming own = ResilientTiming::of(usual);
  CHECK(own.problem == Problem::none);
  CHECK(own.shortest_lease == 2 * (10 + 5) + 2);
  CHECK(own.times.limits[static_cast<std::size_t>(palmbots::ResilientLimit::hold)] ==
        own.times.lease + 1 + 10 + 6);
  CHECK(own.skew <= own.room);
  CHECK(with_lease(0.01 * own.shortest_lease).problem == Problem::none);
  CHECK(with_lease(0.01 * (own.shortest_lease - 1)).problem == Problem::lease_too_short);
  CHECK(with_lease(0.01 * own.longest_lease).problem == Problem::none);
  CHECK(with_lease(0.01 * (own.longest_lease + 1)).problem == Problem::lease_too_long);
  // With the longest lease the skew fills the room, up to one tick.
  const ResilientTiming longest = with_lease(0.01 * own.longest_lease);
  CHECK(longest.skew <= longest.room && longest.skew + usual.shift > longest.room);
  auto in = usual;
  // Noise takes its part of the room, once per tick alone and once before.
  in.drift = 0.0001;
  in.off_zone = 0.01;
  const ResilientTiming noisy = ResilientTiming::of(in);
  CHECK(noisy.problem == Problem::none && !noisy.is_noisy);
  CHECK(noisy.longest_lease < own.longest_lease);
  CHECK(noisy.skew + noisy.noise <= noisy.room);
  in.lease = 0.01 * noisy.longest_lease;
  const ResilientTiming full = ResilientTiming::of(in);
  CHECK(full.problem == Problem::none && full.skew + full.noise <= full.room);
  CHECK(full.skew + full.noise + usual.shift + in.drift > full.room);
  in.lease += 0.01;
  CHECK(ResilientTiming::of(in).problem == Problem::lease_too_long);
  // Noise alone refuses no scene, but the only lease left is the shortest one.
  in.lease = 0;
  in.off_zone = in.room;
  const ResilientTiming drowned = ResilientTiming::of(in);
  CHECK(drowned.problem == Problem::none && drowned.is_noisy);
  CHECK(drowned.times.lease == drowned.shortest_lease);
  in = usual;
  in.beacon = 0.005;
  CHECK(ResilientTiming::of(in).problem == Problem::beacon_too_short);
}

}  // namespace

int main() {
  rounds_as_the_library_does();
  a_lease_has_two_limits();
}
