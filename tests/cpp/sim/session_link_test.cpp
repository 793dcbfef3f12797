// SPDX-License-Identifier: Apache-2.0
// Sessions on the simulated radio. Robots, and a station, that exchange bytes between real endpoints
// over the same channel command, send and count the same in every tick as the teams of the
// simulator, with losses, copies, overtaking, damage, collisions, reboots and freezes.
#include "palmbots/sim/session_link.hpp"

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/distributed_team.hpp"
#include "palmbots/wire/endpoint.hpp"
#include "support/check.hpp"
#include "support/wire_packets.hpp"

namespace palmbots {

// What the channel of the endpoints carries.
struct Envelope {
  wire::Bytes bytes;
};

// For the channel, which damages packets: what a link to the station carries.
struct EnvelopeToStation : Envelope {};
template <>
inline constexpr bool goes_to_station<EnvelopeToStation> = true;

static wire::Packet packet_of(const Envelope& envelope, const wire::PacketHeader& header) {
  return wire::decode(envelope.bytes, wire::test_key, wire::test_pair, header.receiver).packet;
}

}  // namespace palmbots

using namespace palmbots;
namespace wire = palmbots::wire;
using wire::Endpoint;
using wire::PacketKind;
using wire::Role;
using wire::Verdict;

namespace {

// A channel and faults under which the verdicts differ, or do not.
struct Condition {
  Channel channel = Channel::of(0.03, 0, 0, 0.01);
  Spec spec{};
  bool boots = false;    // hellos are to be expected
  bool repeats = false;  // packets that are stale and not damaged are to be expected

  Faults faults(std::uint64_t seed) const { return Faults::of(spec, seed); }
};

void add_fault(Spec& spec, FaultKind kind, std::uint32_t side, double at, double lasts) {
  spec.faults[spec.fault_count++] = {kind, side, at, lasts, 0, 0};
}

std::vector<Condition> conditions() {
  Condition plain;
  plain.spec.period = 0.01;
  plain.spec.watchdog = 0.05;
  Condition lossy = plain;
  lossy.channel.loss_words = Channel::words_of(0.2);
  Condition jittery = lossy;
  jittery.channel.jitter_ticks = 5;
  Condition copying = jittery;
  copying.channel.duplicate_words = Channel::words_of(0.2);
  copying.repeats = true;
  Condition overtaking = copying;
  overtaking.channel.reorders = true;
  Condition damaged = overtaking;
  damaged.channel.corrupt_words = Channel::words_of(0.1);
  damaged.channel.airtime_ticks = 0.3;
  Condition scripted = plain;
  scripted.repeats = true;
  for (const std::uint32_t n : {1U, 2U, 5U, 6U}) {
    scripted.channel.message_faults[scripted.channel.message_fault_count++] = {
        n % 2, n, MessageEffect::copied, 40 * n};
  }
  Condition rebooting = plain;
  rebooting.boots = true;
  add_fault(rebooting.spec, FaultKind::reboot, left, 0.0, 0.1);  // before anybody was heard
  add_fault(rebooting.spec, FaultKind::reboot, right, 2.0, 0.3);
  add_fault(rebooting.spec, FaultKind::reboot, left, 2.2, 0.3);  // both at once
  add_fault(rebooting.spec, FaultKind::freeze, left, 4.0, 0.03);
  add_fault(rebooting.spec, FaultKind::freeze, right, 5.0, 0.5);  // ends in a boot
  add_fault(rebooting.spec, FaultKind::station, left, 6.0, 0.4);
  add_fault(rebooting.spec, FaultKind::reboot, right, 6.1, 0.1);
  add_fault(rebooting.spec, FaultKind::reboot, right, 7.0, 0.01);
  Condition all = damaged;
  all.spec = rebooting.spec;
  all.boots = true;
  Condition rebooting_slowly = rebooting;
  rebooting_slowly.channel.latency_ticks = 20;
  rebooting_slowly.channel.loss_words = Channel::words_of(0.1);
  return {plain,   lossy,    jittery,   copying, overtaking,
          damaged, scripted, rebooting, all,     rebooting_slowly};
}

// An endpoint that notes whether it has to answer.
struct End {
  Role self;
  std::uint32_t epoch = 1;
  Endpoint endpoint{identity(), 1};
  PerSide<bool> owes{};  // to a robot, by its side; a robot owes its one partner owes[0]

  explicit End(Role role) : self(role) {}
  wire::Identity identity() const { return {wire::test_key, wire::test_pair, self}; }

  void boot() {
    endpoint = Endpoint(identity(), ++epoch);
    owes = {};
  }

