// SPDX-License-Identifier: Apache-2.0
// The general step of two vertices: what happens does not depend on where a step ends, and a contact
// that would alternate around its pivot does not take forever.
#include "palmbots/world/general_step.hpp"

#include <algorithm>
#include <cmath>

#include "palmbots/sim/build.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

constexpr double degree = radians_per_degree<double>;

struct Start {
  double friction;
  double com_left;
  double com_height;
  PerSide<double> angles;  // [deg]
  PerSide<double> contacts;
  PerSide<double> goals;  // [deg]
  double change;
};

Model<double> model_for(const Start& start) {
  Spec spec = paper_spec();
  spec.safe_reach = -1;
  spec.com_left = start.com_left;
  spec.com_right = spec.width - start.com_left;
  spec.com_height = start.com_height;
  for (PalmSpec& palm : spec.palms) palm.friction = start.friction;
  return model_of<double>(spec);
}

WorldState<double> state_at(const Start& start, const Model<double>& model) {
  WorldState<double> state{};
  Configuration<double>& at = state.configuration;
  for (const std::size_t side : {left, right}) {
    at.palms[side] = PalmAngle<double>::at(start.angles[side] * degree);
    at.contacts[side] = start.contacts[side];
  }
  at.separation = closing_separation(at, model.offset, model.object.width);
  state.contact_vector = contact_vector(at, model.offset);
  return state;
}

Advance<double> moved(const Model<double>& model, WorldState<double>& state, double change,
                      const PerSide<double>& angles) {
  return GeneralStep<double>{model, state, change, angles}.run();
}

// Palms so rough that edges wedge while one palm turns: both contacts slide for a part of the step,
// and for another part one of them would have to slide against its direction.
void test_a_step_and_its_parts() {
  constexpr int parts = 100;
  for (const Start& start : {
           Start{6.2, 0.166, 0.064, {7.4, 7.9}, {0.0058, 0.025}, {15.7, 7.94}, 0.0},
           Start{8.7, 0.149, 0.0395, {4.43, 5.08}, {0.019, 0.0}, {8.0, 4.5}, -0.0014},
       }) {
    const Model<double> model = model_for(start);
    WorldState<double> whole = state_at(start, model);
    WorldState<double> in_parts = whole;
    const PerSide<double> goals{start.goals[left] * degree, start.goals[right] * degree};
    const Advance<double> one = moved(model, whole, start.change, goals);
    double done = 0.0;
    DropReason reason = DropReason::none;
    for (int i = 1; i <= parts && reason == DropReason::none; ++i) {
      PerSide<double> next{};
      for (const std::size_t side : {left, right}) {
        const double from = start.angles[side] * degree;
        next[side] = i == parts ? goals[side] : from + (goals[side] - from) * i / parts;
      }
      const Advance<double> part = moved(model, in_parts, start.change / parts, next);
      reason = part.reason;
      done += part.fraction / parts;
    }
    CHECK(reason == one.reason && std::abs(done - one.fraction) < 1e-6);
    for (const std::size_t side : {left, right}) {
      const double apart =
          whole.configuration.contacts[side] - in_parts.configuration.contacts[side];
      CHECK(std::abs(apart) < 1e-6);
    }
  }
}

// A contact within rounding of its pivot, on a palm that turns while the palms are driven neither
// together nor apart, is driven up and down in turn. The step follows that for as many reversals as
// it allows, and the contact is still there.
void test_a_contact_at_its_pivot() {
  int most = 0;
  for (int k = -100; k <= 100; ++k) {
    const Start start{0.3, 0.125, 0.04, {9.0, 6.0}, {k * 1e-17, 0.0}, {9.8, 6.0}, 0.0};
    const Model<double> model = model_for(start);
    WorldState<double> state = state_at(start, model);
    const Configuration<double>& at = state.configuration;
    const PerSide<double> goals{start.goals[left] * degree, at.palms[right].angle};
    const PerSide<double> turn{goals[left] - at.palms[left].angle, 0.0};
    const double drive =
        drive_rate(at.palms, at.contacts, model.offset, state.contact_vector, 0.0, turn);
    const Advance<double> done = moved(model, state, -drive / state.contact_vector.dx, goals);
    CHECK(done.reason == DropReason::none && done.fraction == 1.0);
    CHECK(std::abs(at.contacts[left]) < 1e-14 && std::abs(at.contacts[right]) < 1e-14);
    most = std::max(most, done.segments - 1);
  }
  CHECK(most == GeneralStep<double>::max_reversals);
}

}  // namespace

int main() {
  test_a_step_and_its_parts();
  test_a_contact_at_its_pivot();
}
