// SPDX-License-Identifier: Apache-2.0
// What is measured, against short carries worked out by hand: a script says in which tick which
// robot is in which case and waits, and in which ticks the object rests on something else.
#include "palmbots/sim/metrics.hpp"

#include <utility>
#include <vector>

#include "support/check.hpp"

using namespace palmbots;

namespace {

// Two robots that do what a test says.
struct Script {
  PerSide<CorrectionActivity> doing{};
  PerSide<char> names{' ', ' '};
  PerSide<bool> waiting{};

  CorrectionActivity activity(std::size_t side) const { return doing[side]; }
  char name(std::size_t side) const { return names[side]; }
  bool waits(std::size_t side) const { return waiting[side]; }

  // One robot comes into a case of its own; in (c) it only assists.
  void in(std::size_t side, char name, std::int8_t sense) {
    names[side] = name;
    doing[side] = {};
    if (name == ' ' || name == 'c') return;
    doing[side] = {name, static_cast<std::int8_t>(side), CorrectionActivity::nobody, {}};
    doing[side].sense[side] = sense;
  }
};

bool is(const Correction& row, char name, int robot, int assistant, std::uint32_t start,
        std::uint32_t end) {
  return row.name == name && row.robot == robot && row.assistant == assistant &&
         row.start == start && row.end == end;
}

// (a) of the left robot, that the right one comes to assist.
void test_a_correction_with_its_assistant() {
  Metrics metrics;
  Script team;
  metrics.note(0, team);
  team.in(left, 'a', 1);
  metrics.note(10, team);
  CHECK(metrics.corrections == 1);
  CHECK(metrics.rows[0].assistant == CorrectionActivity::nobody);
  team.in(right, 'c', 0);
  metrics.note(15, team);
  team.in(left, ' ', 0);
  metrics.note(40, team);
  team.in(right, ' ', 0);
  metrics.note(46, team);
  metrics.close(100);
  CHECK(metrics.corrections == 1 && metrics.longest_correction == 30);
  CHECK(is(metrics.rows[0], 'a', left, right, 10, 40));
}

// A robot that is still in (c) from the previous correction does not assist the next one yet.
void test_robot_still_in_c_does_not_assist_the_next_correction() {
  Metrics metrics;
  Script team;
  team.in(right, 'a', 1);
  metrics.note(1, team);
  team.in(left, 'c', 0);
  metrics.note(3, team);
  team.in(right, ' ', 0);
  metrics.note(5, team);
  team.in(right, 'a', 1);
  metrics.note(6, team);
  team.in(right, ' ', 0);
  metrics.note(9, team);
  metrics.close(12);
  CHECK(metrics.corrections == 2);
  CHECK(is(metrics.rows[0], 'a', right, left, 1, 5));
  CHECK(is(metrics.rows[1], 'a', right, CorrectionActivity::nobody, 6, 9));
}

// Both ask: (a) becomes (b), one correction of each, each assisted by the other. (d) has no
// assistant.
void test_crossing_requests_are_one_correction_each() {
  Metrics metrics;
  Script team;
  team.in(left, 'a', 1);
  metrics.note(2, team);
  team.in(right, 'a', 1);
  metrics.note(4, team);
  team.in(left, 'b', 1);
  team.in(right, 'b', 1);
  metrics.note(7, team);
  team.in(left, ' ', 0);
  team.in(right, ' ', 0);
  metrics.note(20, team);
  team.in(right, 'd', -1);
  metrics.note(30, team);
  team.in(left, 'c', 0);
  metrics.note(31, team);
  metrics.close(33);  // (d) is still open
  CHECK(metrics.corrections == 3 && metrics.longest_correction == 18);
  CHECK(is(metrics.rows[0], 'b', left, right, 2, 20));
  CHECK(is(metrics.rows[1], 'b', right, left, 4, 20));
  CHECK(is(metrics.rows[2], 'd', right, CorrectionActivity::nobody, 30, 33));
}

// Ticks in which a robot waits, and since when it does: without a break, in one case.
void test_waiting() {
  Metrics metrics;
  Script team;
  team.in(left, 'a', 1);
  team.waiting = {true, false};
  metrics.note(5, team);
  metrics.note(6, team);  // nothing new
  team.waiting = {true, true};
  team.in(right, 'c', 0);
  metrics.note(8, team);
  CHECK((metrics.waits_since == PerSide<std::uint32_t>{5, 8}));
  team.waiting = {false, true};
  metrics.note(12, team);
  CHECK((metrics.waiting_ticks == PerSide<std::uint32_t>{7, 4}));
  team.waiting = {true, true};
  team.in(right, 'a', 1);
  metrics.note(20, team);
  CHECK((metrics.waits_since == PerSide<std::uint32_t>{20, 20}));
  team.waiting = {true, false};
  metrics.note(22, team);
  metrics.close(30);
  CHECK((metrics.waiting_ticks == PerSide<std::uint32_t>{17, 14}));
  CHECK((metrics.waits_since == PerSide<std::uint32_t>{20, 30}));
}

// The left robot's corrections, `count` of them with signs that alternate but for the one `broken`,
// each of 3 ticks and `apart` ticks after the end of the last.
bool cycles(int count, std::uint32_t apart, int broken = -1) {
  Metrics metrics;
  metrics.settle_ticks = 20;
  Script team;
  std::uint32_t tick = 1;
  for (int i = 0; i < count; ++i) {
    const bool is_even = (i % 2 == 0) != (broken >= 0 && i >= broken);
    team.in(left, is_even ? 'a' : 'd', is_even ? 1 : -1);
    metrics.note(tick, team);
    team.in(left, ' ', 0);
    metrics.note(tick += 3, team);
    tick += apart;
  }
  metrics.close(tick);
  CHECK(!metrics.limit_cycle[right]);
  CHECK(metrics.corrections == static_cast<std::uint32_t>(count));
  return metrics.limit_cycle[left];
}

// Eight in a row, each soon after the last and of the other sign.
void test_limit_cycle() {
  CHECK(limit_cycle_length == 8);
  CHECK(!cycles(7, 5) && cycles(8, 5));
  CHECK(cycles(8, 20) && !cycles(30, 21));
  CHECK(!cycles(12, 5, 6) && cycles(15, 5, 6));
}

// What leaves a contact alone is of neither sign.
void test_no_cycle_without_a_sign() {
  Metrics metrics;
  metrics.settle_ticks = 20;
  Script team;
  for (std::uint32_t i = 0; i < 20; ++i) {
    team.in(left, 'd', 0);
    metrics.note(4 * i + 1, team);
    team.in(left, ' ', 0);
    metrics.note(4 * i + 3, team);
  }
  CHECK(metrics.corrections == 20 && !metrics.limit_cycle[left]);
}

// A station's correction of both contacts counts for both robots.
void test_a_cycle_of_both() {
  Metrics metrics;
  metrics.settle_ticks = 4;
  Script team;
  for (std::uint32_t i = 0; i < 8; ++i) {
    CHECK(!metrics.limit_cycle[left] && !metrics.limit_cycle[right]);
    const std::int8_t sense = i % 2 == 0 ? 1 : -1;
    team.doing[left] = {
        i % 2 == 0 ? '7' : '8', CorrectionActivity::both, CorrectionActivity::nobody, {}};
    team.doing[left].sense = {sense, static_cast<std::int8_t>(-sense)};
    team.names[left] = team.doing[left].name;
    metrics.note(10 * i + 1, team);
    team.doing[left] = {};
    team.names[left] = ' ';
    metrics.note(10 * i + 8, team);
  }
  CHECK(metrics.limit_cycle[left] && metrics.limit_cycle[right]);
  CHECK(metrics.rows[0].robot == CorrectionActivity::both && metrics.corrections == 8);
}

// Corrections beyond the capacity of the list are counted and do not change the list.
void test_corrections_beyond_the_list_are_counted() {
  Metrics metrics;
  Script team;
  for (std::uint32_t i = 0; i < max_corrections + 3; ++i) {
    team.in(left, 'a', 1);
    metrics.note(4 * i + 1, team);
    team.in(right, 'c', 0);
    metrics.note(4 * i + 2, team);
    team.in(left, ' ', 0);
    team.in(right, ' ', 0);
    metrics.note(4 * i + 3, team);
  }
  metrics.close(9999);
  CHECK(metrics.corrections == max_corrections + 3);
  for (std::uint32_t i = 0; i < max_corrections; ++i) {
    CHECK(is(metrics.rows[i], 'a', left, right, 4 * i + 1, 4 * i + 3));
  }
}

void test_contact_events_are_recorded() {
  Metrics metrics;
  ContactEventCounter<double> now;
  metrics.observe(3, now, false);
  CHECK(metrics.contact_events == 0);
  // Within one tick.
  now = {1, ContactKind::tip, right, 0.25, 0.75};
  metrics.observe(4, now, false);
  metrics.observe(5, now, false);
  // From one tick to a later one.
  now = {2, ContactKind::flush, left, 0.5, 0};
  metrics.observe(6, now, true);
  metrics.observe(7, now, true);
  now.ended = 0.125;
  metrics.observe(9, now, false);
  // It ends, and another one begins that lasts to the end of the carry.
  now = {3, ContactKind::flush, right, 0, 0};
  metrics.observe(10, now, true);
  now = {4, ContactKind::tip, left, 0.5, 0};
  metrics.observe(11, now, true);
  metrics.time_ticks = 12.5;
  metrics.close(13);
  CHECK(metrics.contact_events == 4);
  const std::vector<std::pair<double, double>> times{
      {4.25, 4.75}, {6.5, 9.125}, {10, 11.5}, {11.5, 12.5}};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(metrics.contact_event_rows[i].start == times[i].first);
    CHECK(metrics.contact_event_rows[i].end == times[i].second);
  }
  CHECK(metrics.contact_event_rows[0].kind == ContactKind::tip &&
        metrics.contact_event_rows[0].side == right);
  CHECK(metrics.contact_event_rows[1].kind == ContactKind::flush &&
        metrics.contact_event_rows[1].side == left);
}

