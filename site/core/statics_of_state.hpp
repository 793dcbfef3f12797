// SPDX-License-Identifier: Apache-2.0
// The mechanics of one state, and maps over many: contact modes, squeezes, friction cones, and the
// COMs for which the properties hold (paper, Figures 3 to 6).
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/mechanics/sliding.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/placement.hpp"
#include "palmbots/stability/operating_envelope.hpp"

namespace palmbots::page {

// What the mode of a motion is called in the arrays: the index of the mode, or one of these.
inline constexpr double not_held = -1;
inline constexpr double jammed = -2;

// A state: palm angles [rad] and contact coordinates [m].
struct PalmState {
  PerSide<double> theta;
  PerSide<double> p;
};

namespace detail {

inline double index_of(const SelectedMode& found) {
  if (!found.balanced) return not_held;
  if (found.jammed) return jammed;
  const auto place = [](SlipDirection slide) {
    for (std::size_t i = 0; i < slip_directions.size(); ++i) {
      if (slip_directions[i] == slide) return i;
    }
    return std::size_t{0};
  };
  return double(3 * place(found.mode[left]) + place(found.mode[right]));
}

}  // namespace detail

// The mechanics of a scene's object at any state.
class StaticsOfState {
 public:
  explicit StaticsOfState(const Spec& spec) : spec_(spec), model_(model_of<double>(spec)) {}

  // The pose in which the loop is closed, with the pair at the origin.
  PairPose pose(const PalmState& state) const {
    PairPose pose{};
    for (const std::size_t side : {left, right}) {
      pose.configuration.palms[side] = PalmAngle<double>::at(state.theta[side]);
      pose.configuration.contacts[side] = state.p[side];
    }
    pose.configuration.separation =
        closing_separation(pose.configuration, model_.offset, model_.object.width);
    const ContactVector<double> v = contact_vector(pose.configuration, model_.offset);
    const double sine = v.dy / model_.object.width;
    pose.turn = {std::sqrt((1 - sine) * (1 + sine)), sine};
    return pose;
  }

  Contacts<double> contacts(const PairPose& at) const {
    const ActingObject<double> acting = acting_at(at.configuration);
    const ContactVector<double>& v = acting.contact_vector;
    return {Moments<double>::of(acting.object), cones_at(model_.friction, at.configuration.palms),
            v.dx, v.dy};
  }

  // Why the object is not held. With rounded contact vertices the palms count as infinitely long.
  DropReason reason(const Configuration<double>& at) const {
    const ContactVector<double> v = contact_vector(at, model_.offset);
    if (!is_rounded()) return drop_reason(model_, at.palms, at.contacts, v);
    for (const std::size_t side : {left, right}) {
      if (!model_.clear[side].contains(palm_frame_vector(v, side, at.palms[side])))
        return DropReason::flush;
    }
    constexpr double inf = std::numeric_limits<double>::infinity();
    const ActingObject<double> acting = acting_at(at);
    Model<double> model = model_;
    model.object = acting.object;
    model.moments = Moments<double>::of(acting.object);
    model.clear = {ClearCone<double>{-inf, inf}, ClearCone<double>{-inf, inf}};
    return drop_reason(model, at.palms, at.contacts, acting.contact_vector);
  }

  // Appends: reaches (0 or 1), drop reason, squeezes I_L and I_R (low, high each), nine times whether
  // a contact mode balances, closing and opening mode, friction margin [rad], wedged up edges (left,
  // right), angle of the object [rad], separation; per side the edges up and down as directions of
  // the force on the object, and the heights at which the line of gravity meets them; then the places.
  [[clang::minsize]]
  void append(const PalmState& state, std::vector<double>& out) const {
    const PairPose at = pose(state);
    const bool reaches = at.configuration.separation == at.configuration.separation;
    const Contacts<double> here = contacts(at);
    const ContactVector<double> v{here.dx, here.dy};
    out.push_back(reaches ? 1 : 0);
    out.push_back(double(reason(at.configuration)));
    const PerSide<Squeezes<double>> of = squeezes(here);
    PerSide<bool> is_wedged{};
    for (const std::size_t side : {left, right}) {
      const Interval<double>& all = of[side].all;
      out.insert(out.end(), {all.low, all.high});
      is_wedged[side] = wedged(side, here.cones[side].up, v.dx, v.dy);
    }
    for (const bool balances : balanced_modes(of)) out.push_back(balances ? 1 : 0);
    out.push_back(detail::index_of(selected_mode(of, SlipDirection::up)));
    out.push_back(detail::index_of(selected_mode(of, SlipDirection::down)));
    const PerSide<PalmAngle<double>>& palms = at.configuration.palms;
    out.push_back(friction_margin<double>(
        here.moments,
        {SinCos<double>{palms[left].sin, palms[left].cos},
         SinCos<double>{palms[right].sin, palms[right].cos}},
        {std::atan(model_.friction[left]), std::atan(model_.friction[right])}, v.dx, v.dy));
    out.insert(out.end(), {is_wedged[left] ? 1.0 : 0.0, is_wedged[right] ? 1.0 : 0.0,
                           std::asin(at.turn.y), at.configuration.separation});
    std::vector<double> places;
    append_places(spec_, at, places);
    append_cones(here, places, out);
    out.insert(out.end(), places.begin(), places.end());
  }

