// SPDX-License-Identifier: Apache-2.0
// COM bounds, envelopes and what follows from them, against squeezes that are computed anew from
// the balance of forces, against scans, and against closed forms.
#include "palmbots/stability/operating_envelope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include "palmbots/sim/build.hpp"
#include "palmbots/stability/safe_reach.hpp"
#include "palmbots/stability/tolerance.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

constexpr double degree = radians_per_degree<double>;

double between(std::mt19937& chance, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(chance);
}
bool near(double a, double b, double by = 1e-9) { return std::abs(a - b) < by; }

PerSide<PalmAngle<double>> palms_at(double l, double r) {
  return {PalmAngle<double>::at(l), PalmAngle<double>::at(r)};
}
AnglePair<double> pair_of(double shallow, double steep) {
  return {PalmAngle<double>::at(shallow), PalmAngle<double>::at(steep)};
}

// The horizontal force with which the robots squeeze the object, half the difference of theirs, at
// which a contact slips on the edge of its cone. In units of the weight; the COM is at (x, y) from
// the left contact along and across the line of contacts.
double squeeze_at(std::size_t side, SlipDirection slide, const PerSide<PalmAngle<double>>& palms,
                  double friction, ContactVector<double> v, double width, double slope, double x,
                  double y) {
  // Arms of the weight (0, −1) and of the sideways force (−s, 0) about the other contact.
  const double along_x = v.dx / width;
  const double along_y = v.dy / width;
  const double com_x = x * along_x - y * along_y;
  const double com_y = x * along_y + y * along_x;
  const double sense = side == left ? 1.0 : -1.0;  // inward
  const double lean =
      palms[side].angle + (slide == SlipDirection::up ? 1 : -1) * std::atan(friction);
  // The contact's force is N (sense sin lean, cos lean), of which the other contact bears the rest.
  const double fx = sense * std::sin(lean);
  const double fy = std::cos(lean);
  const double arm_x = side == left ? -v.dx : v.dx;
  const double arm_y = side == left ? -v.dy : v.dy;
  const double rx = side == left ? com_x - v.dx : com_x;
  const double ry = side == left ? com_y - v.dy : com_y;
  // Moments about the other contact: N (arm × f) + (r × weight) = 0.
  const double weight = rx * -1.0 - ry * -slope;
  const double size = -weight / (arm_x * fy - arm_y * fx);
  return side == left ? size * fx - 0.5 * slope : -size * fx + 0.5 * slope;
}

// A comparison of a property, from the squeezes: ≥ 0 if it holds.
double surplus(const Comparison& need, std::size_t shallow, const PerSide<PalmAngle<double>>& palms,
               const PerSide<double>& friction, ContactVector<double> v, double width, double slope,
               double x, double y) {
  const double a =
      squeeze_at(shallow, need.shallow, palms, friction[shallow], v, width, slope, x, y);
  const std::size_t steep = other(shallow);
  const double b = squeeze_at(steep, need.steep, palms, friction[steep], v, width, slope, x, y);
  return need.shallow_first ? b - a : a - b;
}

void test_bounds_of_the_com() {
  std::mt19937 chance(3);
  int compared = 0;
  for (int k = 0; k < 400; ++k) {
    const double width = between(chance, 0.1, 0.4);
    const double slope = k % 3 == 0 ? 0.0 : between(chance, -0.1, 0.1);
    const double y = between(chance, 0.0, 0.05);
    const std::size_t shallow = k % 2 == 0 ? left : right;
    PerSide<PalmAngle<double>> palms = palms_at(15 * degree, 15 * degree);
    palms[shallow] = PalmAngle<double>::at(between(chance, 3 * degree, 10 * degree));
    const ContactVector<double> v = contact_vector_at(between(chance, -0.02, 0.02), width);
    CHECK(near(v.dx * v.dx + v.dy * v.dy, width * width));
    const PerSide<double> mu{between(chance, 0.1, 0.5), between(chance, 0.1, 0.5)};
    const Friction<double> friction{{{{mu[left], mu[left]}, {mu[right], mu[right]}}}, false};
    for (const Property& property : properties) {
      const ComInterval<double> found =
          com_interval(property, shallow, palms, friction, width, slope, v);
      CHECK(near(found.x * found.x + found.y * found.y, 1.0));
      if (!(found.low < found.high)) continue;
      for (const double x : {found.com_x(y).low, found.com_x(y).high}) {
        const bool is_low = x == found.com_x(y).low;
        const BindingConstraint by = is_low ? found.low_by : found.high_by;
        double least = 1.0;
        for (const int i : {0, 1}) {
          const double here = surplus(property.needs[i], shallow, palms, mu, v, width, slope, x, y);
          least = std::min(least, here);
          const bool binds = by == (i == 0 ? BindingConstraint::first : BindingConstraint::second);
          if (binds) CHECK(near(here, 0.0, 1e-7));
          compared += binds ? 1 : 0;
        }
        CHECK(least > -1e-7);
        CHECK(near(found.slack(x, y), 0.0));
      }
    }
  }
  CHECK(compared > 200);
  // Of two constraints that bind at one place, the first one is named.
  const Property twice{{properties[1].needs[0], properties[1].needs[0]}, false, false};
  const Friction<double> some{{{{0.3, 0.3}, {0.3, 0.3}}}, false};
  for (const std::size_t shallow : {left, right}) {
    PerSide<PalmAngle<double>> palms = palms_at(15 * degree, 15 * degree);
    palms[shallow] = PalmAngle<double>::at(5 * degree);
    const auto found =
        com_interval(twice, shallow, palms, some, 0.25, 0.0, contact_vector_at(0.0, 0.25));
    CHECK(found.low_by != BindingConstraint::second && found.high_by != BindingConstraint::second);
    CHECK(found.low_by == BindingConstraint::first || found.high_by == BindingConstraint::first);
  }
}

