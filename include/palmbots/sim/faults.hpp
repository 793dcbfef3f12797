// SPDX-License-Identifier: Apache-2.0
// Faults of a carry and their schedule, computed once from the spec and the seed.
//
// A robot whose program does not run keeps its last command. If that lasts longer than the
// watchdog's time, its wheels are brought to rest and its controller boots when the fault is over;
// the palm's servo holds the angle last commanded. A reboot has this effect from its start. A stuck
// sensor reads one sign; a flickering one occasionally reads a random sign. A lost station neither
// receives nor sends. A clock changes its rate for a time, or jumps ahead. A robot that has lost its
// boot counter does not start again, as its program refuses to.
//
// A robot with a longer control period than the carry's is not stepped in between, as if it were
// frozen for these ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// Whether a robot's program runs, and how.
enum class ProgramState : std::uint8_t {
  running,
  frozen,   // not stepped; the command stays
  off,      // not stepped; the robot rests
  booting,  // runs, for the first time since it was off
};

// The schedule of faults of one carry.
class Faults {
 public:
  Faults() = default;

  static Faults of(const Spec& spec, std::uint64_t seed) {
    Faults faults;
    faults.seed_ = seed;
    faults.stride_ = {spec.robots[left].stride, spec.robots[right].stride};
    for (std::size_t i = 0; i < spec.fault_count; ++i) faults.add(spec, spec.faults[i]);
    // Random reboots: any robot, at any time within the duration of a carry at nominal speed.
    const double length =
        spec.distance / (0.5 * (spec.robots[left].speed + spec.robots[right].speed));
    for (std::uint32_t i = 0; i < spec.random_reboots; ++i) {
      const Words words = draw(seed, i, Stream::fault);
      const std::size_t leader = spec.direction > 0 ? right : left;
      const std::size_t side = (words[0] & 1) != 0 ? leader : other(leader);
      faults.add(spec, {FaultKind::reboot, static_cast<std::uint32_t>(side),
                        unit_uniform<double>(words[1]) * length, spec.reboot, 0, 0, 0});
    }
    return faults;
  }

  bool any() const { return count_ > 0 || skips_ticks(left) || skips_ticks(right); }

  // True if a robot's program is not stepped in every tick.
  bool skips_ticks(std::size_t side) const { return stride_[side] > 1; }

  // True if all faults are reboots after which the robot starts again with its palm held.
  bool are_reboots() const {
    if (skips_ticks(left) || skips_ticks(right)) return false;
    for (std::size_t i = 0; i < count_; ++i) {
      if (list_[i].kind != FaultKind::reboot || list_[i].marks != 0) return false;
    }
    return true;
  }

