// SPDX-License-Identifier: Apache-2.0
// Numbers of a scene that exceed what properties 1 and 2 allow: one sentence each, for the command
// line, Python and the page.
//
// Four quantities are compared with what the analysis allows: the mass of the object, the
// acceleration of the robots, the slope of the floor, and the angle through which a palm turns in one
// control period: a palm that is stopped one period late is off by that angle. The bounds on c_x are
// linear in the slope and monotone in the error of the angles, so bisection finds the limits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/load_limits.hpp"
#include "palmbots/stability/operating_envelope.hpp"

namespace palmbots {

// The contacts on the usable part of both palms.
inline Region<double> whole_palms(const Spec& spec) {
  const double l = spec.palms[left].reach();
  const double r = spec.palms[right].reach();
  return {Interval<double>{-l, l}, Interval<double>{-r, r}};
}

// Why the object cannot span a region; empty: it can.
inline std::string cannot_span(const Spec& spec, const Region<double>& contacts) {
  const Model<double> model = model_of<double>(spec);
  for (const bool is_left_shallow : {false, true}) {
    const PerSide<PalmAngle<double>> palms{
        PalmAngle<double>::at(is_left_shallow ? spec.palms[left].shallow : spec.palms[left].steep),
        PalmAngle<double>::at(spec.palms[right].steep)};
    const Interval<double> rise = rise_over(contacts, palms, model.offset);
    const double most = larger(-rise.low, rise.high);
    if (most < spec.width) continue;
    return sentence(
        "palm.length_m: contacts at opposite ends of the palms differ in height by {} m, more than "
        "the width of the object; allowed: less than {} m (shorter palms, shallower angles, or a "
        "smaller region)",
        {short_text(most, 3), short_text(spec.width)});
  }
  return "";
}

namespace detail {

// The properties of a scene over a region of contacts.
class ScenesProperties {
 public:
  ScenesProperties(const Spec& spec, const Region<double>& contacts)
      : envelope_(envelope_of(model_of<double>(spec), contacts)), x_(spec.com_left) {
    for (const std::size_t side : {left, right}) {
      angles_[side] = {PalmAngle<double>::at(spec.palms[side].shallow),
                       PalmAngle<double>::at(spec.palms[side].steep)};
    }
  }

  bool holds(int property) const {
    if (property == 0) return within(com_x_held(envelope_, angles_));
    return within(com_x_of(envelope_, property, left, angles_)) &&
           within(com_x_of(envelope_, property, right, angles_));
  }
  bool both_hold() const { return holds(1) && holds(2); }

  bool both_hold_at(double slope) const {
    ScenesProperties other = *this;
    other.envelope_.slope = {slope, slope};
    return other.both_hold();
  }
  // The slopes around one at which both properties hold.
  Interval<double> slopes_around(double slope) const {
    constexpr double steepest = 2;  // the tangent of 63°
    const auto end = [&](double far) {
      return limit(slope, far, [&](double s) { return both_hold_at(s); });
    };
    return {end(-steepest), end(steepest)};
  }

  bool both_hold_with(double error) const {
    for (const double l : {-error, 0.0, error}) {
      for (const double r : {-error, 0.0, error}) {
        ScenesProperties other = *this;
        other.turn(left, l);
        other.turn(right, r);
        if (!other.both_hold()) return false;
      }
    }
    return true;
  }
  // The largest error of the palm angles with which both properties hold [rad].
  double angle_error() const {
    return limit(0, pi<double> / 4, [&](double error) { return both_hold_with(error); });
  }

 private:
  bool within(Interval<double> permitted) const {
    return permitted.low <= x_ && x_ <= permitted.high;
  }
  void turn(std::size_t side, double by) {
    angles_[side] = {PalmAngle<double>::at(angles_[side].shallow.angle + by),
                     PalmAngle<double>::at(angles_[side].steep.angle + by)};
  }
  // The number farthest from `good` towards `far` at which a condition holds, which holds at `good`.
  template <class Holds>
  static double limit(double good, double far, Holds&& is_held) {
    if (is_held(far)) return far;
    for (int halvings = 0; halvings < 60; ++halvings) {
      const double middle = 0.5 * (good + far);
      (is_held(middle) ? good : far) = middle;
    }
    return good;
  }

