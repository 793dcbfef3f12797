// How controllers and radio are wired together: two robots that exchange letters (two and a station:
// station.hpp; two that broadcast beacons: peers.hpp). A carry gives a team the signs and the state of the
// palms every tick and gets commands.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "palmbots/faults.hpp"
#include "palmbots/parcel.hpp"
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

// One message, for the log. One that is lost, or comes damaged, has received == 0.
struct Posted {
  std::uint32_t sent;
  std::uint32_t received;
  std::uint8_t sender;
  std::uint8_t receiver;
  Letter letter;
};

// Counts of messages. What was not lost is delivered, and so is each copy, damaged or not.
struct LinkCounts {
  std::uint32_t sent = 0;
  std::uint32_t lost = 0;
  std::uint32_t duplicated = 0;
  std::uint32_t late = 0;      // heard by the resilient algorithm, but too old to count
  std::uint32_t rejected = 0;  // damaged; by that algorithm also a copy, or older than one heard
};

struct Traffic {
  std::uint32_t sent = 0;
  std::uint32_t lost = 0;
  // From the left robot, from the right one, from the station to the left and to the right one.
  std::array<LinkCounts, 4> links{};
};

// What a team knows of the radio: posts messages on links and counts them. Of two that send in one
// tick, each does so at a random instant of it; if they overlap neither is heard.
class Radio {
 public:
  Radio(const Channel& channel, std::uint64_t seed, std::size_t leader)
      : channel_(channel),
        plain_delay_(channel.is_plain() ? channel.longest() : 0),
        seed_(seed),
        leader_(leader) {}

  std::size_t leader() const { return leader_; }

  // From here on the random numbers of another seed.
  void fork(std::uint64_t seed) { seed_ = seed; }

  // How long every message takes that is not lost, if they all take the same time and losses are all that
  // befalls them [ticks]; else 0.
  std::uint32_t steady_delay() const { return channel_.is_steady() ? channel_.longest() : 0; }
  // A message is lost where a random word is below this.
  std::uint64_t loss_words() const { return channel_.loss_words; }

  // Before a tick's messages: whether those of two stations that both send in it collide.
  bool collide(std::uint32_t tick) const {
    if (channel_.airtime_ticks <= 0) return false;
    const Words words = draw(seed_, tick, Stream::collision);
    const double apart = unit_uniform<double>(words[0]) - unit_uniform<double>(words[1]);
    return (apart < 0 ? -apart : apart) < channel_.airtime_ticks;
  }

  // Sends from `sender` (0, 1: robots, 2: station) to a robot, or to the station; returns the tick of
  // arrival, 0 if it is lost.
  template <class Payload>
  std::uint32_t post(Link<Payload>& link, std::uint32_t tick, const Payload& payload,
                     std::size_t sender, std::size_t robot, bool collides, Traffic& traffic) const {
    LinkCounts& counts = traffic.links[robot + (sender == 2 ? 2 : 0)];
    ++traffic.sent;
    ++counts.sent;
    if (plain_delay_ > 0 && link.has_room()) return link.put(tick + plain_delay_, payload);
    // The robot that leads has the first lane, so that the mirrored carry draws the mirrored numbers.
    const std::uint32_t lane = (robot == leader_ ? 0U : 1U) + (sender == 2 ? 2U : 0U);
    const Words words =
        channel_.is_random() ? draw(seed_, tick, Stream::radio, lane) : Words{~0U, 0, 0, ~0U};
    const Mishap* mishap = channel_.mishap(sender, counts.sent);
    const bool lost = mishap != nullptr && mishap->fate == Fate::lost;
    const bool late = mishap != nullptr && mishap->fate == Fate::late;
    if (collides || lost || channel_.is_dead(static_cast<std::uint32_t>(sender), tick) ||
        !link.takes(tick, channel_, words)) {
      ++traffic.lost;
      ++counts.lost;
      return 0;
    }
    std::uint32_t received = 0;
    if (channel_.corrupt_words > 0 && damages(payload, tick, sender, robot, lane, counts.sent)) {
      ++counts.rejected;
    } else {
      received = link.put(late ? tick + mishap->late : tick, payload, channel_, words);
    }
    if (channel_.duplicate_words > 0 && link.send_copy(tick, payload, channel_, words)) {
      ++counts.duplicated;
    }
    if (mishap != nullptr && mishap->fate == Fate::copied) {
      link.send_again(tick + mishap->late, payload, channel_, words);
      ++counts.duplicated;
    }
    return received;
  }

