// The centralized algorithm for sixty-four pairs of robots at once, each with its station: a bit a pair, or a
// bit a robot.
//
// What Station (station.hpp) does packet by packet is done here in words; the cases are those of
// Centralized::table. For pairs whose robots do not fail but by reboots, whose stations never do, and whose
// packets all take the same time, or are lost.
#pragma once

#include "palmbots/bit_counts.hpp"
#include "palmbots/station.hpp"

namespace palmbots {

// What robots report.
struct ReportBits {
  BothBits positive{};
  BothBits negative{};
  BothBits shallow{};  // the angle last commanded …
  BothBits turned{};   // … and whether the palm is there
};

// Sixty-four stations without their radio. Centralized::step() for all of them.
class ControllersInBits {
  using Table = Centralized;

 public:
  void put(int i) { decide_ |= Bits{1} << i; }
  void remove(int i) {
    for (Bits* stage : {&decide_, &tilt_, &first_, &second_, &restore_}) *stage &= ~(Bits{1} << i);
  }

  // One tick of those who have heard from both of their robots.
  CommandBits step(Bits hear, const ReportBits& in) {
    Bits to_decide = 0;
    Bits to_tilt = 0;
    Bits to_first = 0;
    Bits to_second = 0;
    Bits to_restore = 0;
    entered_ = 0;
    each_case([&](std::size_t k, const Table::Case& now) {
      const Bits here = in_case_[k] & hear;
      to_first |= here & tilt_ & turned(now.tilt, Palm::shallow, in);
      const Bits done_first = here & first_ & done(now.first, in);
      (now.second.move == Move::hold ? to_restore : to_second) |= done_first;
      to_restore |= here & second_ & done(now.second, in);
      to_decide |= here & restore_ & turned(now.tilt, Palm::steep, in);
      const Bits enter =
          hear & decide_ & are(now.sign[left], left, in) & are(now.sign[right], right, in);
      (now.tilt == Table::Who::none ? to_first : to_tilt) |= enter;
      in_case_[k] = (in_case_[k] & ~(hear & decide_)) | enter;
      entered_ |= enter;
    });
    const Bits leave_tilt = tilt_ & to_first;
    const Bits leave_first = first_ & (to_second | to_restore);
    decide_ = (decide_ & ~entered_) | to_decide;
    second_ = (second_ & ~to_restore) | to_second;
    tilt_ = (tilt_ & ~leave_tilt) | to_tilt;
    first_ = (first_ & ~leave_first) | to_first;
    restore_ = (restore_ & ~to_decide) | to_restore;
    return commands();
  }

  // Which of them have come into a case in this tick.
  Bits entered() const { return entered_; }

 private:
  template <class Visit>
  [[gnu::always_inline]] static void each_case(Visit visit) {
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      (visit(k, Table::table[k]), ...);
    }(std::make_index_sequence<std::size(Table::table)>());
  }

  static Bits are(Sign sign, std::size_t side, const ReportBits& in) {
    switch (sign) {
      case Sign::positive: return in.positive[side];
      case Sign::negative: return in.negative[side];
      case Sign::zero: break;
    }
    return ~(in.positive[side] | in.negative[side]);
  }

  static Bits done(const Table::Action& action, const ReportBits& in) {
    const auto holds = [&](std::size_t side) {
      return action.until == Table::Until::le_zero ? ~in.positive[side] : ~in.negative[side];
    };
    switch (action.who) {
      case Table::Who::on_left: return holds(left);
      case Table::Who::on_right: return holds(right);
      case Table::Who::either: return holds(left) | holds(right);
      case Table::Who::none: break;
    }
    return ~Bits{0};
  }

  static Bits turned(Table::Who who, Palm to, const ReportBits& in) {
    if (who == Table::Who::none) return ~Bits{0};
    const std::size_t side = who == Table::Who::on_left ? left : right;
    return in.turned[side] & (to == Palm::shallow ? in.shallow[side] : ~in.shallow[side]);
  }

  CommandBits commands() const {
    CommandBits told;
    const Bits up = tilt_ | first_ | second_;
    Bits away = 0;
    Bits closer = 0;
    each_case([&](std::size_t k, const Table::Case& now) {
      const auto act = [&](Move move, Bits stage) {
        if (move == Move::away) away |= in_case_[k] & stage;
        if (move == Move::closer) closer |= in_case_[k] & stage;
      };
      act(now.first.move, first_);
      act(now.second.move, second_);
      if (now.tilt == Table::Who::on_left) told.shallow[left] |= in_case_[k] & up;
      if (now.tilt == Table::Who::on_right) told.shallow[right] |= in_case_[k] & up;
    });
    told.away = BothBits{away, away};
    told.closer = BothBits{closer, closer};
    return told;
  }

  std::array<Bits, Table::cases> in_case_{};  // the case in progress, or the last one
  Bits decide_ = 0;                           // who is in that stage
  Bits tilt_ = 0;
  Bits first_ = 0;
  Bits second_ = 0;
  Bits restore_ = 0;
  Bits entered_ = 0;
};

// Sixty-four stations with their robots and the radio, and what is counted of them (metrics.hpp).
class StationsInBits {
 public:
  static constexpr bool rest = true;  // when it is off
  static constexpr bool station = true;

  static bool take(const Station& team) {
    return DelayBits::take(team.radio().steady_delay()) && team.faults().are_reboots();
  }