  OperatingEnvelope<double> envelope_;
  PerSide<AnglePair<double>> angles_{};
  double x_;
};

}  // namespace detail

// All of a scene, with contacts in a region that the object can span.
inline std::vector<std::string> limit_warnings(const SceneValues& scene, const Spec& spec,
                                               const Region<double>& contacts, bool is_curved) {
  constexpr double degrees_per_radian = 1 / radians_per_degree<double>;
  std::vector<std::string> lines;
  const Region<double> whole = whole_palms(spec);
  const bool is_anywhere =
      contacts[left].low == whole[left].low && contacts[left].high == whole[left].high &&
      contacts[right].low == whole[right].low && contacts[right].high == whole[right].high;
  const std::string where = is_anywhere ? "for contacts anywhere on the palms"
                                        : sentence("for contacts from {} to {} mm",
                                                   {fixed_text(1e3 * contacts[left].low, 1),
                                                    fixed_text(1e3 * contacts[left].high, 1)});
  const detail::ScenesProperties found(spec, contacts);
  std::string failing;
  bool several = false;
  const auto add_failing = [&](int property) {
    if (found.holds(property)) return;
    several = !failing.empty();
    failing += (several ? " and property " : "property ") + std::to_string(property);
  };
  add_failing(0);
  const bool both = found.both_hold();
  const double degrees = scene.of<"task.slope_deg">();
  if (!both && degrees != 0 && found.both_hold_at(0)) {  // the slope is the reason
    const Interval<double> slopes = found.slopes_around(0);
    const double forward = spec.direction;  // uphill in travel is positive
    const double ends[] = {forward * slopes.low, forward * slopes.high};
    const bool turned = forward < 0;
    const auto text = [&](double slope) {
      return fixed_text(std::atan(slope) * degrees_per_radian, 2);
    };
    lines.push_back(
        sentence("task.slope_deg is {}, but properties 1 and 2 hold only from {} to {}° {}",
                 {short_text(degrees), text(ends[turned]), text(ends[!turned]), where}));
  } else {
    add_failing(1);
    add_failing(2);
  }
  if (both && spec.inertia) {
    const Interval<double> slopes = found.slopes_around(spec.slope);
    const double limit =
        standard_gravity * smaller(spec.slope - slopes.low, slopes.high - spec.slope);
    const double value = larger(spec.robots[left].acceleration, spec.robots[right].acceleration);
    if (value > limit) {
      lines.push_back(sentence(
          "robot.acceleration_m_s2 is {}, but properties 1 and 2 hold only up to {} m/s² {}",
          {short_text(value), short_text(std::floor(1e3 * limit) / 1e3), where}));
    }
  }
  if (!failing.empty()) {
    lines.push_back(sentence("{} {} {}; palmbots analyze reports what happens there",
                             {failing, several ? "fail" : "fails",
                              is_anywhere ? "for contacts somewhere on the palms" : where}));
  }
  double fastest = 0;
  for (const std::size_t side : {left, right}) {
    fastest = larger(fastest, scene.of<"palm.rate_deg_s">(own(side)));
  }
  const double step = scene.of<"control.period_s">() * fastest;
  if (both && !found.both_hold_with(step / degrees_per_radian)) {
    lines.push_back(sentence(
        "palm.rate_deg_s turns a palm by {}° in one control period, but properties 1 and 2 allow "
        "an "
        "angle error of only ±{}° {}",
        {short_text(step, 2), short_text(found.angle_error() * degrees_per_radian, 2), where}));
  }
  if (const std::string heavy = load_warning(scene, spec, is_curved); !heavy.empty()) {
    lines.push_back(heavy);
  }
  return lines;
}

// The same with contacts anywhere on the palms. None where planar mechanics do not apply: the nose of
// a palm can touch a part of the object below the contact vertices; and none of a pipe, whose
// contacts move together.
inline std::vector<std::string> limit_warnings(const SceneValues& scene, const Spec& spec) {
  if (is_pipe(spec)) return {};
  for (const std::size_t side : {left, right}) {
    for (std::size_t i = 0; i < spec.outline.count; ++i) {
      if (spec.palms[side].nose > 0 && spec.outline.vertices[i].height < 0) return {};
    }
  }
  const Region<double> contacts = whole_palms(spec);
  if (const std::string problem = cannot_span(spec, contacts); !problem.empty()) {
    return {"properties 1 and 2 cannot hold on the whole palms: " + problem};
  }
  return limit_warnings(scene, spec, contacts, false);
}

}  // namespace palmbots