  Envelope write(Role to, PacketKind kind, const wire::Payload& payload) {
    Envelope envelope{};
    CHECK(endpoint.send(to, kind, payload, envelope.bytes));
    return envelope;
  }

  // Returns the packet if it is to be acted upon, and counts it otherwise. An empty packet is of the
  // kind hello.
  wire::Packet read(const Envelope& envelope, LinkCounts& counts, bool& must_answer) {
    const wire::Decoded decoded = endpoint.receive(envelope.bytes);
    const bool accepted = decoded.verdict == Verdict::accepted;
    if (decoded.verdict == Verdict::no_session) must_answer = true;
    counts.rejected += accepted ? 0 : 1;
    return accepted ? decoded.packet : wire::Packet{};
  }
};

// One hello each way, beside the radio.
void shake_hands(End& one, End& other) {
  const Envelope there = one.write(other.self, PacketKind::hello, wire::up);
  CHECK(other.endpoint.receive(there.bytes).verdict == Verdict::no_session);
  const Envelope back = other.write(one.self, PacketKind::hello, wire::up);
  CHECK(one.endpoint.receive(back.bytes).verdict == Verdict::accepted);
}

// A robot that says and commands something new in many ticks, depending on all that it has heard.
struct Talker {
  std::uint32_t heard = 1;
  Distributed::Output step(Distributed::Input in) {
    heard = heard * 1664525U + 1013904223U + static_cast<std::uint32_t>(in.message);
    const std::uint32_t luck = heard >> 16;
    const auto send = static_cast<MessageKind>(luck % 8 < 4 ? luck % 4 : 0);
    return {{Palm::shallow, static_cast<Move>(luck / 8 % 3)}, send, luck / 32 % 4 != 0};
  }
  Distributed::StateOutput now() const { return Distributed::outputs[0]; }
};

// Two robots of these controllers, on endpoints.
template <class Controller>
class Pair {
 public:
  LinkTotals totals{};
  PerSide<MessageKind> found{};  // by the robots in the last tick

  Pair(const Condition& condition, std::uint64_t seed)
      : radio_(condition.channel, seed, right), faults_(condition.faults(seed)) {
    shake_hands(ends_[left], ends_[right]);
  }

  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                        std::vector<SentMessage>& log) {
    PerSide<MessageKind> says{};
    PerSide<bool> sends{};
    found = {};
    for (const std::size_t side : {left, right}) {
      const ProgramState state = monitor_.program_state(faults_, tick, side);
      if (state == ProgramState::frozen) continue;
      if (state == ProgramState::off) {
        air_[side].drop(tick);
        inbox_[side].clear();
        commands_[side] = switched_off(commands_[side]);
        continue;
      }
      End& end = ends_[side];
      if (state == ProgramState::booting) {
        end.boot();
        controllers_[side] = Controller{};
      }
      while (const Envelope* envelope = air_[side].oldest(tick)) {
        const wire::Packet packet = end.read(*envelope, totals.links[other(side)], end.owes[0]);
        if (packet.kind == PacketKind::state)
          inbox_[side].push_back(wire::state_of(packet.payload).word);
        air_[side].pop();
      }
      const MessageKind first = inbox_[side].empty() ? MessageKind::none : inbox_[side].front();
      found[side] = first;
      const auto out =
          controllers_[side].step({sensed[side].sign, first, sensed[side].palm_at_target});
      if (out.read && first != MessageKind::none) inbox_[side].pop_front();
      commands_[side] = out.command;
      says[side] = out.send;
      sends[side] = out.send != MessageKind::none || end.owes[0];
    }
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      End& end = ends_[side];
      const bool is_hello = says[side] == MessageKind::none;
      const auto to = static_cast<Role>(other(side));
      end.endpoint.skip_to(to, tick + 2);  // between robots the numbers are control ticks
      const wire::Payload payload = wire::packet_of(says[side], {}).payload;
      const Envelope envelope = is_hello ? end.write(to, PacketKind::hello, wire::up)
                                         : end.write(to, PacketKind::state, payload);
      end.owes[0] = false;
      const std::uint32_t received =
          radio_.post(air_[other(side)], tick, envelope, side, side, collides, totals);
      log.push_back({tick, received, static_cast<std::uint8_t>(side),
                     static_cast<std::uint8_t>(other(side)), says[side], is_hello});
    }
    return commands_;
  }

  std::uint32_t count(Verdict verdict) const {
    return ends_[left].endpoint.count(verdict) + ends_[right].endpoint.count(verdict);
  }

 private:
  PerSide<End> ends_{End(Role::left), End(Role::right)};
  PerSide<Controller> controllers_{};
  PerSide<std::deque<MessageKind>> inbox_;
  PerSide<Link<Envelope>> air_;  // to each robot
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

