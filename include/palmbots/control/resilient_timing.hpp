// SPDX-License-Identifier: Apache-2.0
// The time bounds of the resilient algorithm: what must hold, what follows, and what it costs where
// a robot is left alone. Times in control ticks of T seconds, lengths in metres. Plain numbers in
// and out: sim/build.hpp fills them in from a scene.
//
//   D  the radio's longest delay           B  the beacon period
//   W  the watchdog: ticks that a robot may act on its last command without a step
//   K  braking: ticks from the correction speed to the nominal one
//   r  by how much one robot's clock may run faster than the other's
//   S  the ticks between two steps of the slower program; 1 unless a robot has a longer control
//      period of its own
//
// lease (Tm, Tc). A robot's newest echo is of a beacon that waited up to B to be sent, took D to
// arrive, waited up to B for the partner's next beacon and took D back. On a perfect radio it is up
// to 2 D + 2 B old, plus a tick each for steps that fall between. With S > 1 each of the two beacons
// may be sent and heard S − 1 later, and each of the two steps too: 6 (S − 1) in all. The lease must be longer than
// that. Each further B allows one more beacon in a row to be lost before a robot stops.
//
// hold (Tp, Tb). A robot moves away only on an Ack that is at most `lease` old by its own clock. It
// may miss W ticks, and then brakes for K. The robot that sent the Ack keeps its palm up for the
// same time after its last one: hold = r (lease + S + W + K). This does not rely on D, because the
// echo has measured the age of the Ack. After a boot a robot holds for the same time.
//
// braking. After a move has ended, a robot waits r K of its own ticks before it reports the end, by
// TiltDown after (a) or Ack after (d). By then its wheels run at the nominal speed.
//
// The waits Tf and Ts of variant H, during which old messages die out, are not needed: a robot
// waits for the echo of its release instead, one round trip.
//
// skew. A robot that stops reports it. Its partner stops when it hears that, or when its lease
// expires: what it hears later was sent by a robot at rest. So no robot travels alone for longer
// than alone = r (lease + S) + W. Both palms are steep by then or turning so, and one contact takes
// the whole shift: speed × alone / cos(steepest palm). Before that the robots may have started one
// after the other, which shifts it for `join`. The skew is the sum of both. The room is the
// distance from the zero zone to the end of the palm.
//
// noise. The skew is that of perfect wheels and of a contact that is inside its zero zone when the
// fault occurs. Three things come on top:
//   - bias and noise of the robot that is left alone, for alone + r join: `drift` a tick;
//   - what the contact had moved beyond the zone before its correction began: `off_zone`;
//   - braking, where the robots' accelerations differ (part of `off_zone`).
// Noise has no bound; here it counts with one standard deviation in each place. That is assumed,
// and enough: the skew itself takes a fault at the worst instant of the worst tick. One reboot in
// every carry adds at most 0.2 % of drops (benchmarks/bench_lease.py). Where the noise leaves no
// lease at all, the shortest one is used, `is_noisy` reports it, and a fault may drop the object.
//
// join. The robot that starts first reports it at once. The other one was ready by then, hears it
// D later and starts in its next step at the latest: join = r D + S. With less, contacts that were
// corrected only to the edge of the zero zone could make the two start and stop without end.
#pragma once

#include <cstdint>

#include "palmbots/control/resilient.hpp"

namespace palmbots {

// What the time bounds depend on.
struct ResilientTimingInputs {
  double period;       // T [s]
  double beacon;       // period of the beacons [s]
  double lease;        // [s]; 0: the usual one
  double watchdog;     // [s]
  double delay;        // D [ticks]
  double braking;      // K [ticks]
  double clock_ratio;  // r
  double shift;        // of a contact in a tick in which one robot travels alone [m]
  double room;         // for skew and noise, on the shorter palm [m]
  double drift;        // of a contact in such a tick by bias and noise [m]
  double off_zone;     // by which a contact may have left its zero zone at the fault [m]
  double stride = 1;   // S [ticks]
};

struct ResilientTiming {
  enum class Problem : std::uint8_t { none, beacon_too_short, lease_too_short, lease_too_long };

