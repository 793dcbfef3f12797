// SPDX-License-Identifier: Apache-2.0
// The radio link: latency to the tick, jitter that never reorders, loss, and what has arrived.
#include "palmbots/sim/radio_channel.hpp"

#include <cmath>
#include <cstdint>
#include <deque>

#include "palmbots/sim/random_streams.hpp"
#include "support/check.hpp"

using palmbots::Channel;
using palmbots::draw;
using palmbots::Link;
using palmbots::MessageEffect;
using palmbots::Stream;
using palmbots::Words;

namespace {

constexpr Words sure{~0U, 0, 0, 0};

// The first tick not before the moment of arrival, and never the tick of sending.
void test_latency_is_rounded_up_to_a_tick() {
  constexpr double period = 0.01;
  for (int whole = 0; whole <= 200; ++whole) {
    const double latency = whole * period;  // 0.07 / 0.01 is not quite 7
    const auto expected = static_cast<std::uint32_t>(whole == 0 ? 1 : whole);
    CHECK(Channel::of(latency, 0, 0, period).ticks(sure) == expected);
    CHECK(Channel::of(whole / 100.0, 0, 0, period).ticks(sure) == expected);
    CHECK(Channel::of(latency + 1e-5, 0, 0, period).ticks(sure) ==
          static_cast<std::uint32_t>(whole) + 1);
  }
  Link<int> link;
  CHECK(link.send(10, 1, Channel::of(0.05, 0, 0, 0.01), sure) == 15);
  CHECK(link.oldest(14) == nullptr);
  CHECK(link.oldest(15) != nullptr && *link.oldest(15) == 1);
  link.pop();
  CHECK(link.oldest(15) == nullptr);
}

// Jitter u T, u uniform: each delay of latency + ⌈jitter u⌉ ticks is drawn as often.
void test_jitter_is_uniform() {
  const Channel channel = Channel::of(0.05, 0.04, 0, 0.01);
  constexpr int n = 100000;
  int count[16]{};
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t ticks = channel.ticks(draw(3, i, Stream::radio));
    CHECK(ticks >= 5 && ticks <= 9);
    ++count[ticks];
  }
  CHECK(count[5] < 10);  // only u = 0 itself
  for (int ticks = 6; ticks <= 9; ++ticks) CHECK(std::abs(count[ticks] - n / 4) < 700);
}

// Whatever jitter and loss: what arrives does so in the order of sending, when it was said to, and
// the rest was said to be lost.
void test_never_reorders() {
  const Channel channel = Channel::of(0.02, 1.2, 0.3, 0.01);
  struct Due {
    std::uint32_t at;
    int payload;
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Link<int> link;
    std::deque<Due> expected;
    std::uint32_t last = 0;
    bool held_back = false;
    for (std::uint32_t now = 0; now < 3000; ++now) {
      const Words words = draw(seed, now, Stream::radio);
      const std::uint32_t due = link.send(now, static_cast<int>(now), channel, words);
      CHECK((due == 0) == channel.loses(words));
      if (due != 0) {
        CHECK(due >= now + channel.ticks(words) && due >= last);
        held_back = held_back || due > now + channel.ticks(words);
        last = due;
        expected.push_back({due, static_cast<int>(now)});
      }
      while (const int* got = link.oldest(now)) {
        CHECK(!expected.empty() && expected.front().payload == *got);
        CHECK(expected.front().at <= now);
        expected.pop_front();
        link.pop();
      }
      CHECK(expected.empty() || expected.front().at > now);
    }
    CHECK(held_back);  // a later message with a shorter draw waited for an earlier one
  }
}

void test_loss() {
  constexpr int n = 100000;
  for (const double loss : {0.0, 0.01, 0.3, 1.0}) {
    const Channel channel = Channel::of(0.05, 0, loss, 0.01);
    int lost = 0;
    for (std::uint32_t i = 0; i < n; ++i) lost += channel.loses(draw(4, i, Stream::radio)) ? 1 : 0;
    CHECK(std::abs(lost - n * loss) <= 5 * std::sqrt(n * loss * (1 - loss)));
    Link<int> link;
    CHECK((link.send(0, 1, channel, {0, 0, 0, 0}) == 0) == (loss > 0));
  }
}

