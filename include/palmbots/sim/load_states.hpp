// SPDX-License-Identifier: Apache-2.0
// The heaviest object that two robots hold in given states: balance, servos and wheels.
//
// Each robot is a rigid body on two wheels and a caster without friction, in the plane of travel. The
// object presses on its palm with the forces of mechanics/equilibrium.hpp: a share of the weight, and
// any squeeze that friction allows. All forces of the object grow with its mass, so each condition is
// linear in the mass, and the heaviest object of a state has a closed form. An acceleration of the
// robots counts as a slope, as everywhere in the mechanics. Slopes, angles and squeezes are taken at
// their ends. Source: docs/theory/stability.md.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/chassis.hpp"
#include "palmbots/sim/plate_section.hpp"

namespace palmbots {

enum class LoadKind : std::uint8_t { tipping, servo, traction, drive };
inline constexpr std::size_t load_kinds = 4;

// The heaviest object that a limit allows [kg], infinite: any; with the robot at which the limit
// binds, and the state: contacts [m] and palm angles [rad].
struct HeaviestLoad {
  double mass = std::numeric_limits<double>::infinity();
  std::size_t side = left;
  PerSide<double> p{};
  PerSide<double> theta{};
};
using HeaviestLoads = std::array<HeaviestLoad, load_kinds>;

// The mass of one wheel, a part of that of the body [kg].
inline double wheel_mass(double body_kg) { return smaller(0.05, 0.1 * body_kg); }

// What carries the object, besides the palms of the spec.
struct RobotBody {
  double body_kg = 0;
  double arm_kg = 0;
  double palm_kg = 0;
  double wheel_radius = 0;    // [m]
  double floor_friction = 0;  // of the wheels
  double palm_torque = 0;     // of the servos [N m]
  PerSide<double> force{};    // of each robot along the floor, at most; infinite: any [N]
  Chassis at{};
};

// Of a robot's keys [N].
inline double force_limit_of(const SceneValues& scene, std::size_t side) {
  constexpr double any = std::numeric_limits<double>::infinity();
  const auto limit = [](double force) { return force == force ? force : any; };
  return smaller(limit(scene.of<"robot.motor_force_n">(own(side))),
                 limit(scene.of<"robot.traction_n">(own(side))));
}

// `height`: of the pivots over the floor [m].
inline RobotBody robot_body_of(const SceneValues& scene, double height, bool is_curved) {
  return {scene.of<"mujoco.body_kg">(),
          scene.of<"mujoco.arm_kg">(),
          scene.of<"mujoco.palm_kg">(),
          scene.of<"mujoco.wheel_radius_m">(),
          scene.of<"mujoco.floor_friction">(),
          scene.of<"mujoco.palm_torque_n_m">(),
          {force_limit_of(scene, left), force_limit_of(scene, right)},
          chassis_of(height, axle_of(scene, is_curved))};
}
// While the pair carries.
inline RobotBody robot_body_of(const SceneValues& scene, const Spec& spec, bool is_curved) {
  return robot_body_of(scene, -floor_level(spec), is_curved);
}

namespace detail {

// A force or a load: of the robot itself [N], and for each newton of the object's weight.
struct Load {
  double own;
  double by_load;
};

// One robot in one state.
struct RobotState {
  const RobotBody& body;
  const PalmSpec& palm;
  SinCos<double> turn;
  Vec arm;      // from the pivot to the contact, outward and up [m]
  double tilt;  // sideways specific force, outward

  double plate_middle() const { return palm.offset - plate_thickness(palm) / 2; }

  // Load of the wheels, load of the caster, and force of the wheels along the floor, where the object
  // presses `force` on the palm: outward and down.
  std::array<Load, 3> supports(Vec force) const {
    const Chassis& at = body.at;
    const double base = at.axle - at.caster;
    double weight = 0;
    double moment = 0;  // about the caster, outward side down
    const auto add = [&](double mass, double x, double z) {
      weight += mass * standard_gravity;
      moment += mass * standard_gravity * ((x - at.caster) + tilt * z);
    };
    const double wheels = 2 * wheel_mass(body.body_kg);
    add(body.body_kg - wheels, at.com.x, at.com.y);
    add(wheels, at.axle, body.wheel_radius);
    add(body.arm_kg, 0.5 * (at.shoulder.x + at.pivot.x), 0.5 * (at.shoulder.y + at.pivot.y));
    add(body.palm_kg, at.pivot.x - plate_middle() * turn.sin,
        at.pivot.y + plate_middle() * turn.cos);
    const double lever = at.pivot.x + arm.x - at.caster;
    const Load axle{moment / base, (lever * force.y + (at.pivot.y + arm.y) * force.x) / base};
    return {axle, {weight - axle.own, force.y - axle.by_load}, {-tilt * weight, -force.x}};
  }