int wedged_edges(const PerSide<PalmAngle<double>>& palms, double mu, ContactVector<double> v) {
  int count = 0;
  for (const std::size_t side : {left, right})
    for (const SlipDirection slide : {SlipDirection::up, SlipDirection::down})
      count += wedged(side, edge_of(palms[side], slide, mu), v.dx, v.dy) ? 1 : 0;
  return count;
}

// A common friction that is not known exactly permits what each of its values permits.
void test_common_friction() {
  std::mt19937 chance(4);
  int inside = 0;  // cases in which neither end of the range is the worst
  for (int k = 0; k < 2000; ++k) {
    const double slope = between(chance, -1.0, 1.0);
    const std::size_t shallow = k % 2 == 0 ? left : right;
    const PerSide<PalmAngle<double>> palms = palms_at(between(chance, -40 * degree, 80 * degree),
                                                      between(chance, -40 * degree, 80 * degree));
    const ContactVector<double> v = contact_vector_at(between(chance, -0.24, 0.24), 0.25);
    const Interval<double> range{between(chance, 0.01, 1.0), between(chance, 1.0, 5.0)};
    const Friction<double> common{{{range, range}}, true};
    for (const Property& property : properties) {
      const ComInterval<double> found =
          com_interval(property, shallow, palms, common, 0.25, slope, v);
      double low = 0.0;
      double high = 1.0;
      double at_ends = 0.0;
      const auto take = [&](double mu, bool is_end) {
        const Friction<double> one{{{{mu, mu}, {mu, mu}}}, false};
        const auto part = com_interval(property, shallow, palms, one, 0.25, slope, v);
        low = std::max(low, part.low);
        high = std::min(high, part.high);
        if (is_end) at_ends = std::max(at_ends, part.low);
      };
      const auto at = [&](int i) { return range.low + (range.high - range.low) * i / 400; };
      for (int i = 0; i <= 400; ++i) {
        take(at(i), i == 0 || i == 400);
        // Both sides of where another number of edges is wedged.
        double before = at(i);
        double after = i < 400 ? at(i + 1) : before;
        const int count = wedged_edges(palms, before, v);
        if (count == wedged_edges(palms, after, v)) continue;
        for (int halving = 0; halving < 60; ++halving) {
          const double middle = 0.5 * (before + after);
          (count == wedged_edges(palms, middle, v) ? before : after) = middle;
        }
        take(before, false);
        take(after, false);
      }
      if (!(low < high)) continue;
      CHECK(near(found.low, low, 1e-5) && near(found.high, high, 1e-5));
      inside += low > at_ends + 1e-4 ? 1 : 0;
    }
  }
  CHECK(inside > 5);
}

// How far the right contact may lie above the left one.
void test_rises() {
  const PerSide<PalmAngle<double>> palms = palms_at(10 * degree, 20 * degree);
  const Region<double> contacts{{{-0.01, 0.03}, {-0.02, 0.05}}};
  const PerSide<double> offset{0.02, -0.03};
  const Interval<double> found = rise_over(contacts, palms, offset);
  const auto height = [&](std::size_t side, double p) {
    return offset[side] * std::cos(palms[side].angle) + p * std::sin(palms[side].angle);
  };
  CHECK(near(found.low, height(right, -0.02) - height(left, 0.03)));
  CHECK(near(found.high, height(right, 0.05) - height(left, -0.01)));
}

