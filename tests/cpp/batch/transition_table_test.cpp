// SPDX-License-Identifier: Apache-2.0
// Every table in both engines: what one robot does on any input, 64 pairs do side by side.
#include "palmbots/control/transition_table.hpp"

#include <cstddef>
#include <deque>

#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_distributed.hpp"
#include "palmbots/batch/bitslice_resilient.hpp"
#include "support/check.hpp"

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

void distributed_on_every_input() {
  const auto table = spread<Distributed>();
  for (int s = 0; s < Distributed::states; ++s) {
    for (int k = 0; k < Distributed::Key::count; ++k) {
      const auto state = static_cast<Distributed::State>(s);
      const auto key = Distributed::Key::of(k);
      CHECK(key.number() == k);
      const Distributed::Entry entry = table.at(state, key);
      for (const std::size_t side : {left, right}) {
        const RobotMask self = one_of(side);
        const auto seen = observed(key.in.sign, key.in.palm_at_target, self);
        BitslicedMessage<2> message;
        message.insert(self, key.in.message);
        BitslicedTable<Distributed> robots;
        robots.insert(self, state);
        const RobotMask reads =
            robots.where_each([&](Distributed::State at) { return Distributed::reads(at, seen); });
        BitslicedMessage<2> sent;
        robots.step(
            self,
            [&](const Distributed::Row& row) {
              return Distributed::fits<RobotMask>(row, seen, message);
            },
            [&](const Distributed::Row& row, RobotMask whose) { sent.insert(whose, row.send); });
        CHECK(state_of(robots, side) == entry.next);
        CHECK(is_set(sent.is(entry.send), side));
        CHECK((is_set(reads & message.any(), side)) == entry.read);
      }
    }
  }
}

struct HeardBits {
  MessageKind kind;
  RobotMask self;
  RobotMask is(MessageKind that) const { return when(kind == that, self); }
};

void resilient_on_every_input() {
  const auto table = spread<Resilient>();
  for (int s = 0; s < Resilient::states; ++s) {
    for (int k = 0; k < Resilient::Key::count; ++k) {
      const auto state = static_cast<Resilient::State>(s);
      const auto key = Resilient::Key::of(k);
      CHECK(key.number() == k);
      for (const std::size_t side : {left, right}) {
        const RobotMask self = one_of(side);
        const auto seen = observed(key.sign, false, self);
        const Resilient::Conditions<RobotMask> met{
            when(key.met.settled, self), when(key.met.released, self), when(key.met.yields, self),
            when(key.met.held, self)};
        BitslicedTable<Resilient> robots;
        robots.insert(self, state);
        robots.step(
            self,
            [&](const Resilient::Row& row) {
              return Resilient::fits<RobotMask>(row, seen, HeardBits{key.heard, self}, met);
            },
            [](const Resilient::Row&, RobotMask) {});
        CHECK(state_of(robots, side) == table.at(state, key));
      }
    }
  }
}

// The counters of a robot, one step after the other, over random histories that reach every age.
void leases_count_alike() {
  const LeaseLimits<std::uint16_t> limits{5, 21, 33, 6, 4};
  LeaseLimits<BitslicedCounter> bits_limits;
  const RobotMask self = one_of(right);
  bits_limits.beacon.assign(self, limits.beacon);
  bits_limits.stale.assign(self, limits.stale);
  bits_limits.hold.assign(self, limits.hold);
  bits_limits.braking.assign(self, limits.braking);
  bits_limits.long_ago.assign(self, limits.long_ago);
  LeaseState<bool, std::uint16_t> one{.stopped = true, .partner_stopped = true};
  LeaseState<RobotMask, BitslicedCounter> many;
  many.stopped = many.partner_stopped = self;
  std::uint32_t starts = 0;
  for (std::uint32_t tick = 0; tick < 200000; ++tick) {
    const Words words = draw(5, tick / 3, 0);
    const auto chance = [&](std::size_t word, std::uint32_t bit, std::uint32_t of) {
      return (words[word] >> bit) % of == 0;
    };
    one.pass(1, limits);
    many.pass(1, bits_limits);
    if (chance(0, 0, 9)) {
      const auto age = static_cast<std::uint16_t>((words[0] >> 8) % 26);
      one.age = age < limits.stale ? age : limits.stale;
      many.age.assign(self, age);
      one.partner_stopped = chance(0, 16, 2);
      one.partner_ready = chance(0, 20, 2);
      many.partner_stopped = when(one.partner_stopped, self);
      many.partner_ready = when(one.partner_ready, self);
    }
    const bool run = !chance(1, 0, 7);
    const bool moves = chance(1, 4, 3);
    const bool turned = chance(1, 8, 2);
    const bool entered = run && chance(1, 12, 11);
    const bool asks = chance(2, 0, 5);
    const bool centred = chance(2, 8, 2);
    const bool says_other = entered && chance(2, 12, 2);
    const bool silence = one.silence(limits);
    const RobotMask silent = many.silence(bits_limits);
    CHECK(is_set(silent, right) == silence);
    if (!run) continue;
    const auto a = one.conditions<Resilient::Conditions<bool>>(run, moves, turned, silence, limits);
    const auto b = many.conditions<Resilient::Conditions<RobotMask>>(
        self, when(moves, self), when(turned, self), silent, bits_limits);
    CHECK(a.settled == is_set(b.settled, right) && a.released == is_set(b.released, right) &&
          a.held == is_set(b.held, right));
    const bool before = one.stopped;
    const auto x = one.finish(run, entered, asks, centred, says_other, silence, limits);
    const auto y = many.finish(self, when(entered, self), when(asks, self), when(centred, self),
                               when(says_other, self), silent, bits_limits);
    CHECK(x.ready == is_set(y.ready, right) && x.send == is_set(y.send, right));
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
  distributed_on_every_input();
  resilient_on_every_input();
  leases_count_alike();
  stations_on_every_input();
}
