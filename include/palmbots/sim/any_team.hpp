// SPDX-License-Identifier: Apache-2.0
// A team whatever its controllers are, at the cost of some virtual calls a tick. A carry that needs
// not be fast is compiled once with it, instead of once for each controller.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <utility>

#include "palmbots/sim/team.hpp"

namespace palmbots {

class AnyTeam {
 public:
  bool half_moves;
  bool expects_turns;
  bool has_clock;  // controllers measure time
  LinkTotals link_totals{};

  template <Team Own>
    requires(!std::same_as<Own, AnyTeam>)
  explicit AnyTeam(Own team)
      : half_moves(team.half_moves),
        expects_turns(team.expects_turns),
        has_clock(measures_time(team)),
        team_(std::make_unique<Holder<Own>>(std::move(team))) {}

  template <class Log>
  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&& log) {
    const PerSide<Command> commands = team_->step(tick, sensed, std::ref(log));
    link_totals = team_->link_totals();
    return commands;
  }
  void close(std::uint32_t tick) {
    team_->close(tick);
    link_totals = team_->link_totals();
  }
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    return team_->next_decision_tick(tick);
  }
  void fork(std::uint64_t seed) { team_->fork(seed); }
  void set_in_place(std::size_t side, bool in_place) { team_->set_in_place(side, in_place); }
  char name(std::size_t side) const { return team_->name(side); }
  bool waits(std::size_t side) const { return team_->waits(side); }
  MessageKind awaits(std::size_t side) const { return team_->awaits(side); }
  CorrectionActivity activity(std::size_t side) const { return team_->activity(side); }

 private:
  using Log = std::function<void(const SentMessage&)>;

  struct Held {
    virtual ~Held() = default;
    virtual PerSide<Command> step(std::uint32_t, const PerSide<RobotObservation>&, const Log&) = 0;
    virtual LinkTotals link_totals() const = 0;
    virtual void close(std::uint32_t) = 0;
    virtual std::uint32_t next_decision_tick(std::uint32_t) const = 0;
    virtual void fork(std::uint64_t) = 0;
    virtual void set_in_place(std::size_t, bool) = 0;
    virtual char name(std::size_t) const = 0;
    virtual bool waits(std::size_t) const = 0;
    virtual MessageKind awaits(std::size_t) const = 0;
    virtual CorrectionActivity activity(std::size_t) const = 0;
  };

  template <Team Own>
  struct Holder final : Held {
    explicit Holder(Own own) : team(std::move(own)) {}
    PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                          const Log& log) override {
      return team.step(tick, sensed, log);
    }
    LinkTotals link_totals() const override { return team.link_totals; }
    void close(std::uint32_t tick) override { team.close(tick); }
    std::uint32_t next_decision_tick(std::uint32_t tick) const override {
      return team.next_decision_tick(tick);
    }
    void fork(std::uint64_t seed) override { team.fork(seed); }
    void set_in_place(std::size_t side, bool in_place) override {
      palmbots::set_in_place(team, side, in_place);
    }
    char name(std::size_t side) const override { return team.name(side); }
    bool waits(std::size_t side) const override { return team.waits(side); }
    MessageKind awaits(std::size_t side) const override { return team.awaits(side); }
    CorrectionActivity activity(std::size_t side) const override { return team.activity(side); }
    Own team;
  };

  std::unique_ptr<Held> team_;
};

static_assert(Team<AnyTeam>);

}  // namespace palmbots