// Of messages sent at ticks 0, 1 and 3 with a delay of three ticks; that of tick 2 is lost. A copy of
// the link, also onto one that has been used, holds the same.
void test_arrived_messages() {
  Link<int> link;
  Link<int> used;
  const Channel channel = Channel::of(0.03, 0, 0.5, 0.01);
  link.send(0, 100, channel, sure);
  link.send(1, 101, channel, sure);
  CHECK(link.send(2, 102, channel, {0, 0, 0, 0}) == 0);  // lost
  link.send(3, 103, channel, sure);
  for (int i = 0; i < 5; ++i) used.send(0, i, channel, sure);
  used.pop();
  used = link;
  for (Link<int> one : {link, used}) {
    CHECK(one.arrived(2, 0) == nullptr);
    CHECK(*one.arrived(5, 0) == 100 && *one.arrived(5, 1) == 101 && one.arrived(5, 2) == nullptr);
    CHECK(*one.arrived(6, 2) == 103 && one.arrived(6, 3) == nullptr);
    CHECK(one.next_arrival(0) == 3);
    one.drop(5);
    CHECK(*one.arrived(6, 0) == 103 && one.arrived(5, 0) == nullptr && one.next_arrival(5) == 6);
  }
  CHECK(*link.oldest(3) == 100);
}

// Copies, overtaking and scheduled copies change the order; losses, jitter and delays do not.
void test_order() {
  Channel channel = Channel::of(0.03, 0.1, 0.5, 0.01);
  const auto keeps = [&](MessageEffect effect) {
    Channel changed = channel;
    changed.message_faults[changed.message_fault_count++] = {0, 1, effect, 5};
    return changed.keeps_order();
  };
  CHECK(channel.keeps_order() && keeps(MessageEffect::lost) && keeps(MessageEffect::late));
  CHECK(!keeps(MessageEffect::copied));
  Channel reordering = channel;
  reordering.reorders = true;
  channel.duplicate_words = 1;
  CHECK(!reordering.keeps_order() && !channel.keeps_order());
}

// One message a tick over the longest delay fits; a full line loses and says so.
void test_capacity() {
  Link<int> link;
  const Channel slow{double(palmbots::max_delay_ticks), 0, 0};
  for (std::uint32_t now = 0; now < 5000; ++now) {
    while (link.oldest(now) != nullptr) link.pop();
    CHECK(link.send(now, 0, slow, sure) == now + palmbots::max_delay_ticks);
  }
  Link<int> full;
  int sent = 0;
  while (full.send(0, sent, slow, sure) != 0) ++sent;
  CHECK(sent >= static_cast<int>(palmbots::max_delay_ticks));
  for (int i = 0; i < sent; ++i) {
    CHECK(*full.oldest(palmbots::max_delay_ticks) == i);
    full.pop();
  }
  CHECK(full.oldest(~0U) == nullptr);
}

// A link is dead for the share of time that was asked for, in spells of the mean length that was
// asked for, however often each robot sends.
void test_bursts() {
  for (const std::uint32_t every : {1U, 3U}) {
    Channel channel = Channel::of(0.02, 0, 0, 0.01);
    constexpr double share = 0.3;
    constexpr double mean = 20;  // ticks
    channel.burst_share = share;
    channel.burst_rate = 1 / ((1 - share) * mean);
    Link<int> link;
    int dead = 0;
    int spells = 0;
    bool was = false;
    constexpr int n = 300000;
    for (int i = 0; i < n; ++i) {
      const std::uint32_t now = static_cast<std::uint32_t>(i) * every;
      const bool lost = link.send(now, 0, channel, draw(5, now, Stream::radio)) == 0;
      link.drop(now + 10);
      dead += lost ? 1 : 0;
      spells += lost && !was ? 1 : 0;
      was = lost;
    }
    // Seen every k ticks a dead spell goes on with probability s + (1 − s) e^(−k rate).
    const double stays = share + (1 - share) * std::exp(-channel.burst_rate * every);
    CHECK(std::abs(double(dead) / n - share) < 0.02);
    CHECK(std::abs(double(dead) / spells * (1 - stays) - 1) < 0.05);
  }
}

