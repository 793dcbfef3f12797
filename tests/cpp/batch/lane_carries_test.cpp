// SPDX-License-Identifier: Apache-2.0
// Carries in lanes do what single carries do.
//
// lane_carries_test [SEEDS]   SEEDS: carries with each scene, controller and precision; if not given,
//                             one with each scene and controller in one of the precisions, and half of
//                             the rare ones
#include "palmbots/batch/lane_carries.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "palmbots/sim/team_registry.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

namespace {

using namespace palmbots;

template <class Real>
bool same_bits(Real a, Real b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_touches(const Metrics& a, const Metrics& b) {
  for (std::uint32_t i = 0; i < a.contact_events && i < max_contact_events; ++i) {
    const ContactEventRow &x = a.contact_event_rows[i], &y = b.contact_event_rows[i];
    if (x.kind != y.kind || x.side != y.side || x.start != y.start || x.end != y.end) return false;
  }
  return a.contact_events == b.contact_events;
}

bool same(const Metrics& a, const Metrics& b) {
  return a.outcome == b.outcome && a.reason == b.reason && a.time_ticks == b.time_ticks &&
         a.square_sum == b.square_sum && a.peak == b.peak && a.samples == b.samples &&
         a.waiting_ticks == b.waiting_ticks && a.waits_since == b.waits_since &&
         a.corrections == b.corrections && a.bumps == b.bumps && same_touches(a, b);
}

// What is known of corrections one by one.
bool same_corrections(const Metrics& a, const Metrics& b) {
  return a.longest_correction == b.longest_correction && a.limit_cycle == b.limit_cycle;
}

template <class Team>
bool runs_in_bits(const Team& team) {
  if constexpr (BitslicedTeam<Team>::exist) return BitslicedTeam<Team>::supports(team);
  return false;
}

std::size_t part = 1;          // one in so many rare cases is tried
bool outcomes[4] = {};         // that carries came to
std::uint32_t most_bumps = 0;  // in one of them
bool touched_and_came_free = false;

// Every carry of a mixed lot ends, once, as it does alone. Carry i, from `first` on, has spec i and
// seed i.
template <class Real, class Make>
void test_lane_carries(Make make, const std::vector<Spec>& specs, std::size_t count,
                       std::size_t first = 0) {
  using Team = decltype(make(specs[0], 0));
  auto lanes = std::make_unique<LaneCarries<Real, lanes_of<Real>, Team>>();
  std::size_t given = 0;
  std::size_t finished = 0;
  lanes->run(
      [&](auto& slot, std::size_t& index) {
        if (given == count) return false;
        index = first + given++;
        const Spec& spec = specs[index % specs.size()];
        slot.emplace(spec, index, make(spec, index), NoRecorder{});
        return true;
      },
      [&](std::size_t index, const auto& carry) {
        ++finished;
        const Spec& spec = specs[index % specs.size()];
        Carry<Real, Team, NoRecorder> alone(spec, index, make(spec, index), NoRecorder{});
        alone.run();
        CHECK(same(carry.metrics(), alone.metrics()));
        // Teams that decide in bits count them only.
        if (!runs_in_bits(alone.team())) {
          CHECK(same_corrections(carry.metrics(), alone.metrics()));
        }
        CHECK(same_bits(carry.midpoint(), alone.midpoint()));
        CHECK(carry.team().link_totals.sent == alone.team().link_totals.sent);
        CHECK(carry.team().link_totals.lost == alone.team().link_totals.lost);
        for (std::size_t link = 0; link < alone.team().link_totals.links.size(); ++link) {
          const LinkCounts &one = carry.team().link_totals.links[link],
                           &other = alone.team().link_totals.links[link];
          CHECK(one.sent == other.sent && one.lost == other.lost && one.late == other.late);
        }
        const Metrics& m = alone.metrics();
        outcomes[static_cast<int>(m.outcome)] = true;
        most_bumps = std::max(most_bumps, m.bumps);
        for (std::uint32_t i = 0; i < m.contact_events && i < max_contact_events; ++i) {
          touched_and_came_free |= m.contact_event_rows[i].end < m.time_ticks;
        }
      },
      [] { return false; });
  CHECK(finished == count);
}

// Bumps: listed in and out of order, two in one tick, random ones, and harsh ones that end a carry.
void add_bumps(Spec& spec, bool harsh) {
  const double shift = harsh ? 0.06 : 0.01;
  spec.bumps[0] = {0, 1, 3.0, shift};
  spec.bumps[1] = {1, 0, 0.2, -shift};
  spec.bumps[2] = {1, 1, 0.0, 0.002};
  spec.bumps[3] = {0, 0, 0.1, -shift};
  spec.bumps[4] = {1, 1, 3.0, 0.003};
  spec.bump_count = 5;
  spec.bump_rate = harsh ? 0 : 10;
  spec.bump_max = shift;
}

// Long palms upon which the object comes to lie flush; from the flat ones bumps free it again.
void set_long_palms(Spec& spec, bool flat) {
  spec.bump_rate = flat ? 60 : 10;
  spec.bump_max = flat ? 0.06 : 0.01;
  for (PalmSpec& palm : spec.palms) {
    palm.length = 0.8;
    palm.shallow = flat ? 0.01 : 0.001;
    palm.steep = flat ? 0.01 : 0.1;
  }
}

// Sensors that read 0 beyond their end.
void set_zones_with_an_end(Spec& spec) {
  spec.zones[0] = {-1, -0.05, -0.01};
  spec.zones[1] = {1, 0.01, 0.012};
  spec.zone_count = 2;
}

// A contact starts at the largest coordinate that reads 0, at the smallest, or beside them.
void set_at_an_edge(Spec& spec, int which) {
  const double edge = which % 2 == 0 ? spec.zones[1].from : spec.zones[1].to;
  const double infinity = std::numeric_limits<double>::infinity();
  spec.start[which % 2] = which < 2   ? edge
                          : which < 4 ? std::nextafter(float(edge), float(infinity))
                                      : std::nextafter(float(edge), -float(infinity));
  for (RobotSpec& robot : spec.robots) robot.noise = 0;
  spec.timeout_ticks = 70;
}

std::vector<Spec> mixed_specs() {
  std::vector<Spec> specs;
  for (int i = 0; i < 35; ++i) {
    Spec spec = paper_spec();
    spec.distance = 0.2 + 0.015 * i;
    spec.safe_reach = i % 2 == 0 ? -1 : 0.037;
    if (i == 1) spec.robots[left].bias = 0.01;
    if (i == 2) spec.timeout_ticks = 77;
    if (i == 3) spec.palms[left].offset = 0.01;
    if (i == 4) spec.direction = -1;
    if (i == 5) spec.start[right] = 0.075;
    if (i == 6) spec.bump_rate = 5;
    if (i == 6) spec.bump_max = 0.004;
    if (i == 7) spec.palms[right].friction = 0.12;
    if (i == 7) spec.start[left] = 0.07;
    if (i == 8) spec.false_rate = 0.01;
    if (i == 9 || i == 10) add_bumps(spec, i == 10);
    if (i == 11 || i == 12) set_long_palms(spec, i == 12);
    if (i == 13) spec.latency = 0;
    if (i == 14) spec.latency = 0.63;  // as late as teams in bits can have it, and later
    if (i == 15) spec.latency = 0.64;
    if (i == 16) spec.loss = 0.05;
    if (i == 17) spec.jitter = 0.03;
    if (i == 18) set_zones_with_an_end(spec);
    if (i == 19) spec.zone_count = 0;
    if (i == 20) spec.faults[spec.fault_count++] = {FaultKind::reboot, 0, 1.0, 0.5};
    // Where robots on leases may go in bits, just not, and not for their clocks.
    if (i == 21) spec.lease = 1.9;
    if (i == 22) spec.lease = 2.6;
    if (i == 23) spec.robots[left].clock_drift = 1e-3;
    if (i == 24) spec.false_rate = 0.3;
    if (i == 24 || i == 25) spec.direction = -1;
    if (i == 25) spec.loss = 0.2;
    // One robot is off when it ends; the next carry in its place has none that is.
    if (i == 26) spec.faults[spec.fault_count++] = {FaultKind::reboot, 1, 0.5, 50};
    if (i == 26) spec.timeout_ticks = 150;
    // On the very edge of what sensors read as 0, and next to it.
    if (i >= 27 && i <= 32) set_at_an_edge(spec, i - 27);
    if (i == 33) spec.start[left] = 0.2;  // does not even begin
    // The robot would be off soon after the end, before the next carry comes.
    if (i == 34) spec.faults[spec.fault_count++] = {FaultKind::reboot, 0, 1.0, 50};
    if (i == 34) spec.timeout_ticks = 77;
    specs.push_back(spec);
  }
  return specs;
}

// So many specs that spec_of(i) makes of the paper's.
template <class SpecOf>
std::vector<Spec> specs_of(std::size_t count, SpecOf spec_of, double distance = 0.4) {
  std::vector<Spec> specs;
  for (std::size_t i = 0; i < count; ++i) {
    specs.push_back(paper_spec());
    specs.back().distance = distance;
    spec_of(specs.back(), i);
  }
  return specs;
}

// Palms that are there at once, where each team is asked by itself.
void be_quick(Spec& spec, std::size_t i) {
  spec.jitter = 0.03;
  for (PalmSpec& palm : spec.palms)
    (i % 2 != 0 ? palm.shallow : palm.rate) = i % 2 != 0 ? palm.steep : 100;
}

// More than two contacts, and sensors that report how far beyond a palm's end.
void reach_beyond(Spec& spec, std::size_t i) {
  set_long_palms(spec, i % 2 != 0);
  for (PalmSpec& palm : spec.palms) palm.length = 0.05 + 0.01 * double(i / 2 % 12);
  spec.jitter = 0.02;
  const double edge = 0.5 * spec.palms[left].length - 0.002;
  spec.zones[0].to = spec.zones[1].from = -edge;
  spec.zones[1].to = spec.zones[2].from = edge;
  spec.bump_max = 0.02;
}

// Objects that lie flush within the safe reach until a bump frees them.
void come_free(Spec& spec, std::size_t i) {
  set_long_palms(spec, true);
  spec.distance = 0.8;  // some thirty bumps
  spec.safe_reach = 0.35;
  spec.bump_rate = 40;
  spec.bump_max = 0.03 + 0.02 * double(i % 4);
  for (PalmSpec& palm : spec.palms) {
    palm.shallow = 0.01 * double(i % 3);
    palm.steep = palm.shallow + 0.02 * double(i / 3 % 3);
  }
}

// A bump sets contacts, one of which does not slide, on the very edge of a zone.
void bump_to_an_edge(Spec& spec, std::size_t i) {
  const double shift = 1.0 / 128;
  spec.zones[0].to = spec.zones[1].from = -shift;
  spec.zones[1].to = 0.5 * shift;
  spec.zones[2].from = shift;
  spec.jitter = 0.02;
  spec.start[left] = spec.start[right] = i % 2 != 0 ? 0 : -2 * shift;
  for (std::uint32_t side : {0U, 1U}) spec.bumps[side] = {side, 1, 0.01 * double(i / 2 % 4), shift};
  spec.bump_count = 2;
}

// What is drawn in one of the first ticks is just what decides.
void meet_the_word(Spec& spec, std::size_t i) {
  const auto tick = static_cast<std::uint32_t>(3 + i % 5);
  const auto lane = static_cast<std::uint32_t>(i / 2 % 4);
  if (i % 2 != 0) spec.loss = draw(i, tick, Stream::radio, lane)[0] / 4294967296.0;
  if (i % 2 == 0) spec.false_rate = draw(i, tick, Stream::tactile)[lane / 2 * 2] / 4294967296.0;
}

// The goal is just where the midpoint comes to in a tick, or next to that.
template <class Real, class Make>
void meet_the_goal(Make make, Spec& spec, std::size_t i) {
  spec.distance = 100;
  spec.direction = i % 2 != 0 ? 1 : -1;
  Carry<Real, decltype(make(spec, i)), NoRecorder> carry(spec, i, make(spec, i), NoRecorder{});
  carry.begin();
  for (std::size_t tick = 0; tick < 60 + i && !carry.done(); ++tick) carry.tick();
  spec.distance = double(carry.midpoint()) * spec.direction;
  if (i / 2 % 3 == 1) spec.distance = std::nextafter(spec.distance, 10.0);
  if (i / 2 % 3 == 2) spec.distance = std::nextafter(spec.distance, -10.0);
}

// Rare cases of what robots sense and decide, and of when a carry ends.
template <class Real, class Make>
void test_rare_decisions(Make make) {
  test_lane_carries<Real>(make, specs_of(40, be_quick, 0.2), 40 / part);
  test_lane_carries<Real>(make, specs_of(80, meet_the_word, 0.1), 80 / part);
  const auto to_the_goal = [&](Spec& spec, std::size_t i) { meet_the_goal<Real>(make, spec, i); };
  test_lane_carries<Real>(make, specs_of(48 / part, to_the_goal), 48 / part);
  // All end in the same tick, and others come.
  test_lane_carries<Real>(make, specs_of(1, [](Spec& s, std::size_t) { s.timeout_ticks = 10; }),
                          200 / part);
}

// Rare motions of the object.
template <class Real, class Make>
void test_rare_motions(Make make) {
  // Each length four times, or twice.
  test_lane_carries<Real>(make, specs_of(96, reach_beyond), 96 / part);
  test_lane_carries<Real>(make, specs_of(32, bump_to_an_edge), 32);
  // One at a time, so that no other carry has something to do in the tick.
  const std::vector<Spec> free = specs_of(40, come_free);
  for (std::size_t i = 0; i < free.size(); i += part) test_lane_carries<Real>(make, free, 1, i);
}

// A run that is asked to stop does so within a block of ticks.
void test_stop() {
  const Spec spec = paper_spec();
  auto lanes = std::make_unique<LaneCarries<double, lanes_of<double>, NoController>>();
  int asked = 0;
  lanes->run(
      [&](auto& slot, std::size_t& index) {
        slot.emplace(spec, index = 0, NoController{}, NoRecorder{});
        return true;
      },
      [](std::size_t, const auto&) {}, [&] { return ++asked == 3; });
  CHECK(asked == 3);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t seeds = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1;
  const std::vector<Spec> specs = mixed_specs();
  std::vector<Spec> halves[2];
  for (std::size_t i = 0; i < specs.size(); ++i) halves[i % 2].push_back(specs[i]);
  const bool all = seeds > 1;
  part = all ? 1 : 2;
  std::size_t turn = 0;
  for (const ControllerInfo& controller : controller_infos) {
    turn = 1 - turn;
    visit_team(controller.name, [&](auto make) {
      // One seed: half of the scenes in each precision, the other half with the next controller;
      // and decisions, which have no precision, beside one of them.
      const std::vector<Spec>& in_doubles = all ? specs : halves[turn];
      const std::vector<Spec>& in_floats = all ? specs : halves[1 - turn];
      test_lane_carries<double>(make, in_doubles, seeds * in_doubles.size());
      test_lane_carries<float>(make, in_floats, seeds * in_floats.size());
      if (all || turn == 0) test_rare_decisions<double>(make);
      if (all || turn == 1) test_rare_decisions<float>(make);
      // The world is the same with every controller; these two leave it most alone, and least.
      const std::string_view name = controller.name;
      if (name == "none") test_rare_motions<float>(make);
      if (name == "distributed") test_rare_motions<double>(make);
    });
  }
  CHECK(outcomes[1] && outcomes[2] && outcomes[3]);  // delivered, dropped, stalled
  CHECK(most_bumps > 8 && touched_and_came_free);
  test_stop();
}
