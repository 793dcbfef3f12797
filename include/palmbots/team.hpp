// How controllers and radio are wired together: two robots that exchange letters, or two robots and
// a station. A carry gives a team the signs and the state of the palms every tick and gets commands.
#pragma once

#include <concepts>
#include <utility>

#include "palmbots/policy.hpp"
#include "palmbots/protocol.hpp"
#include "palmbots/radio.hpp"
#include "palmbots/side.hpp"

namespace palmbots {

// What a team sees of one robot at a tick.
struct Sensed {
  Sign sign;
  bool turned;  // the palm has reached the angle last commanded

  constexpr bool operator==(const Sensed&) const = default;
};

// A correction as far as it shows from outside: its case, and who takes part. Where the robots agree
// by letters nobody assists when it starts: the partner comes in later, or never (Metrics).
struct Activity {
  static constexpr std::int8_t nobody = -1;
  static constexpr std::int8_t both = 2;

  char name = ' ';             // 'a'–'d' or '1'–'8'; ' ': none
  std::int8_t robot = nobody;  // whose contact is corrected: 0, 1 or both
  std::int8_t assistant = nobody;
  PerSide<std::int8_t> sense{};  // of each contact: +1 positive, −1 negative, 0 left alone
};

// One message, for the log. A lost one has received == 0.
struct Posted {
  std::uint32_t sent;
  std::uint32_t received;
  std::uint8_t sender;
  std::uint8_t receiver;
  Letter letter;
};

// Counts of messages.
struct Traffic {
  std::uint32_t sent = 0;
  std::uint32_t lost = 0;
};

// No controller: the palms stay steep and the robots keep their nominal speed.
struct Unattended {
  Traffic traffic{};
  static constexpr bool half_moves = false;

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<Sensed>&, Log&&) {
    return {{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  }
  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  Letter awaits(std::size_t) const { return Letter::none; }
  Activity activity(std::size_t) const { return {}; }
  std::uint32_t wake(std::uint32_t) const { return ~0U; }
};

// The next tick at which a team has something to do even if the robots sense what they sense now. A
// team that does not say is asked every tick.
template <class Team>
std::uint32_t wake_of(const Team& team, std::uint32_t tick) {
  if constexpr (requires { team.wake(tick); }) {
    return team.wake(tick);
  } else {
    return tick + 1;
  }
}

// Two robots with one controller each, and a link each way. Controller is anything with
// step(Distributed::Input) → Distributed::Output and now() → Distributed::Doing.
template <class Controller>
class Pair {
 public:
  static constexpr bool half_moves = false;
  Traffic traffic{};

  Pair(PerSide<Controller> controllers, Channel channel, std::uint64_t seed, std::size_t leader)
      : controllers_(std::move(controllers)), channel_(channel), seed_(seed), leader_(leader) {}

  template <class Log>
  PerSide<Command> step(std::uint32_t tick, const PerSide<Sensed>& sensed, Log&& log) {
    PerSide<Command> commands{};
    PerSide<Letter> letters{};
    settled_ = true;
    for (const std::size_t side : {left, right}) {
      const Letter* letter = inbox_[side].oldest(tick);
      const Controller before = controllers_[side];
      const auto out = controllers_[side].step(
          {sensed[side].sign, letter != nullptr ? *letter : Letter::none, sensed[side].turned});
      if (out.read && letter != nullptr) inbox_[side].pop();
      settled_ =
          settled_ && !out.read && out.send == Letter::none && same(before, controllers_[side]);
      commands[side] = out.command;
      letters[side] = out.send;
    }
    for (const std::size_t side : {left, right}) {
      if (letters[side] != Letter::none) post(tick, side, letters[side], log);
    }
    return commands;
  }

  char name(std::size_t side) const { return controllers_[side].now().name; }
  bool waits(std::size_t side) const { return controllers_[side].now().waits; }
  Letter awaits(std::size_t side) const { return controllers_[side].now().awaits; }

  // A controller whose step depends on its state and input alone, and changed neither, will not until
  // a letter comes.
  std::uint32_t wake(std::uint32_t tick) const {
    if (!settled_) return tick + 1;
    const std::uint32_t l = inbox_[left].next_arrival(tick);
    const std::uint32_t r = inbox_[right].next_arrival(tick);
    return l < r ? l : r;
  }

  // (c) assists and is no correction of its own.
  Activity activity(std::size_t side) const {
    const char name = this->name(side);
    const auto self = static_cast<std::int8_t>(side);
    switch (name) {
      case 'a':
      case 'b': return {name, self, Activity::nobody, only(side, 1)};
      case 'd': return {name, self, Activity::nobody, only(side, -1)};
      default: return {};
    }
  }

 private:
  static bool same(const Controller& before, const Controller& now) {
    if constexpr (std::equality_comparable<Controller>) {
      return before == now;
    } else {
      return false;  // it may know more than it shows
    }
  }

  static constexpr PerSide<std::int8_t> only(std::size_t side, std::int8_t sense) {
    PerSide<std::int8_t> senses{};
    senses[side] = sense;
    return senses;
  }

  template <class Log>
  void post(std::uint32_t tick, std::size_t side, Letter letter, Log&& log) {
    const Words words = channel_.is_random()
                            ? draw(seed_, tick, Stream::radio, side == leader_ ? 0 : 1)
                            : Words{~0U, 0, 0, 0};
    const std::uint32_t received = inbox_[other(side)].send(tick, letter, channel_, words);
    ++traffic.sent;
    if (received == 0) ++traffic.lost;
    log(Posted{tick, received, static_cast<std::uint8_t>(side),
               static_cast<std::uint8_t>(other(side)), letter});
  }

  PerSide<Controller> controllers_;
  bool settled_ = false;         // the last step changed nothing
  PerSide<Link<Letter>> inbox_;  // of each robot
  Channel channel_;
  std::uint64_t seed_;
  std::size_t leader_;
};

// Two robots that report to a station every tick and do what its newest packet says.
class Station {
 public:
  static constexpr bool half_moves = true;  // both robots move, at half the correction speed each
  Traffic traffic{};

  Station(Channel channel, std::uint64_t seed, std::size_t leader)
      : channel_(channel), seed_(seed), leader_(leader) {}

  template <class Log>
  PerSide<Command> step(std::uint32_t tick, const PerSide<Sensed>& sensed, Log&&) {
    for (const std::size_t side : {left, right}) {
      down_[side].newest(tick, commands_[side]);
      heard_[side] = up_[side].newest(tick, reports_[side]) || heard_[side];
    }
    if (heard_[left] && heard_[right]) {
      const Centralized::Output out = station_.step(reports_);
      for (const std::size_t side : {left, right}) {
        post(down_[side], tick, out.command[side], lane(side) + 2);
      }
    }
    for (const std::size_t side : {left, right}) {
      // `turned` speaks of the command in force until this tick.
      post(up_[side], tick,
           Centralized::Report{sensed[side].sign, obeyed_[side], sensed[side].turned}, lane(side));
      obeyed_[side] = commands_[side].palm;
    }
    return {commands_[left], commands_[right]};
  }

  char name(std::size_t) const {
    const int now = station_.current();
    return now == 0 ? ' ' : static_cast<char>('0' + now);
  }
  bool waits(std::size_t) const { return false; }
  Letter awaits(std::size_t) const { return Letter::none; }

  Activity activity(std::size_t side) const {
    const int now = station_.current();
    if (side != left || now == 0) return {};
    constexpr auto nobody = Activity::nobody;
    constexpr auto both = Activity::both;
    struct Part {
      std::int8_t robot;
      std::int8_t assistant;
      PerSide<std::int8_t> sense;
    };
    constexpr Part parts[8] = {
        {0, 1, {1, 0}},          {1, 0, {0, 1}},            // cases 1, 2
        {0, nobody, {-1, 0}},    {1, nobody, {0, -1}},      // 3, 4
        {both, nobody, {1, 1}},  {both, nobody, {-1, -1}},  // 5, 6
        {both, nobody, {1, -1}}, {both, nobody, {-1, 1}},   // 7, 8
    };
    const Part& part = parts[now - 1];
    return {static_cast<char>('0' + now), part.robot, part.assistant, part.sense};
  }

 private:
  std::uint32_t lane(std::size_t side) const { return side == leader_ ? 0 : 1; }

  template <class Payload>
  void post(Link<Payload>& link, std::uint32_t tick, Payload payload, std::uint32_t lane) {
    const Words words =
        channel_.is_random() ? draw(seed_, tick, Stream::radio, lane) : Words{~0U, 0, 0, 0};
    ++traffic.sent;
    if (link.send(tick, payload, channel_, words) == 0) ++traffic.lost;
  }

  Centralized station_;
  PerSide<Link<Centralized::Report>> up_;
  PerSide<Link<Command>> down_;
  Centralized::Report reports_[2]{};
  bool heard_[2]{};
  Command commands_[2]{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}};
  Palm obeyed_[2]{Palm::steep, Palm::steep};
  Channel channel_;
  std::uint64_t seed_;
  std::size_t leader_;
};

}  // namespace palmbots
