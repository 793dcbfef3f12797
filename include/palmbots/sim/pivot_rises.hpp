// SPDX-License-Identifier: Apache-2.0
// Which of properties 0, 1 and 2 hold while the pivots are at different heights.
//
// Near the floor they are, because each palm keeps its inner end on the floor: a palm at the angle θ
// has its pivot ℓ sin θ above the nose's lower edge. In the air two arms differ by their errors, and
// while they move.
//
// Palms exert the same forces wherever their pivots are. At given palm angles the properties depend on
// the contacts only through their height difference, to which that of the pivots is added. So the two
// extreme height differences decide, as with level pivots (stability/operating_envelope.hpp). A palm
// that turns is evaluated at nine angles, as there. Source: docs/theory/lifting.md.
#pragma once

#include <cstddef>
#include <vector>

#include "palmbots/sim/build.hpp"
#include "palmbots/sim/lift_team.hpp"
#include "palmbots/stability/operating_envelope.hpp"

namespace palmbots {

// Properties as bits.
inline constexpr unsigned all_properties = 0b111;
constexpr unsigned property_bit(int number) { return 1U << static_cast<unsigned>(number); }

// The largest rise up to which every rise is permitted; 0: none is [m].
template <class Permits>
double largest_rise(const Spec& spec, Permits&& permits) {
  if (!permits(0.0)) return 0.0;
  double low = 0.0, high = 0.5 * spec.width;
  constexpr int halvings = 20;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (permits(middle) ? low : high) = middle;
  }
  return low;
}

// The properties of a scene's palms for a rise of the right pivot over the left one.
class PivotRises {
 public:
  // `share`: of the usable palm, on whose inner part the contacts are.
  explicit PivotRises(const Spec& spec, double share = 1.0)
      : spec_(spec), model_(model_of<double>(spec)), envelope_(envelope_of(model_, {})) {
    for (const std::size_t side : {left, right}) {
      const double reach = share * spec.palms[side].reach();
      envelope_.contacts[side] = {-reach, reach};
    }
    find_poses();
  }

  // The properties that hold for all rises from `rise.low` to `rise.high`. With `on_floor` both noses
  // are on the floor, and these are added to the rise that the pivots have there. With `clear` the
  // object may touch the palms, as if they were infinitely long, at its contacts only.
  unsigned holding(Interval<double> rise, bool on_floor, bool clear) const {
    unsigned hold = all_properties;
    for (const Pose& pose : poses_) {
      const double base = on_floor ? pose.rise_on_floor : 0.0;
      const Interval<double> all{pose.contacts.low + base + rise.low,
                                 pose.contacts.high + base + rise.high};
      const Interval<double> com =
          detail::com_x_at(envelope_, properties[pose.property], pose.shallow, pose.palms, all);
      Clearance<double> clearance(envelope_);
      if (clear) clearance.look(pose.palms, all);
      const bool holds = com.low <= spec_.com_left && spec_.com_left <= com.high &&
                         (!clear || clearance.least() >= 0);
      if (!holds) hold &= ~property_bit(pose.property);
    }
    return hold;
  }

  // The largest rise with which these properties hold, as with all smaller ones of either sign; 0: they
  // do not hold without one.
  double permitted(unsigned wanted, bool on_floor, bool clear) const {
    const auto holds = [&](double size) {
      return (holding({-size, size}, on_floor, clear) & wanted) == wanted;
    };
    return largest_rise(spec_, holds);
  }

 private:
  struct Pose {
    int property;
    std::size_t shallow;
    PerSide<PalmAngle<double>> palms;
    Interval<double> contacts;  // their height differences with level pivots
    double rise_on_floor;       // of the pivots
  };

  void add(int property, std::size_t shallow, const PerSide<PalmAngle<double>>& palms, int region) {
    const Interval<double> rise =
        rise_over(region_of(region, shallow, envelope_.contacts, 0.0), palms, model_.offset);
    const auto pivot = [&](std::size_t side) {
      return spec_.palms[side].lowest_pivot({palms[side].sin, palms[side].cos});
    };
    poses_.push_back({property, shallow, palms, rise, pivot(right) - pivot(left)});
  }