OperatingEnvelope<double> paper_envelope(const Model<double>& model) {
  const Interval<double> contacts{-0.07, 0.07};
  const Interval<double> mu{0.29, 0.31};
  return {model.object.width, model.offset,           {0.04, 0.04}, {{{mu, mu}}, false},
          {0.0, 0.0},         {{contacts, contacts}}, 0.005,        model.clear};
}

void test_mirror_images() {
  const Model<double> model = model_of<double>(paper_spec());
  const OperatingEnvelope<double> same = paper_envelope(model);
  const PerSide<AnglePair<double>> angles{pair_of(5 * degree, 15 * degree),
                                          pair_of(5 * degree, 15 * degree)};
  CHECK(detail::symmetric(same, angles));
  OperatingEnvelope<double> other_one = same;
  other_one.slope.low = -0.01;
  CHECK(!detail::symmetric(other_one, angles));
  other_one = same;
  other_one.slope.high = 0.01;
  CHECK(!detail::symmetric(other_one, angles));
  other_one = same;
  other_one.offset[left] = 0.01;
  CHECK(!detail::symmetric(other_one, angles));
  other_one = same;
  other_one.slope = {1.0, 1.0};
  CHECK(!detail::symmetric(other_one, angles));

  // Palms that do not turn hold the object where both contacts stick.
  OperatingEnvelope<double> fixed = same;
  fixed.contacts = {{{0.0, 0.0}, {0.0, 0.0}}};
  const PerSide<AnglePair<double>> still{pair_of(9 * degree, 9 * degree),
                                         pair_of(9 * degree, 9 * degree)};
  const Interval<double> held = com_x_held(fixed, still);
  const auto sticks =
      com_interval(properties[0], left, palms_at(9 * degree, 9 * degree), fixed.friction,
                   fixed.width, 0.0, contact_vector_at(0.0, fixed.width));
  CHECK(near(held.low, sticks.com_x(0.04).low) && near(held.high, sticks.com_x(0.04).high));

  const Interval<double> all{1.0, 2.0};
  CHECK(detail::contains(all, {1.0, 2.0}) && detail::contains(all, {1.2, 1.8}));
  CHECK(!detail::contains(all, {0.9, 1.8}) && !detail::contains(all, {1.2, 2.1}));
}

// With palms that do not turn, and contacts at the pivots, the object is level. The palm's line is
// at the palm's angle from it.
void test_clearance() {
  const Model<double> model = model_of<double>(paper_spec());
  OperatingEnvelope<double> envelope = paper_envelope(model);
  envelope.contacts = {{{0.0, 0.0}, {0.0, 0.0}}};
  for (const double angle : {4 * degree, 12 * degree}) {
    const PerSide<AnglePair<double>> angles{pair_of(angle, angle), pair_of(angle, angle)};
    PerSide<double> seen{};
    for (const std::size_t side : {left, right}) {
      const auto r = palm_frame_vector(ContactVector<double>{envelope.width, 0.0}, side,
                                       PalmAngle<double>::at(angle));
      seen[side] = std::atan2(r.normal, r.inward);
    }
    for (const double below : {0.1, 0.3}) {
      for (const double above : {0.2, 0.05}) {
        for (const std::size_t tighter : {left, right}) {
          for (const std::size_t side : {left, right}) {
            const double more = side == tighter ? 0.0 : 0.02;
            envelope.clear[side].low = std::tan(seen[side] - below - more);
            envelope.clear[side].high = std::tan(seen[side] + above + more);
          }
          CHECK(near(clearance_margin(envelope, angles), std::min(below, above)));
        }
      }
    }
  }
}

