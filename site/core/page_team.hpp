// SPDX-License-Identifier: Apache-2.0
// The team of any controller behind one type, so that the carry around it is compiled once and not
// for each controller: carries were 40 % of the page's core.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots::page {

// One virtual call a step, because a team is asked for its state in every tick.
class PageTeam {
 public:
  template <Team T>
  explicit PageTeam(T team) : PageTeam(std::make_unique<Held<T>>(std::move(team))) {}

  bool half_moves;
  bool expects_turns;
  const LinkTotals& link_totals;  // of the held team

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    sent_.clear();
    const PerSide<Command>& commands = held_->step(tick, sensed, now_, sent_);
    for (const SentMessage& message : sent_) log(message);
    return commands;
  }
  // As it was known in the last step.
  std::uint32_t next_decision_tick(std::uint32_t) const { return now_.next_decision_tick; }
  void close(std::uint32_t tick) { held_->close(tick); }
  void fork(std::uint64_t seed) { held_->fork(seed); }
  char name(std::size_t side) const { return now_.names[side]; }
  bool waits(std::size_t side) const { return now_.waits[side]; }
  // The number of the state of a robot's table; no_state: it has none.
  static constexpr int no_state = -1;
  int state(std::size_t side) const { return now_.states[side]; }
  MessageKind awaits(std::size_t side) const { return held_->awaits(side); }
  CorrectionActivity activity(std::size_t side) const { return held_->activity(side); }
  void set_in_place(std::size_t side, bool in_place) { held_->set_in_place(side, in_place); }
  // The packets of this tick, if the team has a station.
  std::optional<StationPackets> packets(std::uint32_t tick) const { return held_->packets(tick); }

 private:
  // What changes in a step only.
  struct State {
    std::uint32_t next_decision_tick = 0;
    PerSide<char> names{};
    PerSide<bool> waits{};
    PerSide<int> states{{no_state, no_state}};

    template <class T>
    void take_names(const T& team) {
      for (const std::size_t side : {left, right}) {
        names[side] = team.name(side);
        waits[side] = team.waits(side);
        if constexpr (requires { team.robot(side).state(); }) {
          states[side] = static_cast<int>(team.robot(side).state());
        }
      }
    }
  };

  struct Any {
    virtual ~Any() = default;
    virtual const PerSide<Command>& step(std::uint32_t tick,
                                         const PerSide<RobotObservation>& sensed, State& now,
                                         std::vector<SentMessage>& sent) = 0;
    virtual void close(std::uint32_t tick) = 0;
    virtual void fork(std::uint64_t seed) = 0;
    virtual MessageKind awaits(std::size_t side) const = 0;
    virtual CorrectionActivity activity(std::size_t side) const = 0;
    virtual void set_in_place(std::size_t side, bool in_place) = 0;
    virtual std::optional<StationPackets> packets(std::uint32_t tick) const = 0;
  };

  template <class T>
  struct Held final : Any {
    explicit Held(T held) : team(std::move(held)) {}

    const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                                 State& now, std::vector<SentMessage>& sent) override {
      const PerSide<Command>& commands =
          team.step(tick, sensed, [&](const SentMessage& message) { sent.push_back(message); });
      now.next_decision_tick = team.next_decision_tick(tick);
      now.take_names(team);
      return commands;
    }
    void close(std::uint32_t tick) override { team.close(tick); }
    void fork(std::uint64_t seed) override { team.fork(seed); }
    MessageKind awaits(std::size_t side) const override { return team.awaits(side); }
    CorrectionActivity activity(std::size_t side) const override { return team.activity(side); }
    void set_in_place(std::size_t side, bool in_place) override {
      palmbots::set_in_place(team, side, in_place);
    }
    std::optional<StationPackets> packets(std::uint32_t tick) const override {
      if constexpr (requires { team.packets(tick); }) return team.packets(tick);
      return std::nullopt;
    }

    T team;
  };

  template <class T>
  explicit PageTeam(std::unique_ptr<Held<T>> held)
      : half_moves(T::half_moves),
        expects_turns(T::expects_turns),
        link_totals(held->team.link_totals) {
    now_.take_names(held->team);
    held_ = std::move(held);
  }

  std::unique_ptr<Any> held_;
  State now_;
  std::vector<SentMessage> sent_;  // in the last step
};

static_assert(Team<PageTeam>);

}  // namespace palmbots::page