  // One number for each of n × n pairs of contact coordinates up to `reach` times as far out as the
  // palms are long, p_R outermost: the mode that closing (or opening) selects.
  void append_contact_mode_map(const PerSide<double>& theta, bool closing, std::size_t n,
                               double reach, std::vector<double>& out) const {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        const PalmState state{theta, {place(left, i, n, reach), place(right, j, n, reach)}};
        const PairPose at = pose(state);
        if (!(at.configuration.separation == at.configuration.separation)) {
          out.push_back(not_held);
          continue;
        }
        out.push_back(detail::index_of(selected_mode(
            squeezes(contacts(at)), closing ? SlipDirection::up : SlipDirection::down)));
      }
    }
  }

  // For nx × ny COMs in a box of the object frame [m]: bit 0 property 1, bit 1 property 2, each for
  // all contacts of the palms and with either palm as the shallow one.
  void append_com_map(const PerSide<AnglePair<double>>& angles, Interval<double> x,
                      Interval<double> y, std::size_t nx, std::size_t ny,
                      std::vector<double>& out) const {
    std::vector<std::array<ComInterval<double>, 4>> bands;
    for (const int number : {1, 2}) {
      std::array<ComInterval<double>, 4> band{};
      std::size_t k = 0;
      for (const std::size_t shallow : {left, right}) {
        PerSide<PalmAngle<double>> palms{angles[left].steep, angles[right].steep};
        palms[shallow] = angles[shallow].shallow;
        const Interval<double> rise =
            rise_over(region_of(number, shallow, whole_palms(), 0.0), palms, model_.offset);
        for (const double dy : {rise.low, rise.high}) {
          band[k++] =
              com_interval(properties[number], shallow, palms, friction(), model_.object.width,
                           model_.object.slope, contact_vector_at(dy, model_.object.width),
                           contact_radii(model_.outline));
        }
      }
      bands.push_back(band);
    }
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const double cx = x.low + (x.high - x.low) * (double(i) + 0.5) / double(nx);
        const double cy = y.low + (y.high - y.low) * (double(j) + 0.5) / double(ny);
        int bits = 0;
        for (int number = 0; number < 2; ++number) {
          bool holds = true;
          for (const ComInterval<double>& band : bands[static_cast<std::size_t>(number)]) {
            holds = holds && band.slack(cx, cy) >= 0;
          }
          bits |= holds ? 1 << number : 0;
        }
        out.push_back(bits);
      }
    }
  }

  // For property 1 and 2 and either palm shallow (left first): whether the COM is permitted, the
  // permitted c_x at the COM's height, and the constraint that binds at either end, at the worst
  // contacts of the region.
  void append_limits(const PerSide<AnglePair<double>>& angles, const Region<double>& contacts,
                     std::vector<double>& out) const {
    for (const int number : {1, 2}) {
      for (const std::size_t shallow : {left, right}) {
        PerSide<PalmAngle<double>> palms{angles[left].steep, angles[right].steep};
        palms[shallow] = angles[shallow].shallow;
        const Interval<double> rise =
            rise_over(region_of(number, shallow, contacts, 0.0), palms, model_.offset);
        Interval<double> permitted{-std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::infinity()};
        double low_by = 0;
        double high_by = 0;
        for (const double dy : {rise.low, rise.high}) {
          const ComInterval<double> band =
              com_interval(properties[number], shallow, palms, friction(), model_.object.width,
                           model_.object.slope, contact_vector_at(dy, model_.object.width),
                           contact_radii(model_.outline));
          const Interval<double> ends = band.com_x(model_.object.com_height);
          if (ends.low > permitted.low) {
            permitted.low = ends.low;
            low_by = double(band.low_by);
          }
          if (ends.high < permitted.high) {
            permitted.high = ends.high;
            high_by = double(band.high_by);
          }
        }
        const double x = model_.object.com_left;
        out.insert(out.end(), {permitted.low <= x && x <= permitted.high ? 1.0 : 0.0, permitted.low,
                               permitted.high, low_by, high_by});
      }
    }
  }

  OperatingEnvelope<double> envelope(const Region<double>& contacts) const {
    return envelope_of(model_, contacts);
  }

  Region<double> whole_palms() const {
    return {Interval<double>{-model_.reach[left], model_.reach[left]},
            Interval<double>{-model_.reach[right], model_.reach[right]}};
  }

  const Model<double>& model() const { return model_; }

 private:
  bool is_rounded() const {
    const PerSide<double> radius = contact_radii(model_.outline);
    return radius[left] > 0 || radius[right] > 0;
  }
  ActingObject<double> acting_at(const Configuration<double>& at) const {
    return acting_object(model_.object, contact_radii(model_.outline), at.palms,
                         contact_vector(at, model_.offset));
  }

  Friction<double> friction() const {
    const auto just = [](double x) { return Interval<double>{x, x}; };
    return {{just(model_.friction[left]), just(model_.friction[right])}, false};
  }

  double place(std::size_t side, std::size_t i, std::size_t n, double reach) const {
    const double half = reach * model_.reach[side];
    return -half + 2 * half * (double(i) + 0.5) / double(n);
  }

  void append_cones(const Contacts<double>& here, const std::vector<double>& places,
                    std::vector<double>& out) const {
    constexpr std::size_t contact_at =
        12;  // of the places: after pivots and both ends of the palms
    constexpr std::size_t com_at = 16;
    const double slope = model_.object.slope;
    for (const std::size_t side : {left, right}) {
      const double inward = -outward<double>(side);
      const double x = places[contact_at + 2 * side];
      const double y = places[contact_at + 2 * side + 1];
      for (const ConeEdge<double>& edge : {here.cones[side].up, here.cones[side].down}) {
        const double fx = inward * edge.lateral;
        const double fy = edge.vertical;
        // Where this edge meets the line of gravity, which leans with the slope: x = c_x + s (y −
        // c_y).
        const double across = fx - slope * fy;
        const double gap = places[com_at] + slope * (y - places[com_at + 1]) - x;
        out.insert(out.end(), {fx, fy, y + fy * gap / across});
      }
    }
  }

  Spec spec_;
  Model<double> model_;
};

}  // namespace palmbots::page
