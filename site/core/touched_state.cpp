// SPDX-License-Identifier: Apache-2.0
// Apart from core.cpp, because it serves one picture at a time and is compiled to be small.
#include "touched_state.hpp"

#include "palmbots/mechanics/mode_forces.hpp"
#include "palmbots/mechanics/mode_margin.hpp"
#include "palmbots/sim/palm_way.hpp"
#include "palmbots/sim/placement.hpp"
#include "palmbots/sim/standing_start.hpp"

namespace palmbots::page {

namespace {

// Distance between the object and the inner ends at the start (palmbots.simulation.FloorWorld) [m].
constexpr double floor_gap = 0.01;
constexpr double absent = 100;   // how far away a palm is that there is not [m]
constexpr int most_falls = 100;  // in a motion

// Where the pivots are at one height, a pipe touches the right palm here [m].
double place_on_right(const Spec& spec, const Configuration<double>& at) {
  const PerSide<double> offset = model_of<double>(spec).offset;
  return at.contacts[right] - contact_vector(at, offset).dy / at.palms[right].sin;
}

}  // namespace

TouchedState TouchedState::on_palms(const Spec& spec, const PerSide<double>& theta,
                                    const PerSide<double>& p) {
  TouchedState here(spec);
  Configuration<double> at{
      0.0, {PalmAngle<double>::at(theta[left]), PalmAngle<double>::at(theta[right])}, p};
  if (spec.width == 0) at.contacts[right] = place_on_right(spec, at);
  const StateContacts found = contacts_of_state(spec, theta, at.contacts);
  here.problem_ = refusal_of(found, spec, theta);
  for (const StateContact& one : found.touched) here.add(one);
  here.pivots_ = found.pivots;
  at.separation = found.pivots[right].x - found.pivots[left].x;
  here.places_ = {0.0, 0.0};
  if (spec.width == 0) append_places(spec, {at, 0.0, {1.0, 0.0}}, here.places_);
  return here;
}

TouchedState TouchedState::on_floor(const Spec& given, const FloorState& state) {
  Spec spec = given;
  spec.floor_friction = state.friction;
  TouchedState here(spec);
  here.problem_ = standing_refusal(spec);
  if (!here.problem_.empty()) return here;
  Model<double> model = model_of<double>(spec);
  model.safe_reach = -1;  // the palms may have any angles
  model.limit = no_limits<double>;
  model.surroundings = surroundings_of(spec);
  World<double> world(model, configuration_of(spec, model));
  world.set_phase(CarryPhase::by_hand, spec.fall);
  const StandingStart start =
      StandingStart::of(spec, state.theta, {floor_gap, state.has_right ? floor_gap : absent});
  world.put(start.pivots, state.theta, Pose::of(start.com, 0.0));
  const bool has_blocks = spec.wall_count + spec.stand_count > 0;
  if (has_blocks) here.problem_ = refusal_of_start(world.check());
  if (!here.problem_.empty()) return here;
  const auto may_move = [&](const PerSide<Vec>& by, const char* when) {
    const Travel way =
        Travel::of({world.pivot(left), world.pivot(right)}, state.theta, by, state.theta);
    here.refusal_ = refusal_of_way(spec, spec.palms, way, {true, state.has_right}, when);
    return here.refusal_.empty();
  };
  // After a fall the motion goes on.
  const auto move = [&](PerSide<Vec> by) {
    if (!may_move(by, "on the way")) return;
    for (int k = 0; k < most_falls && here.end_.empty(); ++k) {
      const Advance<double>& step = world.advance(by, state.theta);
      here.end_ = name_of(step.reason);
      if (!world.fall()) return;
      by = {by[left] * (1 - step.fraction), by[right] * (1 - step.fraction)};
    }
  };
  if (may_move({}, "at the start")) {
    move({Vec{state.driven[left], 0.0}, Vec{state.has_right ? -state.driven[right] : 0.0, 0.0}});
    if (state.raised != 0 && here.refusal_.empty())
      move({Vec{0.0, state.raised}, Vec{0.0, state.raised}});
  }
  for (const Touched& one : world.touched_in(contact_tolerance<double> * spec.width)) {
    here.add(one);
  }
  const Pose pose = world.pose();
  here.places_ = {start.pivots[left].x, start.pivots[right].x};
  PairPose at{world.configuration(), 0.0, {pose.cos, pose.sin}};
  for (const std::size_t side : {left, right}) {
    Vec pivot = world.pivot(side);
    if (side == right && !state.has_right) {  // for the picture, beside the object
      pivot.x = 2 * pose.at.x - world.pivot(left).x;
      at.configuration.separation = pivot.x - world.pivot(left).x;
      at.configuration.contacts[right] = 0;
    }
    here.pivots_[side] = pivot - pose.at;
    at.height[side] = pivot.y;
    at.midpoint += 0.5 * pivot.x;
  }
  append_places(spec, at, here.places_);
  return here;
}

std::string TouchedState::kinds() const {
  std::string lines;
  for (const Touched& one : touched_) lines.append(one.kind).append("\n");
  return lines;
}

void TouchedState::append(std::vector<double>& out) const {
  out.insert(out.end(), {balances(supports_, {}, slope_) ? 1.0 : 0.0, double(supports_.size())});
  for (std::size_t i = 0; i < supports_.size(); ++i) {
    const Support& s = supports_[i];
    out.insert(out.end(), {double(touched_[i].carrier), touched_[i].place, s.point.x, s.point.y,
                           s.normal.x, s.normal.y, s.friction});
  }
  out.insert(out.end(), places_.begin(), places_.end());
}

void TouchedState::append_modes(const PerSide<RigidMotion>& palms, std::vector<double>& out) const {
  Velocities velocities{};
  SurfaceNumbers surfaces{};
  for (std::size_t i = 0; i < supports_.size(); ++i) {
    const std::size_t carrier = touched_[i].carrier;
    surfaces[i] = carrier > right ? 0 : carrier + 1;  // by name, as in Python
    if (carrier > right) continue;
    velocities[i] = palms[carrier].velocity_at(supports_[i].point - pivots_[carrier]);
  }
  each_outcome(supports_, velocities, slope_, [&](const Motions& motions) {
    const auto forces = contact_forces(supports_, motions, slope_);
    const ModeMargin margin = margin_of(supports_, motions, slope_, surfaces);
    const Motions at_limit = loaded_edges(margin.supports, motions, slope_);
    for (std::size_t i = 0; i < supports_.size(); ++i) {
      out.insert(out.end(), {double(motions[i]), forces[i].normal.low, forces[i].normal.high,
                             forces[i].friction.low, forces[i].friction.high, double(at_limit[i])});
    }
    out.push_back(margin.angle);
  });
}

void TouchedState::add(const Touched& one) {
  if (supports_.full()) return;
  supports_.push_back(one.support);
  touched_.push_back(one);
}

}  // namespace palmbots::page
