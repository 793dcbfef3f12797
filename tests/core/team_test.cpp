// Controllers and radio wired together: mirror symmetry, the order of a tick, and what a lost packet
// does where a station decides.
#include "palmbots/team.hpp"

#include <cstdint>
#include <vector>

#include "check.hpp"

using namespace palmbots;

namespace {

constexpr auto ignore = [](const Posted&) {};

Sensed sensed_of(const Words& words, int lane) {
  return {static_cast<Sign>(static_cast<int>(words[static_cast<std::size_t>(lane)] % 3) - 1),
          (words[static_cast<std::size_t>(lane) + 1] & 3) == 0};
}

bool same(Command a, Command b) { return a.palm == b.palm && a.move == b.move; }

// The same readings on exchanged sides, with the other robot leading: the same commands on
// exchanged sides, and the same letters between exchanged robots.
template <class Team>
void test_mirror(Team forward, Team backward, std::uint64_t seed) {
  std::vector<Posted> there;
  std::vector<Posted> back;
  for (std::uint32_t tick = 0; tick < 4000; ++tick) {
    // Signs that last a while, so that corrections get somewhere.
    const Words words = draw(seed, tick / 16, Stream::tactile, 7);
    const Words turned = draw(seed, tick, Stream::tactile, 8);
    PerSide<Sensed> seen{sensed_of(words, 0), sensed_of(words, 2)};
    for (const std::size_t side : {left, right}) seen[side].turned = (turned[side] & 3) == 0;
    const auto a = forward.step(tick, seen, [&](const Posted& p) { there.push_back(p); });
    const auto b =
        backward.step(tick, {seen[right], seen[left]}, [&](const Posted& p) { back.push_back(p); });
    CHECK(same(a[left], b[right]) && same(a[right], b[left]));
    CHECK(forward.waits(left) == backward.waits(right));
    CHECK(forward.waits(right) == backward.waits(left));
  }
  CHECK(forward.traffic.sent == backward.traffic.sent && forward.traffic.sent > 100);
  CHECK(forward.traffic.lost == backward.traffic.lost);
  CHECK(there.size() == back.size());
  std::uint32_t lost = 0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const Posted& p = there[i];
    lost += p.received == 0 ? 1 : 0;
    // Letters of one tick are posted left first on both sides of the mirror.
    bool found = false;
    for (std::size_t k = i > 0 ? i - 1 : 0; k < there.size() && k <= i + 1; ++k) {
      const Posted& q = back[k];
      found = found || (q.sent == p.sent && q.received == p.received && q.letter == p.letter &&
                        q.sender == p.receiver && q.receiver == p.sender);
    }
    CHECK(found);
  }
  if (!there.empty()) CHECK(lost == forward.traffic.lost);
}

void test_mirror_of_both_teams() {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    for (const Channel& channel : {Channel::of(0.05, 0, 0, 0.01), Channel::of(0.02, 0.06, 0, 0.01),
                                   Channel::of(0.02, 0.06, 0.01, 0.01)}) {
      const bool hangs = channel.loss_words > 0;  // the distributed algorithm after a loss
      if (!hangs) {
        test_mirror(Pair<Distributed>({}, channel, seed, right),
                    Pair<Distributed>({}, channel, seed, left), seed);
      }
      test_mirror(Station(channel, seed, right), Station(channel, seed, left), seed);
    }
  }
}

// A robot that records what it is given.
struct Probe {
  std::vector<Letter>* got;
  Letter say;
  Distributed::Output step(Distributed::Input in) {
    got->push_back(in.letter);
    return {{Palm::steep, Move::hold}, say, in.letter == Letter::ack};
  }
  Distributed::Doing now() const { return Distributed::doing[0]; }
};

// A letter is there ⌈latency⌉ ticks after it was sent, oldest first, and stays until it is read.
void test_letters_wait_to_be_read() {
  std::vector<Letter> left_got;
  std::vector<Letter> right_got;
  Pair<Probe> team({Probe{&left_got, Letter::tilt_up}, Probe{&right_got, Letter::ack}},
                   Channel::of(0.03, 0, 0, 0.01), 0, right);
  for (std::uint32_t tick = 0; tick < 10; ++tick) team.step(tick, {}, ignore);
  for (std::size_t tick = 0; tick < 10; ++tick) {
    CHECK(left_got[tick] == (tick < 3 ? Letter::none : Letter::ack));       // read one by one
    CHECK(right_got[tick] == (tick < 3 ? Letter::none : Letter::tilt_up));  // never read
  }
  CHECK(team.traffic.sent == 20 && team.traffic.lost == 0);
}

// Ticks until the station's answer to a positive left contact reaches the right robot.
int ticks_to_answer(Channel channel, std::uint64_t seed) {
  Station team(channel, seed, right);
  for (std::uint32_t tick = 0; tick < 40; ++tick) {
    team.step(tick, {{{Sign::zero, true}, {Sign::zero, true}}}, ignore);
  }
  for (std::uint32_t tick = 40; tick < 4000; ++tick) {
    const auto out = team.step(tick, {{{Sign::positive, true}, {Sign::zero, true}}}, ignore);
    CHECK(out[left].palm == Palm::steep);  // case 1 tilts the right palm
    if (out[right].palm == Palm::shallow) return static_cast<int>(tick) - 40;
  }
  return -1;
}

void test_station_needs_two_latencies_and_loss_only_delays() {
  CHECK(ticks_to_answer(Channel::of(0, 0, 0, 0.01), 0) == 2);
  CHECK(ticks_to_answer(Channel::of(0.05, 0, 0, 0.01), 0) == 10);
  CHECK(ticks_to_answer(Channel::of(0.20, 0, 0, 0.01), 0) == 40);
  int slowest = 0;
  double sum = 0;
  constexpr int n = 2000;
  for (std::uint64_t seed = 0; seed < n; ++seed) {
    const int ticks = ticks_to_answer(Channel::of(0.05, 0, 0.5, 0.01), seed);
    CHECK(ticks >= 10);
    if (ticks > slowest) slowest = ticks;
    sum += ticks;
  }
  // Each of the two links delays by a geometric number of ticks, of mean loss / (1 − loss) = 1 and
  // variance 2.
  const double mean = sum / n - 10;
  CHECK(mean > 2 - 5 * 0.045 && mean < 2 + 5 * 0.045);
  CHECK(slowest < 45);
  CHECK(ticks_to_answer(Channel::of(0.05, 0, 1, 0.01), 0) == -1);
}

// With everything lost the station is silent and the robots keep palms and speed.
void test_nothing_heard_nothing_done() {
  Station team(Channel::of(0.05, 0, 1, 0.01), 0, right);
  for (std::uint32_t tick = 0; tick < 100; ++tick) {
    const auto out = team.step(tick, {{{Sign::positive, true}, {Sign::negative, true}}}, ignore);
    for (const std::size_t side : {left, right}) {
      CHECK(same(out[side], {Palm::steep, Move::hold}));
    }
    CHECK(team.name(left) == ' ');
  }
  CHECK(team.traffic.sent == 200 && team.traffic.lost == 200);
}

}  // namespace

int main() {
  test_mirror_of_both_teams();
  test_letters_wait_to_be_read();
  test_station_needs_two_latencies_and_loss_only_delays();
  test_nothing_heard_nothing_done();
}