  TableTimes<Resilient> times{};
  double delay = 0;           // D [ticks]
  double braking = 0;         // K [ticks]
  double skips = 0;           // W [ticks]
  double clock_ratio = 1;     // r
  double stride = 1;          // S [ticks]
  double shortest_lease = 0;  // [ticks]
  double longest_lease = 0;   // [ticks]: with it skew and noise fill the room
  double losses = 0;          // beacons in a row that may be lost
  double alone = 0;           // longest that one robot travels without the other [ticks]
  double skew = 0;            // what that shifts a contact [m]
  double noise = 0;           // what noise, bias and the way before the fault add to it [m]
  double room = 0;            // for both, on the shorter palm [m]
  bool is_noisy = false;      // the noise alone leaves no lease
  Problem problem = Problem::none;

  static constexpr ResilientTiming of(const ResilientTimingInputs& in) {
    ResilientTiming b;
    const double beacon = rounded_up(in.beacon / in.period - 1e-9);
    b.delay = in.delay;
    b.skips = rounded_up(in.watchdog / in.period - 1e-9);
    b.braking = in.braking;
    b.clock_ratio = in.clock_ratio;
    b.stride = in.stride;
    b.room = in.room;
    b.shortest_lease = 2 * (b.delay + beacon) + 2 + 6 * (b.stride - 1);
    // The lease at which a contact that moves by `shift` a tick uses up the room.
    const auto filling = [&](double distance, double shift) {
      if (!(shift > 0)) return 60000.0;
      const double lease = (distance / shift - b.skips) / b.clock_ratio - b.stride - joining(b);
      return smaller(rounded_down(lease), 60000);
    };
    const double without_noise = filling(b.room, in.shift);
    b.longest_lease = filling(b.room - in.off_zone, in.shift + in.drift);
    b.is_noisy = b.longest_lease < b.shortest_lease && b.shortest_lease <= without_noise;
    if (b.is_noisy) b.longest_lease = b.shortest_lease;
    const double lease = in.lease > 0 ? rounded_down(in.lease / in.period + 1e-9)
                                      : usual_lease(b, beacon, in.period);
    const double hold = rounded_up(b.clock_ratio * (lease + b.stride + b.skips + b.braking));
    b.losses = rounded_down((lease - b.shortest_lease) / beacon);
    const double braking = rounded_up(b.clock_ratio * b.braking);
    const double join = joining(b);
    b.times = {
        to_ticks(beacon), to_ticks(lease), {to_ticks(hold), to_ticks(braking), to_ticks(join)}};
    b.alone = b.clock_ratio * (lease + b.stride) + b.skips;
    b.skew = in.shift * (b.alone + b.clock_ratio * join);
    b.noise = in.off_zone + in.drift * (b.alone + b.clock_ratio * join);
    if (beacon < 1 || in.beacon < in.period * (1 - 1e-9)) {
      b.problem = Problem::beacon_too_short;
    } else if (lease < b.shortest_lease) {
      b.problem = Problem::lease_too_short;
    } else if (lease > b.longest_lease) {
      b.problem = Problem::lease_too_long;
    }
    return b;
  }

  // ⌊x⌋ and ⌈x⌉ without a library. From 2⁵³ on every number is whole.
  static constexpr double rounded_down(double x) {
    constexpr double whole_from = 9007199254740992.0;
    if (!(x < whole_from && x > -whole_from)) return x;
    const auto towards_zero = static_cast<double>(static_cast<std::int64_t>(x));
    return towards_zero > x ? towards_zero - 1 : towards_zero;
  }
  static constexpr double rounded_up(double x) { return -rounded_down(-x); }

 private:
  static constexpr double larger(double a, double b) { return a < b ? b : a; }
  static constexpr double smaller(double a, double b) { return b < a ? b : a; }

  static constexpr double joining(const ResilientTiming& b) {
    return rounded_up(b.clock_ratio * b.delay) + b.stride;
  }

  // Half a second, or as much more as six lost beacons in a row need, within the room there is.
  static constexpr double usual_lease(const ResilientTiming& b, double beacon, double period) {
    const double wanted = larger(0.5 / period, b.shortest_lease + 6 * beacon);
    return rounded_down(smaller(wanted, larger(b.longest_lease, b.shortest_lease)) + 1e-9);
  }

  static constexpr std::uint16_t to_ticks(double ticks) {
    return static_cast<std::uint16_t>(ticks < 60000 ? ticks : 60000);
  }
};

}  // namespace palmbots