// A station and two robots, on endpoints.
class Triple {
 public:
  LinkTotals totals{};

  Triple(const Condition& condition, std::uint64_t seed)
      : radio_(condition.channel, seed, right), faults_(condition.faults(seed)) {
    for (End& robot : robots_) shake_hands(robot, station_);
  }

  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed) {
    const bool lost = faults_.station_lost(tick);
    PerSide<bool> runs{};
    for (const std::size_t side : {left, right}) {
      const ProgramState state = monitor_.program_state(faults_, tick, side);
      runs[side] = state == ProgramState::running || state == ProgramState::booting;
      if (state == ProgramState::off) {
        down_[side].drop(tick);
        commands_[side] = switched_off(commands_[side]);
      }
      if (state == ProgramState::booting) {
        robots_[side].boot();
        commands_[side] = {Palm::steep, Move::hold};
      }
      while (const Envelope* envelope = runs[side] ? down_[side].oldest(tick) : nullptr) {
        bool must_answer = false;  // the report of this tick answers
        const wire::Packet packet =
            robots_[side].read(*envelope, totals.links[2 + side], must_answer);
        if (packet.kind == PacketKind::command) commands_[side] = wire::command_of(packet.payload);
        down_[side].pop();
      }
      while (const Envelope* envelope = up_[side].oldest(tick)) {
        if (!lost) {
          const wire::Packet packet =
              station_.read(*envelope, totals.links[side], station_.owes[side]);
          if (packet.kind == PacketKind::report) {
            reports_[side] = wire::report_of(packet.payload);
            heard_[side] = true;
          }
        }
        up_[side].pop();
      }
    }
    const bool collides = runs[left] && runs[right] && radio_.collide(tick);
    Centralized::Output output{};
    const bool commands = heard_[left] && heard_[right] && !lost;
    if (commands) output = controller_.step(reports_);
    for (const std::size_t side : {left, right}) {
      const auto robot = static_cast<Role>(side);
      if (commands) {
        const wire::Payload payload = wire::packet_of(output.command[side], {}).payload;
        radio_.post(down_[side], tick, station_.write(robot, PacketKind::command, payload), 2, side,
                    false, totals);
        station_.owes[side] = false;
      } else if (station_.owes[side] && !lost) {
        radio_.post(down_[side], tick, station_.write(robot, PacketKind::hello, wire::up), 2, side,
                    false, totals);
        station_.owes[side] = false;
        ++hellos;
      }
      if (!runs[side]) continue;
      const Centralized::Report report{sensed[side].sign, obeyed_[side],
                                       sensed[side].palm_at_target};
      const EnvelopeToStation envelope{robots_[side].write(Role::station, PacketKind::report,
                                                           wire::packet_of(report, {}).payload)};
      radio_.post(up_[side], tick, envelope, side, side, collides, totals);
      obeyed_[side] = commands_[side].palm;
    }
    return commands_;
  }

  std::uint32_t hellos = 0;

 private:
  PerSide<End> robots_{End(Role::left), End(Role::right)};
  End station_{Role::station};
  Centralized controller_;
  Centralized::Report reports_[2]{};
  PerSide<bool> heard_{};
  PerSide<Palm> obeyed_{Palm::steep, Palm::steep};
  PerSide<Link<EnvelopeToStation>> up_;
  PerSide<Link<Envelope>> down_;
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

// What the robots sense: signs that last for a while, palms that arrive or do not.
PerSide<RobotObservation> observation(std::uint64_t seed, std::uint32_t tick) {
  const Words words = draw(seed, tick / 40, Stream::tactile, 7);
  const Words turned = draw(seed, tick / 8, Stream::tactile, 8);
  PerSide<RobotObservation> seen{};
  for (const std::size_t side : {left, right}) {
    const std::uint32_t felt = words[side] % 5;  // 0 most of the time
    seen[side] = {felt < 2 ? static_cast<Sign>(2 * static_cast<int>(felt) - 1) : Sign::zero,
                  (turned[side] & 7) != 0};
  }
  return seen;
}

bool same(const LinkTotals& a, const LinkTotals& b) {
  bool all = a.sent == b.sent && a.lost == b.lost;
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    const LinkCounts& x = a.links[i];
    const LinkCounts& y = b.links[i];
    all = all && x.sent == y.sent && x.lost == y.lost && x.duplicated == y.duplicated &&
          x.late == y.late && x.rejected == y.rejected;
  }
  return all;
}

