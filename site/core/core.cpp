// SPDX-License-Identifier: Apache-2.0
// The core of the page: a C interface over the shipped headers, compiled to WebAssembly.
//
// The page writes numbers into input(), calls a function and reads numbers from the array that it
// returned; length() is the number of entries. The functions keep one scene, one policy and one
// recorded carry. site/src/shared/core.ts is the other side.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "page_scene.hpp"
#include "palmbots/base/wilson.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "palmbots/stability/tolerance.hpp"
#include "recorded_carry.hpp"
#include "statics_of_state.hpp"
#include "touched_state.hpp"

// The C++ library calls this in place of an exception. Its own version prints, for which the module
// would need a console.
void std::__libcpp_verbose_abort(const char*, ...) noexcept { __builtin_trap(); }

#define PAGE_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace {

using namespace palmbots;

constexpr std::size_t input_capacity = 4096;
constexpr std::size_t policy_controller = controller_infos.size();

std::array<double, input_capacity> given;
std::array<char, 16 * input_capacity> given_text;
std::string answer_text;
page::PageScene page_scene;
Spec& scene = page_scene.spec;
RowPolicy policy;
std::vector<Fork> forks;
page::RecordedCarry carry;
page::Tally tally;
page::TouchedState touched;
std::vector<double> answer;
std::size_t answer_length = 0;

page::NumberStream arguments() { return page::NumberStream(given.data()); }

const double* give(const std::vector<double>& numbers) {
  answer_length = numbers.size();
  return numbers.data();
}

// The team of a controller: one of the registry by its number, or after them the rows of a policy.
page::PageTeam team_of(std::uint32_t controller, std::uint64_t seed) {
  if (controller >= policy_controller) {
    return page::PageTeam(
        RowPolicyTeam(channel_of(scene), seed, leader_of(scene), Faults::of(scene, seed), policy));
  }
  return visit_team(controller_infos[controller].name,
                    [&](auto make) { return page::PageTeam(make(scene, seed)); });
}

PerSide<AnglePair<double>> scene_angles() {
  PerSide<AnglePair<double>> angles{};
  for (const std::size_t side : {left, right}) {
    angles[side] = {PalmAngle<double>::at(scene.palms[side].shallow),
                    PalmAngle<double>::at(scene.palms[side].steep)};
  }
  return angles;
}

Region<double> square_region(double half) {
  return {Interval<double>{-half, half}, Interval<double>{-half, half}};
}

}  // namespace

PAGE_EXPORT(input) double* input() { return given.data(); }
PAGE_EXPORT(text) char* text() { return given_text.data(); }
PAGE_EXPORT(length) std::uint32_t length() { return static_cast<std::uint32_t>(answer_length); }

// Names for people: of a kind of message, and of a kind of contact event.
PAGE_EXPORT(message_name) const char* message_name(std::uint32_t kind) {
  return name_of(static_cast<MessageKind>(kind % all_message_kinds));
}

// The 95 % interval of the rate of k events in n.
PAGE_EXPORT(rate_interval) const double* page_rate_interval(double k, double n) {
  const RateInterval ends = rate_interval(k, n);
  answer = {ends.low, ends.high};
  return give(answer);
}

PAGE_EXPORT(controller_count) std::uint32_t controller_count() {
  return static_cast<std::uint32_t>(policy_controller);
}

// Takes the scene (page_scene.hpp): so many bytes of text, and the numbers of the input.
PAGE_EXPORT(set_scene) void set_scene(std::uint32_t bytes) {
  page_scene = page::read_scene({given_text.data(), bytes}, arguments());
}

// What is wrong with the scene: key, problem and what is allowed, one below the other; empty if
// nothing is. The answer holds the numbers of the value to show; none: it is that of the key.
PAGE_EXPORT(problem) const char* problem() {
  answer.clear();
  answer_text.clear();
  if (!page_scene.problems.empty()) {
    const Problem& first = page_scene.problems.front();
    answer_text = page::problem_lines(first);
    const auto value = first.value.all();
    answer.assign(value.begin(), value.end());
  }
  return answer_text.c_str();
}
// Why no carry of a scene without problems can begin; empty if one can.
PAGE_EXPORT(refusal) const char* refusal() { return page_scene.refusal.c_str(); }
PAGE_EXPORT(answered) const double* answered() { return give(answer); }

// Of the scene's object: contacts, centre of mass [m], and the outline, from which they follow where
// they are not given.
PAGE_EXPORT(object) const double* object() {
  answer.assign(page_scene.object.begin(), page_scene.object.end());
  return give(answer);
}

// Of the scene: its time limit [s], and the longest one with which the page carries, or 0 if the
// scene's own is not longer; the friction coefficients of both palms; whether the object is a pipe;
// whether the job begins or ends on the floor; the height of the floor over the pivots [m].
PAGE_EXPORT(scene_facts) const double* scene_facts() {
  answer = {
      page_scene.timeout,          page_scene.is_too_long() ? page_scene.longest_timeout() : 0.0,
      scene.palms[left].friction,  scene.palms[right].friction,
      scene.width > 0 ? 0.0 : 1.0, uses_floor(scene) ? 1.0 : 0.0,
      floor_level(scene)};
  return give(answer);
}