  // True if any fault affects a sensor.
  bool corrupts_readings() const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (list_[i].is_sensors()) return true;
    }
    return false;
  }

  // The state of a robot's program at a tick, by the schedule alone. Never `booting`, which
  // ProgramMonitor determines.
  ProgramState program_state(std::uint32_t tick, std::size_t side) const {
    ProgramState state = tick % stride_[side] == 0 ? ProgramState::running : ProgramState::frozen;
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.side != side || !f.covers(tick)) continue;
      if (f.kind == FaultKind::freeze && tick < f.off_from && state != ProgramState::off) {
        state = ProgramState::frozen;
      }
      if (f.kind == FaultKind::reboot || (f.kind == FaultKind::freeze && tick >= f.off_from)) {
        state = ProgramState::off;
      }
    }
    return state;
  }

  bool station_lost(std::uint32_t tick) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (list_[i].kind == FaultKind::station && list_[i].covers(tick)) return true;
    }
    return false;
  }

  // What the clock of a robot gains in a tick, besides its constant rate [ticks].
  double clock_gain(std::uint32_t tick, std::size_t side) const {
    double gain = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.side != side || !f.is_clock()) continue;
      const bool is_now = f.kind == FaultKind::clock_jump ? tick == f.from : f.covers(tick);
      if (is_now) gain += f.value;
    }
    return gain;
  }

  // True if the clock of a robot does not keep its rate.
  bool changes_clock(std::size_t side) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (list_[i].side == side && list_[i].is_clock()) return true;
    }
    return false;
  }

  bool may_go_limp() const { return may_go_limp_; }

  // The angle to which a palm falls in a tick [rad]; nothing while its servo holds it.
  std::optional<double> limp_angle(std::uint32_t tick, std::size_t side) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.side == side && (f.marks & palm_goes_limp) != 0 && f.covers(tick)) return f.value;
    }
    return std::nullopt;
  }

  // The first later tick at which a robot's program or the station may fail or return.
  std::uint32_t next_outage(std::uint32_t tick) const {
    std::uint32_t next = skips_ticks(left) || skips_ticks(right) ? tick + 1 : ~0U;
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.is_sensors() || f.is_clock() || tick >= f.to) continue;
      const std::uint32_t at = f.from > tick ? f.from : tick + 1;
      next = at < next ? at : next;
    }
    return next;
  }

  // Whether a fault keeps a robot's program from running.
  bool stops(std::uint32_t tick, std::size_t side) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      const bool of_program = f.kind == FaultKind::freeze || f.kind == FaultKind::reboot;
      if (of_program && f.side == side && f.covers(tick)) return true;
    }
    return false;
  }

  // The first later tick at which program_state() may return another value.
  std::uint32_t next_change(std::uint32_t tick, std::size_t side) const {
    std::uint32_t next = skips_ticks(side) ? tick + 1 : ~0U;
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.side != side || f.is_sensors() || f.is_clock()) continue;
      for (const std::uint32_t at : {f.from, f.off_from, f.to}) {
        if (at > tick && at < next) next = at;
      }
    }
    return next;
  }

  // The reading of a sensor at a tick at which it should read `sign`.
  Sign reading(std::uint32_t tick, std::size_t side, Sign sign) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Fault& f = list_[i];
      if (f.side != side || !f.covers(tick)) continue;
      if (f.kind == FaultKind::stuck) sign = f.reads;
      if (f.kind == FaultKind::flicker) {
        const Words words = draw(seed_, tick, Stream::fault, 1 + static_cast<std::uint32_t>(i));
        if (words[0] < f.flicker_words)
          sign = static_cast<Sign>(static_cast<int>(words[1] % 3) - 1);
      }
    }
    return sign;
  }

 private:
  struct Fault {
    FaultKind kind;
    std::size_t side;
    std::uint32_t from;
    std::uint32_t to;        // the first tick after it
    std::uint32_t off_from;  // the tick from which on the robot rests and will boot
    Sign reads;
    std::uint64_t flicker_words;  // threshold of 2³²
    std::uint64_t marks;
    double value;  // gain of a clock per tick, or at once [ticks]; angle of a limp palm [rad]

    bool is_clock() const { return kind == FaultKind::clock_rate || kind == FaultKind::clock_jump; }
    bool is_sensors() const { return kind == FaultKind::stuck || kind == FaultKind::flicker; }
    bool covers(std::uint32_t tick) const { return tick >= from && tick < to; }
  };

  void add(const Spec& spec, const FaultSpec& fault) {
    const auto ticks = [&](double seconds) {
      return static_cast<std::uint32_t>(seconds / spec.period + 0.5);
    };
    Fault& f = list_[count_++];
    f.kind = fault.kind;
    f.side = fault.side;
    f.from = ticks(fault.at);
    f.to = f.from + ticks(fault.lasts);
    f.off_from = fault.kind == FaultKind::freeze ? f.from + ticks(spec.watchdog) : f.from;
    f.reads = static_cast<Sign>(fault.reads);
    f.marks = fault.marks;
    f.value = fault.rate;
    if (fault.kind == FaultKind::clock_jump) {
      const double jump = fault.rate / spec.period;
      f.value = jump < most_jump_ticks ? jump : most_jump_ticks;
    }
    if (fault.kind == FaultKind::flicker) {
      f.flicker_words = static_cast<std::uint64_t>(fault.rate * 4294967296.0);
    }
    if ((fault.marks & loses_boot_counter) != 0) f.to = ~0U;
    may_go_limp_ = may_go_limp_ || (fault.marks & palm_goes_limp) != 0;
  }

  static constexpr double most_jump_ticks = 60'000;        // programs count in 16 bits
  static constexpr std::size_t capacity = max_faults + 8;  // scheduled and random ones
  std::array<Fault, capacity> list_{};
  std::size_t count_ = 0;
  PerSide<std::uint64_t> stride_{1, 1};
  std::uint64_t seed_ = 0;
  bool may_go_limp_ = false;
};

// Records which robots have been off since they last ran. A program that was off boots when it runs
// next, whatever else has kept it from running meanwhile.
class ProgramMonitor {
 public:
  // To be called once per tick and robot.
  ProgramState program_state(const Faults& faults, std::uint32_t tick, std::size_t side) {
    const ProgramState state = next_program_state(faults, tick, side);
    if (state == ProgramState::off) was_off_[side] = true;
    if (state == ProgramState::booting) was_off_[side] = false;
    return state;
  }

  // The value that program_state() will return in the coming tick.
  ProgramState next_program_state(const Faults& faults, std::uint32_t tick,
                                  std::size_t side) const {
    const ProgramState state = faults.program_state(tick, side);
    return state == ProgramState::running && was_off_[side] ? ProgramState::booting : state;
  }

 private:
  PerSide<bool> was_off_{};
};

}  // namespace palmbots