  void put(int i, const Station& team) {
    controllers_.put(i);
    delays_.put(i, team.radio().steady_delay());
    for (BitCounts* counts : {&corrections_, &off_, &reports_lost_, &commands_lost_})
      counts->clear(both_at(i));
  }

  void remove(int i) {
    const BothBits those = ~both_at(i);
    controllers_.remove(i);
    delays_.remove(i);
    for (Row& row : line_) {
      row.reported &= those;
      row.told &= those;
    }
    commands_.remove(~those);
    heard_ &= those;
  }

  Bits step(std::uint64_t tick, const SensedBits& sensed, const HostBits& hosts,
            const LossBits& lost) {
    const Row& arrived = line_[tick % line_.size()];
    const CommandBits before = commands_;
    const ReportBits said{sensed.positive, sensed.negative, commands_.shallow, sensed.turned};
    hear(arrived, tick);
    obey(arrived, hosts);
    const Bits hear_both = heard_[left] & heard_[right];
    const CommandBits told = controllers_.step(hear_both, reports_);
    const BothBits tell = BothBits{} + hear_both;
    // Few are ever off, and few lose messages.
    if (either(hosts.off) != 0) [[unlikely]]
      off_.add(hosts.off);
    if (either(lost.from_robot | lost.from_station) != 0) {
      reports_lost_.add(lost.from_robot & ~hosts.off);
      commands_lost_.add(lost.from_station & tell);
    }
    corrections_.add(BothBits{controllers_.entered(), 0});
    delays_.each(tick, [&](std::size_t place, BothBits whose) {
      Row& row = line_[place];
      const auto put = [&](BothBits& there, BothBits what) {
        there = (there & ~whose) | (what & whose);
      };
      put(row.report.positive, said.positive);
      put(row.report.negative, said.negative);
      put(row.report.shallow, said.shallow);
      put(row.report.turned, said.turned);
      put(row.commands.shallow, told.shallow);
      put(row.commands.away, told.away);
      put(row.commands.closer, told.closer);
      put(row.reported, ~(hosts.off | lost.from_robot));
      put(row.told, tell & ~lost.from_station);
    });
    now_ = tick;
    return commands_.differ(before);
  }

  const CommandBits& commands() const { return commands_; }

  // Every tick each robot that runs sends, and the station does to each as soon as it has heard from both.
  void tell(int i, std::uint32_t ticks, Metrics& metrics, Traffic& traffic) const {
    metrics.corrections = corrections_.of(left, i);
    const bool heard = (heard_[left] & heard_[right] & Bits{1} << i) != 0;
    const std::uint64_t answers = heard ? now_ + 1 - heard_since_[static_cast<std::size_t>(i)] : 0;
    traffic.sent = 0;
    traffic.lost = 0;
    for (const std::size_t side : {left, right}) {
      metrics.waiting_ticks[side] = 0;
      metrics.waits_since[side] = ticks;
      traffic.links[side].sent = ticks - off_.of(side, i);
      traffic.links[side].lost = reports_lost_.of(side, i);
      traffic.links[side + 2].sent = static_cast<std::uint32_t>(answers);
      traffic.links[side + 2].lost = commands_lost_.of(side, i);
    }
    for (const LinkCounts& link : traffic.links) {
      traffic.sent += link.sent;
      traffic.lost += link.lost;
    }
  }

 private:
  // What arrives in a tick: whose reports do, and to whom commands.
  struct Row {
    ReportBits report;
    CommandBits commands;
    BothBits reported{};
    BothBits told{};
  };

  // The newest commands are what robots go by; those that boot do what they do by themselves.
  void obey(const Row& arrived, const HostBits& hosts) {
    commands_.remove(hosts.boots);
    const BothBits whose = arrived.told & ~hosts.off;
    const auto take = [&](BothBits& newest, BothBits said) {
      newest = (newest & ~whose) | (said & whose);
    };
    take(commands_.shallow, arrived.commands.shallow);
    take(commands_.away, arrived.commands.away);
    take(commands_.closer, arrived.commands.closer);
    commands_.switch_off(hosts.off);
  }

  // The newest reports are what stations go by.
  void hear(const Row& arrived, std::uint64_t tick) {
    const BothBits whose = arrived.reported;
    const auto take = [&](BothBits& newest, BothBits said) {
      newest = (newest & ~whose) | (said & whose);
    };
    take(reports_.positive, arrived.report.positive);
    take(reports_.negative, arrived.report.negative);
    take(reports_.shallow, arrived.report.shallow);
    take(reports_.turned, arrived.report.turned);
    const Bits before = heard_[left] & heard_[right];
    heard_ |= whose;
    each_bit(heard_[left] & heard_[right] & ~before,
             [&](int i) { heard_since_[static_cast<std::size_t>(i)] = tick; });
  }

  ControllersInBits controllers_;
  std::array<Row, DelayBits::longest + 1> line_;
  DelayBits delays_;
  ReportBits reports_;
  BothBits heard_{};                             // from whom, ever
  std::array<std::uint64_t, 64> heard_since_{};  // the tick from which on from both
  std::uint64_t now_ = 0;                        // the last tick
  CommandBits commands_;
  BitCounts corrections_;
  BitCounts off_;  // ticks in which a robot was
  BitCounts reports_lost_;
  BitCounts commands_lost_;
};

template <>
struct TeamsInBits<Station> : StationsInBits {
  static constexpr bool exist = true;
};

}  // namespace palmbots