// Takes nine rows: palms (0 steep, 1 shallow) and drives (0 hold, 1 away, 2 closer), left first.
PAGE_EXPORT(set_policy) void set_policy() {
  page::NumberStream in = arguments();
  RowPolicy::Rows rows{};
  for (RowPolicy::Row& row : rows) {
    for (Palm& palm : row.palms) palm = static_cast<Palm>(in.whole() % 2);
    for (Move& drive : row.drives) drive = static_cast<Move>(in.whole() % 3);
  }
  policy = RowPolicy(rows);
}

// Takes pairs of a time [s] and a seed.
PAGE_EXPORT(set_forks) void set_forks() {
  page::NumberStream in = arguments();
  forks.resize(in.count(64));
  for (Fork& fork : forks) {
    fork.tick = static_cast<std::uint32_t>(in.next() / scene.period + 0.5);
    fork.seed = static_cast<std::uint64_t>(in.next());
  }
}

// Whether a controller can keep its time bounds in the scene: 0: it can, else the beacon period is too
// short (1), the lease is too short (2) or too long (3). Then the bounds: beacon period, radio delay,
// lease, shortest and longest lease [s], and room on the palm [m].
PAGE_EXPORT(timing) const double* timing(std::uint32_t controller) {
  answer.assign(7, 0.0);
  if (controller < policy_controller && controller_infos[controller].has_time_bounds) {
    const ResilientTiming b = resilient_timing_of(scene);
    const double tick = scene.period;
    answer = {double(b.problem),       b.times.beacon * tick,  b.delay * tick, b.times.lease * tick,
              b.shortest_lease * tick, b.longest_lease * tick, b.room};
  }
  return give(answer);
}

// Carries once. Returns metrics; rows(), messages() and so on give the rest.
PAGE_EXPORT(run) const double* run(std::uint32_t controller, double seed) {
  const bool stops_in_silence =
      controller < policy_controller && controller_infos[controller].stops_in_silence;
  const auto whole = static_cast<std::uint64_t>(seed);
  page::PageTeam team = team_of(controller, whole);
  carry = uses_floor(scene) ? page::record_job(scene, whole, std::move(team), stops_in_silence)
                            : page::record(scene, whole, std::move(team), forks, stops_in_silence);
  return give(carry.metrics);
}
PAGE_EXPORT(rows) const double* rows() { return give(carry.rows); }
PAGE_EXPORT(messages) const double* messages() { return give(carry.messages); }
PAGE_EXPORT(corrections) const double* corrections() { return give(carry.corrections); }
PAGE_EXPORT(contact_events) const double* contact_events() { return give(carry.contact_events); }
PAGE_EXPORT(phases) const double* phases() { return give(carry.phases); }
PAGE_EXPORT(warnings) const char* warnings() { return carry.warnings.c_str(); }
// The warnings that are known before a carry, one a line. The rows of a policy are a station's.
PAGE_EXPORT(warnings_before) const char* page_warnings_before(std::uint32_t controller) {
  const ControllerInfo info = controller < policy_controller
                                  ? controller_infos[controller]
                                  : ControllerInfo{.name = "", .decider = Decider::station};
  answer_text = page::warning_lines(page_scene, info);
  return answer_text.c_str();
}

// The places (sim/placement.hpp) at a row of a carry, which the input holds.
PAGE_EXPORT(places) const double* places() {
  const double* row = given.data();
  PairPose pose{};
  for (const std::size_t side : {left, right}) {
    pose.configuration.contacts[side] = row[1 + side];
    pose.configuration.palms[side] = PalmAngle<double>::at(row[3 + side]);
    pose.configuration.lift[side] = row[18 + side];
    pose.height[side] = row[24 + side];
  }
  pose.configuration.separation = row[9];
  pose.midpoint = row[10];
  const SinCos<double> turn = sin_cos(row[11]);
  pose.turn = {turn.cos, turn.sin};
  answer.clear();
  append_places(scene, pose, answer);
  return give(answer);
}

// Carries seeds first … first + n − 1 and adds them up: carries, drops, stalls, mean square contact
// coordinate [m²], messages per metre, corrections.
PAGE_EXPORT(clear_tally) void clear_tally() { tally = {}; }
PAGE_EXPORT(add_to_tally)
const double* add_to_tally(std::uint32_t controller, double first, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto seed = static_cast<std::uint64_t>(first) + i;
    if (uses_floor(scene)) {
      tally.add_job(scene, seed, team_of(controller, seed));
    } else {
      tally.add(scene, seed, team_of(controller, seed));
    }
  }
  const double each = tally.carries > 0 ? tally.carries : 1;
  answer = {tally.carries,
            tally.dropped,
            tally.stalled,
            tally.square_sum / (2 * each),
            tally.way > 0 ? tally.messages / tally.way : 0,
            tally.corrections / each};
  return give(answer);
}