 private:
  // Whether the message comes damaged and is turned away: it is made into its packet, some bytes of
  // which become noise, and the receiver's decoder reads what is left of it (parcel.hpp).
  template <class Payload>
  bool damages(const Payload& payload, std::uint32_t tick, std::size_t sender, std::size_t robot,
               std::uint32_t lane, std::uint32_t number) const {
    const Words words = draw(seed_, tick, Stream::corruption, lane);
    if (words[0] >= channel_.corrupt_words) return false;
    constexpr bool reports = std::is_same_v<Payload, Centralized::Report>;
    const std::size_t receiver = reports ? 2 : (sender == 2 ? robot : other(sender));
    const wire::Envelope envelope{
        static_cast<wire::Role>(sender), static_cast<wire::Role>(receiver), 0, {1, number}, {}};
    return wire::damaged(wire::packet_of(payload, envelope), words) != wire::Verdict::accepted;
  }

  Channel channel_;
  std::uint32_t plain_delay_;
  std::uint64_t seed_;
  std::size_t leader_;
};

// No controller: the palms stay steep and the robots keep their nominal speed.
struct Unattended {
  Traffic traffic{};
  static constexpr bool half_moves = false;

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<Sensed>&, Log&&) {
    return {{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  }
  void fork(std::uint64_t) {}
  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  Letter awaits(std::size_t) const { return Letter::none; }
  Activity activity(std::size_t) const { return {}; }
  std::uint32_t wake(std::uint32_t) const { return ~0U; }
};

// Does a team take it that a palm that it tells to turn is not there yet in the next tick? Then it is news
// only if it is.
template <class Team>
constexpr bool expects_turns() {
  if constexpr (requires { Team::expects_turns; }) return Team::expects_turns;
  return false;
}

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

// A carry ends before this tick: a team that rested counts what went on without it.
template <class Team>
void close_team(Team& team, std::uint32_t tick) {
  if constexpr (requires { team.close(tick); }) team.close(tick);
}

// What a robot in a case of Table 2 corrects. (c) assists and is no correction of its own.
inline Activity activity_of(char name, std::size_t side) {
  PerSide<std::int8_t> sense{};
  const auto self = static_cast<std::int8_t>(side);
  switch (name) {
    case 'a':
    case 'b': sense[side] = 1; return {name, self, Activity::nobody, sense};
    case 'd': sense[side] = -1; return {name, self, Activity::nobody, sense};
    default: return {};
  }
}

// What a robot does while its program does not run: its wheels stop, its palm stays.
inline Command switched_off(const Command& before) { return {before.palm, Move::hold, true}; }

// Two robots with one controller each, and a link each way. Controller is anything with
// step(Distributed::Input) → Distributed::Output and now() → Distributed::Doing.
template <class Controller>
class Pair {
 public:
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = true;
  Traffic traffic{};

  Pair(PerSide<Controller> controllers, const Channel& channel, std::uint64_t seed,
       std::size_t leader, const Faults& faults = {})
      : controllers_(std::move(controllers)),
        asleep_(controllers_),
        radio_(channel, seed, leader),
        faults_(faults) {}

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<Sensed>& sensed, Log&& log) {
    PerSide<Letter> letters{};
    const bool may_fail = faults_.any();
    PerSide<bool> rest{};   // which of them stay as they are, and so does what they command
    PerSide<bool> turns{};  // which of them tell their palm to turn
    for (const std::size_t side : {left, right}) {
      if (may_fail && !runs(tick, side)) continue;
      const Distributed::Input in = input(tick, side, sensed[side]);
      rest[side] = !may_fail && rests(controllers_[side], in);
      if (rest[side]) continue;
      const auto out = controllers_[side].step(in);
      if (out.read && in.letter != Letter::none) inbox_[side].pop();
      turns[side] = out.command.palm != commands_[side].palm;
      commands_[side] = out.command;
      letters[side] = out.send;
    }
    if (letters[left] != Letter::none || letters[right] != Letter::none) post(tick, letters, log);
    settled_ = true;
    for (const std::size_t side : {left, right}) {
      if (!rest[side]) {
        const Sensed then{sensed[side].sign, sensed[side].turned && !turns[side]};
        settled_ = settled_ && rests(controllers_[side], input(tick, side, then));
      }
    }
    return commands_;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }

  const Radio& radio() const { return radio_; }
  const Faults& faults() const { return faults_; }

  // Whether a robot's program runs in a tick that is still to come, and the letter that it will find.
  bool is_on(std::uint32_t tick, std::size_t side) const {
    const Host host = power_.next(faults_, tick, side);
    return host == Host::runs || host == Host::boots;
  }
  bool boots(std::uint32_t tick, std::size_t side) const {
    return power_.next(faults_, tick, side) == Host::boots;
  }
  Letter letter(std::uint32_t tick, std::size_t side) const {
    const Letter* oldest = is_on(tick, side) ? inbox_[side].oldest(tick) : nullptr;
    return oldest != nullptr ? *oldest : Letter::none;
  }

  char name(std::size_t side) const { return controllers_[side].now().name; }
  bool waits(std::size_t side) const { return controllers_[side].now().waits; }
  Letter awaits(std::size_t side) const { return controllers_[side].now().awaits; }
  Activity activity(std::size_t side) const { return activity_of(name(side), side); }

  // Robots that stay as they are with what they sense and hear now will until a letter comes, or one
  // of them fails.
  std::uint32_t wake(std::uint32_t tick) const {
    if (!settled_) return tick + 1;
    return std::min({inbox_[left].next_arrival(tick), inbox_[right].next_arrival(tick),
                     faults_.next_outage(tick)});
  }

 private:
  Distributed::Input input(std::uint32_t tick, std::size_t side, const Sensed& sensed) const {
    const Letter* letter = inbox_[side].oldest(tick);
    return {sensed.sign, letter != nullptr ? *letter : Letter::none, sensed.turned};
  }

  // A controller that does not say may always have something to do.
  static bool rests(const Controller& controller, const Distributed::Input& in) {
    if constexpr (requires { controller.rests(in); }) {
      return controller.rests(in);
    } else {
      return false;
    }
  }

  template <class Log>
  void post(std::uint32_t tick, const PerSide<Letter>& letters, Log&& log) {
    const bool both = letters[left] != Letter::none && letters[right] != Letter::none;
    const bool collides = both && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (letters[side] == Letter::none) continue;
      const std::uint32_t received =
          radio_.post(inbox_[other(side)], tick, letters[side], side, side, collides, traffic);
      log(Posted{tick, received, static_cast<std::uint8_t>(side),
                 static_cast<std::uint8_t>(other(side)), letters[side]});
    }
  }

  // Whether a robot's program runs; one that boots has forgotten everything.
  bool runs(std::uint32_t tick, std::size_t side) {
    const Host host = power_.host(faults_, tick, side);
    if (host == Host::off) {
      inbox_[side].drop(tick);
      commands_[side] = switched_off(commands_[side]);
    }
    if (host == Host::boots) controllers_[side] = asleep_[side];
    return host == Host::runs || host == Host::boots;
  }

  PerSide<Controller> controllers_;
  PerSide<Controller> asleep_;   // as they are after a boot
  bool settled_ = false;         // with the same input they would stay as they are
  PerSide<Link<Letter>> inbox_;  // of each robot
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  Power power_;
};

}  // namespace palmbots