bool same(const SentMessage& a, const SentMessage& b) {
  return a.sent == b.sent && a.received == b.received && a.sender == b.sender &&
         a.receiver == b.receiver && a.kind == b.kind && a.is_hello == b.is_hello;
}

constexpr std::uint32_t length = 1500;

// A team that is stepped only when its observations change or it says so.
template <class Team>
struct Lazy {
  Team team;
  std::uint32_t next = 0;
  PerSide<RobotObservation> seen{};
  PerSide<Command> commands{};

  template <class Log>
  void step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&& log) {
    if (tick < next && sensed == seen) return;
    seen = sensed;
    const PerSide<Command> before = std::exchange(commands, team.step(tick, sensed, log));
    next = team.next_decision_tick(tick);
    // A palm that has just been commanded to turn is expected not to be there in the next tick.
    for (const std::size_t side : {left, right}) {
      if (Team::expects_turns && commands[side].palm != before[side].palm)
        seen[side].palm_at_target = false;
    }
  }
};

template <class Controller>
std::uint32_t test_distributed(const Condition& condition, std::uint64_t seed) {
  const DistributedTeam<Controller> start({}, condition.channel, seed, right,
                                          condition.faults(seed));
  DistributedTeam<Controller> team = start;
  Lazy<DistributedTeam<Controller>> lazy{start};
  Pair<Controller> pair(condition, seed);
  std::vector<SentMessage> log;
  std::vector<SentMessage> lazy_log;
  std::vector<SentMessage> expected;
  std::uint32_t hellos = 0;
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    const PerSide<MessageKind> found{team.message(tick, left), team.message(tick, right)};
    for (auto* list : {&log, &lazy_log, &expected}) list->clear();
    lazy.step(tick, seen, [&](const SentMessage& m) { lazy_log.push_back(m); });
    const PerSide<Command> commands =
        team.step(tick, seen, [&](const SentMessage& m) { log.push_back(m); });
    const PerSide<Command> wanted = pair.step(tick, seen, expected);
    CHECK(commands == wanted && lazy.commands == wanted);
    CHECK(log.size() == expected.size() && lazy_log.size() == expected.size());
    for (std::size_t i = 0; i < log.size(); ++i) {
      CHECK(same(log[i], expected[i]) && same(lazy_log[i], expected[i]));
      hellos += log[i].is_hello ? 1 : 0;
    }
    CHECK(same(team.link_totals, pair.totals) && same(lazy.team.link_totals, pair.totals));
    CHECK(found == pair.found);
  }
  return hellos;
}

std::uint32_t test_centralized(const Condition& condition, std::uint64_t seed) {
  const CentralizedTeam start(condition.channel, seed, right, condition.faults(seed));
  CentralizedTeam team = start;
  Lazy<CentralizedTeam> lazy{start};
  Triple triple(condition, seed);
  const auto ignore = [](const SentMessage&) {};
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    const PerSide<Command> commands = team.step(tick, seen, ignore);
    lazy.step(tick, seen, ignore);
    const PerSide<Command> wanted = triple.step(tick, seen);
    CHECK(commands == wanted && lazy.commands == wanted);
    CHECK(same(team.link_totals, triple.totals));
  }
  lazy.team.close(length);
  CHECK(same(lazy.team.link_totals, triple.totals));
  return triple.hellos;
}

// On the bare channel a copy and a message from before a boot are acted upon.
template <class Team, class Make>
bool differs_on_the_bare_channel(Condition condition, std::uint64_t seed, Make make) {
  Team with = make(condition, seed);
  condition.channel.has_sessions = false;
  Team without = make(condition, seed);
  bool differs = false;
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    const auto ignore = [](const SentMessage&) {};
    differs = with.step(tick, seen, ignore) != without.step(tick, seen, ignore) || differs;
  }
  CHECK(without.link_totals.links[left].rejected == 0 || condition.channel.corrupt_words > 0);
  return differs;
}

}  // namespace

int main() {
  for (const Condition& condition : conditions()) {
    std::uint32_t hellos = 0;
    std::uint32_t station_hellos = 0;
    bool differ = false;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      hellos += test_distributed<Talker>(condition, seed);
      test_distributed<Distributed>(condition, seed);
      station_hellos += test_centralized(condition, seed);
      differ = differs_on_the_bare_channel<DistributedTeam<Talker>>(
                   condition, seed,
                   [](const Condition& c, std::uint64_t s) {
                     return DistributedTeam<Talker>({}, c.channel, s, right, c.faults(s));
                   }) ||
               differ;
    }
    CHECK((hellos > 0) == condition.boots && (station_hellos > 0) == condition.boots);
    CHECK(differ == (condition.boots || condition.repeats));
  }
}