  void find_poses() {
    const auto at = [&](double PalmSpec::* angle) {
      return PerSide<PalmAngle<double>>{PalmAngle<double>::at(spec_.palms[left].*angle),
                                        PalmAngle<double>::at(spec_.palms[right].*angle)};
    };
    const PerSide<PalmAngle<double>> shallow = at(&PalmSpec::shallow), steep = at(&PalmSpec::steep);
    add(0, left, shallow, 0);
    add(0, left, steep, 0);
    for (const std::size_t side : {left, right}) {
      const double from = shallow[side].angle, turn = steep[side].angle - from;
      for (int step = 0; step < detail::turn_steps; ++step) {
        PerSide<PalmAngle<double>> palms = steep;
        palms[side] = PalmAngle<double>::at(from + turn * step / detail::turn_steps);
        // Palms turn where property 1 or 2 applies, before it or after it.
        for (const int region : {1, 2}) {
          add(0, side, palms, region);
          if (step == 0) add(region, side, palms, region);
        }
      }
    }
  }

  Spec spec_;
  Model<double> model_;
  OperatingEnvelope<double> envelope_;
  std::vector<Pose> poses_;
};

// The rise up to which an object that has just been docked between steep palms touches them at its
// contact vertices only [m]. Beyond it, it may lie on a nose, and lift off its contact.
inline double rise_clear_of_noses(const Spec& spec) {
  const Model<double> model = model_of<double>(spec);
  OperatingEnvelope<double> envelope = envelope_of(model, {});
  PerSide<PalmAngle<double>> steep{};
  const double docked = tactile_of<double>(spec).stretch(0.0).from;
  for (const std::size_t side : {left, right}) {
    steep[side] = PalmAngle<double>::at(spec.palms[side].steep);
    envelope.contacts[side] = {docked, spec.palms[side].reach()};
  }
  const Interval<double> contacts = rise_over(envelope.contacts, steep, model.offset);
  return largest_rise(spec, [&](double size) {
    Clearance<double> clearance(envelope);
    clearance.look(steep, {contacts.low - size, contacts.high + size});
    return clearance.least() >= 0;
  });
}

// The largest height difference of two arms that move together: that of the pivots where they begin to
// rise, the errors of both, and what the faster one moves while the other one stands.
struct ArmsDiffer {
  double at_rest;  // [m]
  double late;     // for how long one arm may move alone [s]
  double moving;   // [m]

  // `level_only`: meanwhile both palms are steep.
  static ArmsDiffer of(const Spec& spec, bool level_only) {
    double at_rest = 0.0;
    const auto add = [&](double rise) { at_rest = larger(at_rest, rise < 0 ? -rise : rise); };
    if (spec.begins_on == StandsOn::floor || spec.ends_on == StandsOn::floor) {
      // Noses are level, and either palm may turn.
      const auto pivot = [&](std::size_t side, double PalmSpec::* angle) {
        return spec.palms[side].lowest_pivot(sin_cos(spec.palms[side].*angle));
      };
      const auto least = level_only ? &PalmSpec::steep : &PalmSpec::shallow;
      for (const auto one : {least, &PalmSpec::steep}) {
        for (const auto two : {least, &PalmSpec::steep}) add(pivot(right, one) - pivot(left, two));
      }
    }
    for (const bool ends : {false, true}) {
      if ((ends ? spec.ends_on : spec.begins_on) != StandsOn::stand) continue;
      const double top = standing_level(spec, ends ? spec.direction * spec.distance : 0.0);
      PerSide<double> low{}, touching{};
      for (const std::size_t side : {left, right}) {
        const StandHeights heights = StandHeights::of(spec, side, top);
        low[side] = heights.low;
        touching[side] = 0.5 * (heights.low + heights.clear) -
                         spec.start[side] * sin_cos(spec.palms[side].steep).sin;
      }
      add(low[right] - low[left]);
      add(touching[right] - touching[left]);
    }
    at_rest += spec.arms[left].height_error + spec.arms[right].height_error;
    const double late =
        table_times_of<Lifting>(spec).lease * spec.period + spec.longest_delay() + spec.period;
    const double rate = larger(spec.arms[left].rate, spec.arms[right].rate);
    return {at_rest, late, at_rest + rate * late};
  }
};

// The inner part of the usable palms on which contacts are that were centred before the arms move.
inline constexpr double centred_share = 0.5;

// Whether the contacts of a pair may be corrected at level pivots only: the properties do not hold with
// both noses on the floor, or while the arms move.
inline bool corrects_level_only(const Spec& spec) {
  if (!uses_floor(spec) || on_one_palm(spec)) return false;
  if (spec.begins_on == StandsOn::floor &&
      PivotRises(spec).holding({0.0, 0.0}, true, true) != all_properties) {
    return true;
  }
  const double most = ArmsDiffer::of(spec, false).moving;
  return PivotRises(spec, centred_share).holding({-most, most}, false, false) != all_properties;
}

}  // namespace palmbots
