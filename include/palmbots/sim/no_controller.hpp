// SPDX-License-Identifier: Apache-2.0
// Team without a controller.
#pragma once

#include "palmbots/sim/team.hpp"

namespace palmbots {

// Without a controller the palms stay steep and the robots keep their nominal speed.
struct NoController {
  LinkTotals link_totals{};
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = false;

  template <class Log>
  const PerSide<Command>& step(std::uint32_t, const PerSide<RobotObservation>&, Log&&) {
    static constexpr PerSide<Command> resting{
        {{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
    return resting;
  }
  void fork(std::uint64_t) {}
  void close(std::uint32_t) {}
  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  MessageKind awaits(std::size_t) const { return MessageKind::none; }
  CorrectionActivity activity(std::size_t) const { return {}; }
  std::uint32_t next_decision_tick(std::uint32_t) const { return ~0U; }
};

static_assert(Team<NoController>);

}  // namespace palmbots