// With reordering a message with a shorter draw overtakes; without it waits.
void test_reordering() {
  Channel channel = Channel::of(0.02, 0.2, 0, 0.01);
  for (const bool reorders : {false, true}) {
    channel.reorders = reorders;
    Link<std::uint32_t> link;
    std::uint32_t newest = 0;
    int overtaken = 0;
    int got = 0;
    for (std::uint32_t now = 0; now < 20000; ++now) {
      const Words words = draw(6, now, Stream::radio);
      const std::uint32_t due = link.send(now, now, channel, words);
      if (reorders) CHECK(due == now + channel.ticks(words));
      while (const std::uint32_t* sent = link.oldest(now)) {
        CHECK(now >= *sent + 2 && (now <= *sent + 22 || !reorders));
        overtaken += *sent < newest ? 1 : 0;
        newest = *sent > newest ? *sent : newest;
        ++got;
        link.pop();
      }
    }
    CHECK(got > 19900);
    CHECK(reorders ? overtaken > 5000 : overtaken == 0);
  }
}

// A message is doubled as often as asked for, the copy with a delay of its own over the whole
// jitter.
void test_copies() {
  Channel channel = Channel::of(0.02, 0.1, 0, 0.01);
  channel.duplicate_words = Channel::words_of(0.1);
  channel.reorders = true;
  constexpr int n = 50000;
  int copies = 0;
  double delay = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    Link<int> link;
    const Words words = draw(7, i, Stream::radio);
    if (!link.send_copy(0, 1, channel, words)) continue;
    ++copies;
    std::uint32_t now = 0;
    while (link.oldest(now) == nullptr) ++now;
    CHECK(now >= 2 && now <= 12);
    delay += now;
  }
  CHECK(std::abs(copies - 0.1 * n) < 5 * std::sqrt(0.09 * n));
  CHECK(std::abs(delay / copies - 7.5) < 5 * 2.9 / std::sqrt(double(copies)));
}

// A full line also rejects duplicates, and keeps its messages.
void test_full_line_rejects_duplicates() {
  Channel slow{double(palmbots::max_delay_ticks), 0, 0};
  slow.duplicate_words = Channel::words_of(1.0);
  slow.reorders = true;
  constexpr Words doubled{~0U, 0, 0, 0};
  Link<int> full;
  int sent = 0;
  while (full.send(0, sent, slow, doubled) != 0) ++sent;
  CHECK(!full.send_copy(0, -1, slow, doubled));
  full.send_again(0, -2, slow, doubled);
  for (int i = 0; i < sent; ++i) {  // also: what arrives together does so in the order of sending
    CHECK(full.oldest(palmbots::max_delay_ticks) != nullptr);
    CHECK(*full.oldest(palmbots::max_delay_ticks) == i);
    full.pop();
  }
  CHECK(full.oldest(~0U) == nullptr);
  CHECK(full.send_copy(300, 7, slow, doubled));
  full.send_again(301, 8, slow, doubled);
  CHECK(*full.oldest(600) == 7);
  full.pop();
  CHECK(*full.oldest(600) == 8);
}

// A channel is random if any of its probabilities is above 0.
void test_channel_with_any_probability_is_random() {
  const Channel plain = Channel::of(0.05, 0, 0, 0.01);
  CHECK(!plain.is_random());
  CHECK(Channel::of(0.05, 0.01, 0, 0.01).is_random());
  CHECK(Channel::of(0.05, 0, 0.01, 0.01).is_random());
  Channel doubles = plain;
  doubles.duplicate_words = 1;
  Channel bursts = plain;
  bursts.burst_share = 0.1;
  CHECK(doubles.is_random() && bursts.is_random());
}

void test_outages() {
  Channel channel = Channel::of(0.02, 0, 0, 0.01);
  channel.outages[0] = {1, 100, 200};
  channel.outage_count = 1;
  for (std::uint32_t tick = 0; tick < 300; ++tick) {
    CHECK(channel.is_dead(1, tick) == (tick >= 100 && tick < 200));
    CHECK(!channel.is_dead(0, tick) && !channel.is_dead(2, tick));
  }
}

}  // namespace

int main() {
  test_latency_is_rounded_up_to_a_tick();
  test_jitter_is_uniform();
  test_never_reorders();
  test_loss();
  test_arrived_messages();
  test_order();
  test_capacity();
  test_bursts();
  test_reordering();
  test_copies();
  test_full_line_rejects_duplicates();
  test_channel_with_any_probability_is_random();
  test_outages();
}