// In blocks, of which the last is shorter.
template <class Real>
void test_squares_and_peaks() {
  Metrics metrics;
  CHECK(metrics.rms(left) == 0);
  ContactStatistics<Real> statistics{};
  double squares[2] = {};
  for (std::uint32_t i = 0; i < 150; ++i) {
    if (i % 64 == 0) metrics.collect(statistics, i == 0 ? 0 : 64);
    const PerSide<Real> p{Real(i < 70 ? 0.5 : -1), Real(i == 40 ? -3 : 0.25)};
    statistics.add(p);
    for (const std::size_t side : {left, right}) squares[side] += double(p[side] * p[side]);
  }
  metrics.collect(statistics, 150 - 128);
  CHECK(metrics.samples == 150);
  CHECK(metrics.peak[left] == 1 && metrics.peak[right] == 3);
  for (const std::size_t side : {left, right}) {
    CHECK(metrics.square_sum[side] == squares[side]);
    CHECK(metrics.rms(side) == std::sqrt(squares[side] / 150));
  }
}

}  // namespace

int main() {
  test_a_correction_with_its_assistant();
  test_robot_still_in_c_does_not_assist_the_next_correction();
  test_crossing_requests_are_one_correction_each();
  test_waiting();
  test_limit_cycle();
  test_no_cycle_without_a_sign();
  test_a_cycle_of_both();
  test_corrections_beyond_the_list_are_counted();
  test_contact_events_are_recorded();
  test_squares_and_peaks<double>();
  test_squares_and_peaks<float>();
}
