// SPDX-License-Identifier: Apache-2.0
// Warnings at the end of a carry, from what it measured: one sentence each, for the command line,
// Python and the page.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "palmbots/base/number_text.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/sim/metrics.hpp"
#include "palmbots/sim/radio.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// What the warnings depend on, besides the spec.
struct CarryEnd {
  const Metrics& metrics;
  const LinkTotals& links;
  PerSide<MessageKind> awaits;  // what each robot waits for, if it waits
  PerSide<bool> stopped;        // whether each robot is commanded to stand
};

// For how long a robot has been waiting at the end of a carry [s].
inline double waiting_at_end(const Metrics& metrics, std::size_t side, double period) {
  const double since = double(metrics.waits_since[side]) * period;
  return std::max(metrics.time_ticks * period - since, 0.0);
}

namespace detail {

inline constexpr double patience = 2.0;  // for an answer, besides the delay of the radio [s]

inline std::string robot_text(std::size_t side) {
  return side == left ? "the left robot" : "the right robot";
}

inline std::string with_article(MessageKind kind) {
  const std::string name = name_of(kind);
  if (name.empty()) return "a message";
  const bool is_vowel = std::string("AEIOU").find(name[0]) != std::string::npos;
  return (is_vowel ? "an " : "a ") + name;
}

// Why a message may be missing; empty: none is. A rejected one may be a mere copy.
inline const char* missing_reason(const Spec& spec, const LinkTotals& links) {
  if (links.lost > 0) return "was lost";
  std::uint32_t rejected = 0;
  for (const LinkCounts& link : links.links) rejected += link.rejected;
  if (rejected == 0) return "";
  if (spec.corruption > 0) return "arrived damaged";
  bool reboots = spec.random_reboots > 0;
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    const FaultKind kind = spec.faults[i].kind;
    reboots = reboots || kind == FaultKind::reboot || kind == FaultKind::freeze;
  }
  return reboots ? "had no session after a reboot" : "";
}

}  // namespace detail

// `stops_in_silence`: of the controller (ControllerInfo).
inline std::vector<std::string> warnings_after(const Spec& spec, const CarryEnd& end,
                                               bool stops_in_silence) {
  std::vector<std::string> lines;
  const Metrics& m = end.metrics;
  // Robots that stand have made the carry time out. Others that still wait after a message was lost
  // would wait forever.
  const bool missed = *detail::missing_reason(spec, end.links) != 0;
  for (const std::size_t side : {left, right}) {
    const std::string robot = detail::robot_text(side);
    if (stops_in_silence) {
      if (m.outcome != Outcome::stalled || !end.stopped[side]) continue;
      lines.push_back(robot +
                      " stands: it hears nothing fresh from its partner, or waits for p = 0");
    } else if (missed &&
               waiting_at_end(m, side, spec.period) > detail::patience + 2 * spec.longest_delay()) {
      lines.push_back(robot + " has waited since " +
                      fixed_text(double(m.waits_since[side]) * spec.period, 1) + " s for " +
                      detail::with_article(end.awaits[side]) + " that does not arrive (a message " +
                      detail::missing_reason(spec, end.links) + ")");
    }
  }
  for (const std::size_t side : {left, right}) {
    if (!m.limit_cycle[side]) continue;
    lines.push_back("limit cycle: " + detail::robot_text(side) +
                    "'s corrections follow each other with alternating sign");
  }
  const auto truncated = [&](std::uint32_t count, std::size_t listed, const char* what) {
    if (count > listed) {
      lines.push_back(std::to_string(count) + " " + what + "; only the first are listed");
    }
  };
  truncated(m.corrections, max_corrections, "corrections");
  truncated(m.contact_events, max_contact_events, "contact events");
  return lines;
}

}  // namespace palmbots
