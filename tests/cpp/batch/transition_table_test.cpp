// SPDX-License-Identifier: Apache-2.0
// Every table in both engines: what one robot does on any input, 64 pairs do side by side.
#include "palmbots/control/transition_table.hpp"

#include <cstddef>
#include <deque>
#include <iterator>

#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_table_team.hpp"
#include "palmbots/control/distributed.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "support/check.hpp"
#include "support/third_table.hpp"

using namespace palmbots;

namespace {

// The robot whose bit is looked at; all others stay where they are not in any state.
RobotMask one_of(std::size_t side) {
  RobotMask mask{};
  mask[side] = CarryMask{1} << 37;
  return mask;
}
bool is_set(RobotMask mask, std::size_t side) { return (mask[side] >> 37 & 1) != 0; }
RobotMask when(bool truth, RobotMask mask) { return truth ? mask : RobotMask{}; }

Observation<RobotMask> observed(Sign sign, bool palm_at_target, RobotMask mask) {
  return {when(sign == Sign::positive, mask), when(sign == Sign::negative, mask),
          when(palm_at_target, mask)};
}

template <class Robot>
typename Robot::State state_of(const BitslicedTable<Robot>& robots, std::size_t side) {
  int found = -1;
  for (int s = 0; s < Robot::states; ++s) {
    if (!is_set(robots.in(static_cast<typename Robot::State>(s)), side)) continue;
    CHECK(found < 0);
    found = s;
  }
  CHECK(found >= 0);
  return static_cast<typename Robot::State>(found);
}

struct HeardBits {
  MessageKind kind;
  RobotMask self;
  RobotMask is(MessageKind that) const { return when(kind == that, self); }
};

// What a robot goes to, sends and reads in every state, with every sign and message, and with all
// conditions that its rows can name.
template <class Table>
void table_on_every_input() {
  using Robot = TableRobot<Table>;
  TableRowMasks<Table> masks;  // made at run time, so that the sanitizers see how
  for (int n = 0; n < Table::states * 3 * 64; ++n) {
    const auto state = static_cast<typename Table::State>(n % Table::states);
    const auto sign = static_cast<Sign>(n / Table::states % 3 - 1);
    const int c = n / Table::states / 3;
    const auto bit = [&](int k) { return (c >> k & 1) != 0; };
    const TableConditions<bool> one{bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
    for (const MessageKind message : TableMessages<Table>::list) {
      const int row = masks.row(state, sign, message, one);
      for (const std::size_t side : {left, right}) {
        const RobotMask self = one_of(side);
        const auto seen = observed(sign, one.turned, self);
        const TableConditions<RobotMask> many{when(bit(0), self), when(bit(1), self),
                                              when(bit(2), self), when(bit(3), self),
                                              when(bit(4), self), when(bit(5), self)};
        BitslicedTable<Robot> robots;
        robots.insert(self, state);
        int ran = masks.none;
        robots.step(
            self,
            [&](const typename Robot::Row& r) {
              return fits_in_table<Table, RobotMask>(r, seen, HeardBits{message, self}, many);
            },
            [&](const typename Robot::Row& r, RobotMask whose) {
              if (is_set(whose, side)) ran = static_cast<int>(&r - std::data(Table::rows));
            });
        CHECK(ran == row);
        CHECK(state_of(robots, side) == (row == masks.none ? state : masks.next(row)));
      }
      if (row == masks.none) continue;
      const TableRow<typename Table::State>& ran = std::data(Table::rows)[row];
      CHECK(masks.send(row) == ran.send && masks.reads(row) == (ran.heard != any_message));
    }
  }
}

// What is_sound() refuses.
struct LimitThatIsNotThere : ThirdTable {
  static constexpr TableOutput outputs[states] = {
      {' ', {}, M::ack},    {' ', {}, M::ack, 0}, {' ', {}, M::ack},
      {' ', {}, M::ack, 1}, {' ', {}, M::ack, 2},
  };
};
struct StateWithoutWord : ThirdTable {
  static constexpr TableOutput outputs[states] = {
      {' ', {}, M::ack},    {' ', {}, M::ack, 0}, {' ', {}},
      {' ', {}, M::ack, 1}, {' ', {}, M::ack, 1},
  };
};
struct RowThatSendsBesidesBeacons : ThirdTable {
  static constexpr TableRow<State> rows[] = {{S::calm, P::any, any_message, {}, S::asks, M::ack}};
};
struct RowThatWaitsForNoLimit : ThirdTable {
  static constexpr TableRow<State> rows[] = {
      {S::waits, P::any, any_message, If::timed_out, S::calm}};
};

void unsound_tables_are_refused() {
  CHECK(is_sound<ThirdTable>() && is_sound<Distributed>() && is_sound<Resilient>());
  CHECK(is_sound<Silent>() && is_sound<SharedSign>());
  CHECK(!is_sound<LimitThatIsNotThere>());
  CHECK(!is_sound<StateWithoutWord>());
  CHECK(!is_sound<RowThatSendsBesidesBeacons>());
  CHECK(!is_sound<RowThatWaitsForNoLimit>());
  CHECK(!TableRobot<Distributed>().stopped());  // without a clock it never waits to be joined
}

// What a robot commands and says.
struct OutputBits {
  bool moves, asks;
  RobotMask self;
  TableOutput output() const {
    return {' ',
            {Palm::steep, moves ? Move::away : Move::hold},
            asks ? MessageKind::tilt_up : MessageKind::raised};
  }
};
struct OneRobot : OutputBits {
  template <class Predicate>
  bool who(Predicate predicate) const {
    return predicate(output());
  }
};
struct ManyRobots : OutputBits {
  template <class Predicate>
  RobotMask who(Predicate predicate) const {
    return when(predicate(output()), self);
  }
};

// The memory of a robot, one step after the other, over random histories that reach every age.
void leases_count_alike() {
  using One = ResilientMemory<bool, std::uint16_t>;
  using Many = ResilientMemory<RobotMask, BitslicedCounter>;
  const One::Limits limits{21, 6, 4};
  const RobotMask self = one_of(right);
  Many::Limits many_limits;
  for (std::size_t k = 0; k < limits.size(); ++k) many_limits[k].assign(self, limits[k]);
  One one;
  Many many;
  one.boot(true, limits);
  many.boot(self, many_limits);
  std::uint16_t age = 0;
  BitslicedCounter ages;
  std::uint32_t starts = 0;
  for (std::uint32_t tick = 0; tick < 200000; ++tick) {
    const Words words = draw(5, tick / 3, 0);
    const auto chance = [&](std::size_t word, std::uint32_t bit, std::uint32_t of) {
      return (words[word] >> bit) % of == 0;
    };
    advance(age, 1, limits[One::stale]);
    advance(ages, 1, many_limits[One::stale]);
    one.pass(1, limits);
    many.pass(1, many_limits);
    if (chance(0, 0, 9)) {
      const auto heard = static_cast<std::uint16_t>((words[0] >> 8) % 26);
      age = heard < limits[One::stale] ? heard : limits[One::stale];
      ages.assign(self, heard);
      const bool rests = chance(0, 16, 2);
      const bool is_ready = chance(0, 20, 2);
      one.hear(true, rests, is_ready);
      many.hear(self, when(rests, self), when(is_ready, self));
    }
    if (chance(1, 0, 7)) continue;  // it does not run
    const OutputBits output{chance(1, 4, 3), chance(2, 0, 5), self};
    const bool turned = chance(1, 8, 2);
    const bool centred = chance(2, 8, 2);
    const bool fresh = age < limits[One::stale];
    TableConditions<bool> a{.turned = turned};
    TableConditions<RobotMask> b{.turned = when(turned, self)};
    one.meet(a, true, OneRobot{output}, age, fresh, limits);
    many.meet(b, self, ManyRobots{output}, ages, when(fresh, self), many_limits);
    CHECK(a.settled == is_set(b.settled, right) && a.released == is_set(b.released, right));
    const bool before = one.stopped;
    const auto x = one.finish(true, OneRobot{output}, centred, age, fresh, limits);
    const auto y = many.finish(self, ManyRobots{output}, when(centred, self), ages,
                               when(fresh, self), many_limits);
    CHECK(x.ready == is_set(y.ready, right) && x.is_news == is_set(y.is_news, right));
    CHECK(one.stopped == is_set(many.stopped, right));
    starts += before && !one.stopped ? 1 : 0;
  }
  CHECK(starts > 1000);
}

// From every case and stage that a station gets into, with every pair of reports.
void stations_on_every_input() {
  struct Node {
    Centralized one;
    BitslicedStations many;
  };
  constexpr Sign signs[] = {Sign::negative, Sign::zero, Sign::positive};
  const auto report = [&](int n) {
    return Centralized::Report{signs[n % 3], static_cast<Palm>(n / 3 % 2), n / 6 % 2 != 0};
  };
  Node start;
  start.many.insert(37);
  std::deque<Node> open{start};
  std::deque<Centralized> known{start.one};
  while (!open.empty()) {
    const Node node = open.front();
    open.pop_front();
    for (int n = 0; n < 144; ++n) {
      const Centralized::Report reports[2] = {report(n % 12), report(n / 12)};
      BitslicedReport in;
      for (const std::size_t side : {left, right}) {
        const CarryMask self = CarryMask{1} << 37;
        in.positive[side] = reports[side].sign == Sign::positive ? self : 0;
        in.negative[side] = reports[side].sign == Sign::negative ? self : 0;
        in.shallow[side] = reports[side].palm == Palm::shallow ? self : 0;
        in.palm_at_target[side] = reports[side].palm_at_target ? self : 0;
      }
      Node next = node;
      const Centralized::Output out = next.one.step(reports);
      const BitslicedCommand commands = next.many.step(CarryMask{1} << 37, in);
      for (const std::size_t side : {left, right}) {
        const Command& command = out.command[side];
        CHECK(is_set(commands.shallow, side) == (command.palm == Palm::shallow));
        CHECK(is_set(commands.away, side) == (command.move == Move::away));
        CHECK(is_set(commands.closer, side) == (command.move == Move::closer));
      }
      bool is_new = true;
      for (const Centralized& old : known) is_new = is_new && !(old == next.one);
      if (!is_new) continue;
      known.push_back(next.one);
      open.push_back(next);
    }
  }
  CHECK(known.size() > 20);
}

}  // namespace

int main() {
  table_on_every_input<Distributed>();
  table_on_every_input<Resilient>();
  table_on_every_input<Silent>();
  table_on_every_input<SharedSign>();
  table_on_every_input<ThirdTable>();
  unsound_tables_are_refused();
  leases_count_alike();
  stations_on_every_input();
}
