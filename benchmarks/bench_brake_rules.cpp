// SPDX-License-Identifier: Apache-2.0
// Variants of shared-sign that brake earlier: also where only one contact is off centre, once it has
// been so for some time. Reads a Spec from standard input and prints drops and mean time [s].
//   bench_brake_rules PATIENCE_S CARRIES < spec
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"
#include "support/read_spec.hpp"

namespace {

using namespace palmbots;

using Shared = SharedSign;
using Before = Shared::State;

// The states of shared-sign in which a robot hears its partner, one for a robot that does not, and
// for each state in which one contact is off centre a second one, in which a robot brakes.
enum class State : std::uint8_t {};
constexpr std::array off{Before::own_out, Before::help_out, Before::help_in, Before::own_in};
constexpr std::size_t alone = static_cast<std::size_t>(Before::alone_centred);
constexpr std::size_t states = alone + 1 + off.size();
constexpr State state(std::size_t number) { return static_cast<State>(number); }

// The place in `off`; off.size(): it is none of these.
constexpr std::size_t place(Before wanted) {
  std::size_t i = 0;
  while (i < off.size() && off[i] != wanted) ++i;
  return i;
}
// The state of shared-sign whose rows a state has.
constexpr Before origin(std::size_t number) {
  return number <= alone ? static_cast<Before>(number) : off[number - alone - 1];
}
constexpr bool is_silent(const TableRow<Before>& row) {
  return row.heard == MessageSet(MessageKind::none);
}
constexpr std::size_t count_rows() {
  std::size_t n = 0;
  for (const auto& row : Shared::rows) {
    if (!is_silent(row)) n += place(row.next) < off.size() ? 2 : 1;
  }
  return n;
}
constexpr int patience_limit = 2;
constexpr auto make_outputs() {
  std::array<TableOutput, states> made{};
  for (std::size_t s = 0; s < states; ++s) {
    made[s] = Shared::outputs[static_cast<std::size_t>(origin(s))];
    if (s > alone) made[s].brakes = true;
    if (s < alone && place(origin(s)) < off.size()) made[s].limit = patience_limit;
  }
  return made;
}
// Of a row into a state of `off` two are made: one into its braking state, and one into itself. The
// robot that brakes is that of shared-sign: the follower if the contact is outward, else the leader.
constexpr auto make_rows() {
  std::array<TableRow<State>, count_rows()> made{};
  std::size_t n = 0;
  for (const auto& row : Shared::rows) {
    if (is_silent(row)) continue;
    EnumSet<State> from;
    for (std::size_t s = 0; s < states; ++s) {
      if (row.from.has(origin(s))) from.bits |= 1U << s;
    }
    const auto next = static_cast<std::size_t>(row.next);
    const std::size_t i = place(row.next);
    if (i < off.size()) {
      const State brakes = state(alone + 1 + i);
      const If who = Shared::outputs[next].command.move == Move::away ? If::follows : If::leads;
      made[n++] = {state(next), row.p, row.heard, {If::timed_out, who}, brakes};
      from = from - brakes;
    }
    made[n++] = {from, row.p, row.heard, row.when, state(next)};
  }
  return made;
}
double patience = 0;  // how long a contact is off centre before a robot brakes [s]

struct EarlyBrake {
  using State = ::State;
  static constexpr State initial = state(alone);
  static constexpr int states = static_cast<int>(::states);
  enum class Limit : std::uint8_t { turn, notice, off_centre };
  static constexpr std::size_t limits = 3;
  static_assert(static_cast<int>(Shared::Limit::turn) == 0);
  static_assert(static_cast<int>(Shared::Limit::notice) == 1);
  static double seconds(Limit limit, const TableTiming& timing) {
    if (limit == Limit::off_centre) return patience;
    return Shared::seconds(static_cast<Shared::Limit>(limit), timing);
  }
  static constexpr bool talks = true;
  static constexpr auto outputs = make_outputs();
  static constexpr auto rows = make_rows();
};

}  // namespace

int main(int count, char** words) {
  const auto given = read_spec();
  if (count != 3 || !given) return 2;
  const Spec& spec = *given;
  patience = std::atof(words[1]);
  const long carries = std::atol(words[2]);
  long dropped = 0;
  double time = 0;
  for (long seed = 0; seed < carries; ++seed) {
    auto team = TableTeamMaker<EarlyBrake>{}(spec, static_cast<std::uint64_t>(seed));
    Carry<double, decltype(team), TraceRecorder> carry(spec, static_cast<std::uint64_t>(seed),
                                                       std::move(team), TraceRecorder(false));
    carry.run();
    const bool delivered = carry.metrics().outcome == Outcome::delivered;
    dropped += carry.metrics().outcome == Outcome::dropped ? 1 : 0;
    if (delivered) time += carry.metrics().time_ticks * spec.period;
  }
  std::printf("%ld %.4f\n", dropped, time / static_cast<double>(carries - dropped));
}