// The mechanics of one state: palm angles [rad] and contacts [m], left first.
PAGE_EXPORT(statics)
const double* statics(double theta_left, double theta_right, double p_left, double p_right) {
  answer.clear();
  page::StaticsOfState(scene).append({{theta_left, theta_right}, {p_left, p_right}}, answer);
  return give(answer);
}

// Everything that touches the object: on two palms, or on a floor on which the palms stand. The next
// two functions are about the state that was asked for last.
PAGE_EXPORT(touch_palms)
const double* touch_palms(double theta_left, double theta_right, double p_left, double p_right) {
  touched = page::TouchedState::on_palms(scene, {theta_left, theta_right}, {p_left, p_right});
  answer.clear();
  touched.append(answer);
  return give(answer);
}
PAGE_EXPORT(touch_floor)
const double* touch_floor(double theta_left, double theta_right, double driven_left,
                          double driven_right, double raised, double friction,
                          std::uint32_t has_right) {
  touched = page::TouchedState::on_floor(
      scene,
      {{theta_left, theta_right}, {driven_left, driven_right}, raised, friction, has_right != 0});
  answer.clear();
  touched.append(answer);
  return give(answer);
}
// What is wrong, why the palms stopped early, why they were not moved, and what touches, one a line.
PAGE_EXPORT(touched_text) const char* touched_text() {
  answer_text =
      touched.problem() + "\n" + touched.end() + "\n" + touched.refusal() + "\n" + touched.kinds();
  return answer_text.c_str();
}
// The contact modes that may occur while the palms move: velocities of the pivots [m/s] and spins,
// anticlockwise [rad/s].
PAGE_EXPORT(touched_modes)
const double* touched_modes(double x_left, double y_left, double spin_left, double x_right,
                            double y_right, double spin_right) {
  answer.clear();
  const RigidMotion of_left{{x_left, y_left}, spin_left};
  const RigidMotion of_right{{x_right, y_right}, spin_right};
  touched.append_modes({of_left, of_right}, answer);
  return give(answer);
}

PAGE_EXPORT(contact_mode_map)
const double* contact_mode_map(double theta_left, double theta_right, std::uint32_t closing,
                               std::uint32_t n, double reach) {
  answer.clear();
  page::StaticsOfState(scene).append_contact_mode_map({theta_left, theta_right}, closing != 0, n,
                                                      reach, answer);
  return give(answer);
}

// COMs for which the properties hold, with any angles [rad] as the shallow and the steep ones.
PAGE_EXPORT(com_map)
const double* com_map(double x_low, double x_high, double y_low, double y_high, std::uint32_t nx,
                      std::uint32_t ny, double shallow_left, double steep_left,
                      double shallow_right, double steep_right) {
  const auto angle = [](double theta) { return PalmAngle<double>::at(theta); };
  answer.clear();
  page::StaticsOfState(scene).append_com_map(
      {{{angle(shallow_left), angle(steep_left)}, {angle(shallow_right), angle(steep_right)}}},
      {x_low, x_high}, {y_low, y_high}, nx, ny, answer);
  return give(answer);
}

// What limits the scene's own angles over contacts within ± half [m]; 0: anywhere on the palms.
PAGE_EXPORT(limits) const double* limits(double half) {
  answer.clear();
  const page::StaticsOfState statics_of(scene);
  const Region<double> region = half > 0 ? square_region(half) : statics_of.whole_palms();
  statics_of.append_limits(scene_angles(), region, answer);
  return give(answer);
}

// Tolerance of a quantity and clearance [rad] at n × n pairs of angles [rad], shallow outermost, with
// contacts within ± half [m]. −∞: steep is not above shallow, or the clearance was not computed.
PAGE_EXPORT(tolerance_map)
const double* tolerance_map(double from, double step, std::uint32_t n, std::uint32_t quantity,
                            double most, double half) {
  const page::StaticsOfState statics_of(scene);
  const OperatingEnvelope<double> envelope = statics_of.envelope(square_region(half));
  const double x = statics_of.model().object.com_left;
  constexpr double none = -std::numeric_limits<double>::infinity();
  answer.assign(2 * std::size_t{n} * n, none);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto shallow = PalmAngle<double>::at(from + step * i);
    for (std::uint32_t j = i + 1; j < n; ++j) {
      const AnglePair<double> pair{shallow, PalmAngle<double>::at(from + step * j)};
      const std::size_t at = 2 * (std::size_t{i} * n + j);
      answer[at] = tolerance<double>(envelope, {x, x}, static_cast<Quantity>(quantity % 5), most,
                                     {pair, pair});
      if (answer[at] >= 0) answer[at + 1] = clearance_margin<double>(envelope, {pair, pair});
    }
  }
  return give(answer);
}