  // Moment on the servo, outward side up.
  Load servo(Vec force) const {
    const double lever = -plate_middle() * turn.sin + plate_middle() * turn.cos * tilt;
    return {-body.palm_kg * standard_gravity * lever, -(arm.x * force.y + arm.y * force.x)};
  }
};

inline RobotState robot_state(const RobotBody& body, const Spec& spec, std::size_t side, double p,
                              const PalmAngle<double>& angle, double slope) {
  const PalmSpec& palm = spec.palms[side];
  const SinCos<double> turn{angle.sin, angle.cos};
  return {body,
          palm,
          turn,
          {p * turn.cos - palm.offset * turn.sin, p * turn.sin + palm.offset * turn.cos},
          mirrored(side, slope)};
}

}  // namespace detail

// How hard a robot's palm can push inward with the contact at p [m] while it carries the vertical
// force V [N]: at both of its angles at least own + by_load V, where the wheels do not slip. The push
// itself presses the wheels down.
inline detail::Load push_of(const RobotBody& body, const Spec& spec, std::size_t side, double p) {
  constexpr double any = std::numeric_limits<double>::infinity();
  detail::Load least{any, any};
  for (const double theta : {spec.palms[side].shallow, spec.palms[side].steep}) {
    const detail::RobotState robot =
        detail::robot_state(body, spec, side, p, PalmAngle<double>::at(theta), spec.slope);
    const auto at_rest = robot.supports({0, 0});
    const double room = 1 - body.floor_friction * robot.supports({1, 0})[0].by_load;
    if (!(room > 0)) return {any, 0};
    least.own = smaller(least.own,
                        (body.floor_friction * at_rest[0].own - std::abs(at_rest[2].own)) / room);
    least.by_load =
        smaller(least.by_load, body.floor_friction * robot.supports({0, 1})[0].by_load / room);
  }
  return least;
}

// States at the ends of angles, slopes and squeezes in which friction holds the object. The contacts
// are on a grid, which is refined around the state in which each limit binds: the heaviest object is a
// piecewise smooth function of both contacts, and its least value may be between the grid's points,
// at a kink where another palm ends the squeeze.
class LoadStates {
 public:
  LoadStates(const RobotBody& body, const Spec& spec)
      : body_(body), spec_(spec), model_(model_of<double>(spec)) {}

  // Contacts up to `reach` from the pivots, and whatever the robots do.
  HeaviestLoads within(double reach) {
    constexpr int coarse = 9;
    constexpr int fine = 5;
    constexpr int halvings = 12;  // to 6e-5 of the reach
    PerSide<std::vector<double>> places;
    PerSide<double> ends{};
    double fastest = 0;
    for (const std::size_t side : {left, right}) {
      ends[side] = smaller(reach, spec_.palms[side].reach());
      for (int k = 0; k < coarse; ++k) places[side].push_back(ends[side] * (0.25 * k - 1));
      fastest = larger(fastest, spec_.robots[side].acceleration);
    }
    const double acceleration = spec_.inertia ? fastest : 0;
    best_ = {};
    add(places, acceleration);
    for (std::size_t kind = 0; kind < load_kinds; ++kind) {
      if (!std::isfinite(best_[kind].mass)) continue;
      double step = 0.25;
      for (int halving = 0; halving < halvings; ++halving) {
        step *= 0.5;
        for (const std::size_t side : {left, right}) {
          places[side].clear();
          for (int k = 0; k < fine; ++k) {
            const double p = best_[kind].p[side] + (k - fine / 2) * step * ends[side];
            if (std::abs(p) <= ends[side]) places[side].push_back(p);
          }
        }
        add(places, acceleration);
      }
    }
    return best_;
  }

