// SPDX-License-Identifier: Apache-2.0
// Neighbours of the sign controllers: the shipped tables with one thing changed. Reads a Spec from
// standard input. Prints drops, other carries that were not delivered, the mean time [s] and the mean
// number of messages of a carry.
//   bench_sign_neighbours NAME CARRIES < spec
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/sim/carry.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"
#include "support/read_spec.hpp"

namespace {

using namespace palmbots;

// The shipped outputs, each changed by a function.
template <class Table>
constexpr auto changed(auto change) {
  std::array<TableOutput, Table::states> made{};
  std::ranges::copy(Table::outputs, made.begin());
  for (int s = 0; s < Table::states; ++s) {
    change(static_cast<typename Table::State>(s), made[static_cast<std::size_t>(s)]);
  }
  return made;
}

// A robot that does not brake here keeps its correction, and so moves slowly backwards or forwards.
constexpr void reverse(TableOutput& output) {
  output.command.stop = output.command.stop || output.brakes;
  output.brakes = false;
}

// No robot brakes.
struct Reverses : SharedSign {
  static constexpr auto outputs =
      changed<SharedSign>([](State, TableOutput& output) { reverse(output); });
};

// Only a robot with this palm brakes.
template <Palm palm>
struct StandsWith : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State, TableOutput& output) {
    if (output.command.palm != palm) reverse(output);
  });
};

// Only this one brakes: the follower if both contacts are outward, or the leader if both are inward.
template <bool follower>
struct OneStands : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    constexpr EnumSet<State> of_follower = {State::follow_out_steep, State::follow_out_shallow};
    if (of_follower.has(state) != follower) reverse(output);
  });
};

// A leader that brakes does not while it announces its next palm.
struct StandsShorter : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    constexpr EnumSet<State> ends = {State::lead_in_steep_ends, State::lead_in_shallow_ends};
    if (ends.has(state)) reverse(output);
  });
};

// The braking robot stands on where its partner is centred again and its own contact is not.
struct StandsLonger : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    if (EnumSet<State>{State::own_out, State::own_in}.has(state)) {
      output.command.stop = true;
      output.command.move = Move::hold;
      output.brakes = true;
    }
  });
};

// While one robot stands, its partner keeps the nominal speed.
struct PartnerHolds : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    constexpr EnumSet<State> partners = {State::lead_out_steep,      State::lead_out_shallow,
                                         State::lead_out_steep_ends, State::lead_out_shallow_ends,
                                         State::follow_in_steep,     State::follow_in_shallow};
    if (partners.has(state)) output.command.move = Move::hold;
  });
};

// A robot whose contact is centred leaves the correction to its partner.
struct HelperHolds : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    if (EnumSet<State>{State::help_out, State::help_in}.has(state))
      output.command.move = Move::hold;
  });
};

// At opposite signs both robots keep the nominal speed, instead of moving away.
struct ApartHolds : SharedSign {
  static constexpr auto outputs = changed<SharedSign>([](State state, TableOutput& output) {
    if (state == State::apart_in) output.command.move = Move::hold;
  });
};

// Turns of another length [tenths].
template <int tenths>
struct Turns : SharedSign {
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    const double shipped = SharedSign::seconds(limit, timing);
    return limit == Limit::turn ? (shipped + timing.delay) * tenths / 10 - timing.delay : shipped;
  }
};

// A robot of `silent` stops earlier or later [tenths].
template <int tenths>
struct Patience : Silent {
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    const double shipped = Silent::seconds(limit, timing);
    return limit == Limit::patience ? shipped * tenths / 10 : shipped;
  }
};

template <class Table>
void run(const Spec& spec, std::uint64_t carries) {
  std::uint64_t dropped = 0;
  std::uint64_t delivered = 0;
  double time = 0;
  double messages = 0;
  for (std::uint64_t seed = 0; seed < carries; ++seed) {
    auto team = TableTeamMaker<Table>{}(spec, seed);
    Carry<double, decltype(team), NoRecorder> carry(spec, seed, std::move(team), NoRecorder{});
    carry.run();
    messages += double(carry.team().link_totals.sent);
    dropped += carry.metrics().outcome == Outcome::dropped ? 1 : 0;
    if (carry.metrics().outcome != Outcome::delivered) continue;
    ++delivered;
    time += carry.metrics().time_ticks * spec.period;
  }
  std::printf("%llu %llu %.3f %.1f\n", static_cast<unsigned long long>(dropped),
              static_cast<unsigned long long>(carries - dropped - delivered),
              time / double(delivered), messages / double(carries));
}

struct Neighbour {
  std::string_view name;
  void (*run)(const Spec&, std::uint64_t);
};
constexpr Neighbour neighbours[] = {
    {"shared-sign", run<SharedSign>},
    {"reverses", run<Reverses>},
    {"stands-if-steep", run<StandsWith<Palm::steep>>},
    {"stands-if-shallow", run<StandsWith<Palm::shallow>>},
    {"follower-stands", run<OneStands<true>>},
    {"leader-stands", run<OneStands<false>>},
    {"stands-shorter", run<StandsShorter>},
    {"stands-longer", run<StandsLonger>},
    {"partner-holds", run<PartnerHolds>},
    {"helper-holds", run<HelperHolds>},
    {"apart-holds", run<ApartHolds>},
    {"turns-0.8", run<Turns<8>>},
    {"turns-1.5", run<Turns<15>>},
    {"turns-2", run<Turns<20>>},
    {"turns-never", run<Turns<10000>>},
    {"silent", run<Silent>},
    {"silent-patience-0.4", run<Patience<4>>},
    {"silent-patience-2", run<Patience<20>>},
    {"silent-patience-4", run<Patience<40>>},
};

}  // namespace

int main(int count, char** words) {
  const auto spec = read_spec();
  if (count != 3 || !spec) return 2;
  for (const Neighbour& one : neighbours) {
    if (one.name != words[1]) continue;
    one.run(*spec, std::strtoull(words[2], nullptr, 10));
    return 0;
  }
  return 2;
}