void test_safe_reach() {
  const Spec spec = paper_spec();
  const PerSide<AnglePair<double>> angles{pair_of(5 * degree, 15 * degree),
                                          pair_of(5 * degree, 15 * degree)};
  Model<double> model = model_of<double>(spec);
  const double whole = safe_reach(model, angles);
  CHECK(whole > 0.0 && whole <= 0.99 * model.reach[left]);
  CHECK(safe_reach(model, {pair_of(-5 * degree, 15 * degree), angles[right]}) == -1);
  CHECK(safe_reach(model, {pair_of(15 * degree, 15 * degree), angles[right]}) == -1);

  // Different frictions count each on its own palm: in the mirror it is the same.
  bool matters = false;
  for (int i = 1; i <= 20; ++i) {
    const auto reach_with = [&](double l, double r) {
      Model<double> mixed = model;
      mixed.friction = {l, r};
      return safe_reach(mixed, angles);
    };
    const double mu = 0.02 * i;
    CHECK(reach_with(mu, 0.6) == reach_with(0.6, mu));
    matters = matters || reach_with(mu, mu) != reach_with(0.6, 0.6);
  }
  CHECK(matters);

  // The ends of the permitted interval belong to it.
  const double extent = 0.5 * whole;
  const Interval<double> both{-extent, extent};
  const auto just = [](double x) { return Interval<double>{x, x}; };
  const OperatingEnvelope<double> envelope{
      model.object.width,
      model.offset,
      just(model.object.com_height),
      {{{just(model.friction[left]), just(model.friction[right])}}, false},
      just(0.0),
      {{both, both}},
      0.0,
      model.clear};
  const Interval<double> permitted = com_x_held_surely(envelope, angles);
  const double inside = 1e-6;
  for (const double x : {permitted.low, permitted.high, permitted.low + inside,
                         permitted.low - inside, permitted.high + inside}) {
    Model<double> moved = model;
    moved.object.com_left = x;
    moved.object.com_right = model.object.width - x;
    const bool expected = permitted.low <= x && x <= permitted.high;
    CHECK(detail::held_within(moved, angles, extent) == expected);
  }

  // The smallest extent that is tried is a sixteenth of the palm.
  double good = 0.0;
  double bad = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (good + bad);
    (detail::held_within(model, angles, middle) ? good : bad) = middle;
  }
  CHECK(good > 0.0 && bad < 1.0);
  model.reach = {good * 16 / 1.5, good * 16 / 1.5};
  CHECK(near(safe_reach(model, angles), 0.99 * model.reach[left] / 16));
}

void test_tolerances() {
  const Model<double> model = model_of<double>(paper_spec());
  const OperatingEnvelope<double> envelope = paper_envelope(model);
  const PerSide<AnglePair<double>> angles{pair_of(5 * degree, 15 * degree),
                                          pair_of(5 * degree, 15 * degree)};
  const Interval<double> permitted =
      com_x_all(envelope, angles, {0.5 * model.object.width, 0.5 * model.object.width});
  CHECK(permitted.low < permitted.high);
  const double length = permitted.high - permitted.low;
  const Interval<double> low{permitted.low + 0.1 * length, permitted.low + 0.2 * length};
  const Interval<double> high{permitted.high - 0.3 * length, permitted.high - 0.2 * length};
  CHECK(near(tolerance(envelope, low, Quantity::com, 1.0, angles), 0.1 * length));
  CHECK(near(tolerance(envelope, high, Quantity::com, 1.0, angles), 0.2 * length));

  const Interval<double> com{0.5 * model.object.width, 0.5 * model.object.width};
  const auto holds = [&](Quantity quantity, double by) {
    OperatingEnvelope<double> wider = envelope;
    if (quantity == Quantity::friction) {
      for (Interval<double>& mu : wider.friction.palms) mu = {mu.low - by, mu.high + by};
    }
    if (quantity == Quantity::slope) wider.slope = {-by, by};
    if (quantity != Quantity::angle) {
      return detail::contains(com_x_all(wider, angles, com), com);
    }
    for (const double l : {-by, 0.0, by}) {
      for (const double r : {-by, 0.0, by}) {
        const PerSide<AnglePair<double>> wrong{pair_of(5 * degree + l, 15 * degree + l),
                                               pair_of(5 * degree + r, 15 * degree + r)};
        if (!detail::contains(com_x_all(wider, wrong, com), com)) return false;
        if (clearance_margin(wider, wrong) < 0.0) return false;
      }
    }
    return true;
  };
  for (const auto& [quantity, most] :
       {std::pair{Quantity::friction, 0.25}, std::pair{Quantity::slope, 0.2},
        std::pair{Quantity::angle, 4 * degree}}) {
    double good = 0.0;
    double bad = most;
    CHECK(holds(quantity, good) && !holds(quantity, bad));
    for (int i = 0; i < 40; ++i) {
      const double middle = good + 0.5 * (bad - good);
      (holds(quantity, middle) ? good : bad) = middle;
    }
    CHECK(near(tolerance(envelope, com, quantity, most, angles), good, 2e-7 * most));
  }
}

}  // namespace

int main() {
  test_bounds_of_the_com();
  test_common_friction();
  test_rises();
  test_mirror_images();
  test_clearance();
  test_safe_reach();
  test_tolerances();
}