  // At rest, with the contacts where the carry starts.
  HeaviestLoads at_start() {
    best_ = {};
    add({std::vector{spec_.start[left]}, std::vector{spec_.start[right]}}, 0);
    return best_;
  }

 private:
  // Looks at contacts of both palms, with this acceleration of the robots [m/s²].
  [[gnu::noinline]] void add(const PerSide<std::vector<double>>& places, double acceleration) {
    for (const double p_left : places[left]) {
      for (const double p_right : places[right]) {
        for (const double l : {spec_.palms[left].shallow, spec_.palms[left].steep}) {
          for (const double r : {spec_.palms[right].shallow, spec_.palms[right].steep}) {
            for (const double sense : {-1.0, 1.0}) {
              look({p_left, p_right}, {l, r},
                   spec_.slope + sense * acceleration / standard_gravity);
              if (acceleration == 0) break;
            }
          }
        }
      }
    }
  }

  void look(const PerSide<double>& p, const PerSide<double>& theta, double slope) {
    const PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(theta[left]),
                                           PalmAngle<double>::at(theta[right])};
    Configuration<double> at{0, palms, p};
    at.separation = closing_separation(at, model_.offset, model_.object.width);
    ObjectParams<double> object = model_.object;
    object.slope = slope;
    const ContactVector<double> across = contact_vector(at, model_.offset);
    constexpr double level = 1e-9;
    if (is_pipe(object) && !palmbots::within(across.dy, level))
      return;  // it does not touch both there
    const ActingObject<double> acting =
        acting_object(object, contact_radii(model_.outline), palms, across);
    const ContactVector<double> v = acting.contact_vector;
    if (!std::isfinite(v.dx)) return;
    const auto moments = Moments<double>::of(acting.object);
    constexpr double any = std::numeric_limits<double>::infinity();
    Interval<double> held{-any, any};
    for (const std::size_t side : {left, right}) {
      const PalmAngle<double>& palm = palms[side];
      const auto cone = friction_cone<double>({palm.sin, palm.cos}, model_.friction[side]);
      held = intersect(held, squeezes(moments, side, cone, v.dx, v.dy).all);
    }
    if (held.empty()) return;
    // Wheels that lose their load slip, and end a pull inward: the least squeeze remains.
    const double calm = smaller(larger(0.0, held.low), held.high);
    for (const double end : {held.low, held.high}) {
      if (!std::isfinite(end)) continue;  // a wedged contact has no end: the wheels slip first
      for (const std::size_t side : {left, right}) {
        const double rise = mirrored(side, v.dy);
        const double arm = moments.arm(side, v.dx, rise) / moments.width;
        const double push = mirrored(side, slope);
        const auto force = [&](double h) { return Vec{h + 0.5 * push, (arm + h * rise) / v.dx}; };
        const detail::RobotState robot =
            detail::robot_state(body_, spec_, side, p[side], palms[side], slope);
        const auto limit = [&](LoadKind kind, double own, double by_load) {
          if (!(by_load < 0)) return;
          const double mass = larger(own, 0.0) / -by_load / standard_gravity;
          HeaviestLoad& most = best_[static_cast<std::size_t>(kind)];
          if (mass < most.mass) most = {mass, side, p, theta};
        };
        const auto [wheels, caster, along] = robot.supports(force(end));
        const detail::Load relieved = robot.supports(force(calm))[0];
        const detail::Load servo = robot.servo(force(end));
        limit(LoadKind::tipping, relieved.own, relieved.by_load);
        limit(LoadKind::tipping, caster.own, caster.by_load);
        for (const double sign : {1.0, -1.0}) {
          limit(LoadKind::servo, body_.palm_torque - sign * servo.own, -sign * servo.by_load);
          limit(LoadKind::traction, body_.floor_friction * wheels.own - sign * along.own,
                body_.floor_friction * wheels.by_load - sign * along.by_load);
          if (std::isfinite(body_.force[side]))
            limit(LoadKind::drive, body_.force[side] - sign * along.own, -sign * along.by_load);
        }
      }
    }
  }

  RobotBody body_;
  const Spec& spec_;
  Model<double> model_;
  HeaviestLoads best_;
};

}  // namespace palmbots
