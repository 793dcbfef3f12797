// Everything that defines a carry, as plain numbers in SI units and radians: what a scene becomes.
//
// Trivially copyable, so that a spec can be handed on as bytes. Numbers are double here whatever the
// precision of the carry; whoever fills it in has validated it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/clearance.hpp"
#include "palmbots/tactile.hpp"

namespace palmbots {

struct PalmSpec {
  double length = 0.15;
  double offset = 0;  // of the surface from the pivot
  double friction = 0.3;
  double shallow = 0;
  double steep = 0;
  double rate = 0;  // [rad/s]
};

struct RobotSpec {
  double speed = 0.06;
  double correction = 0.03;
  double acceleration = 0.5;
  double max_speed = 0.2;
  double noise = 0.01;  // stationary standard deviation
  double noise_tau = 0.5;
  double bias = 0;
};

// A sudden shift of one contact, when the pair has come `at` far, or at time `at`.
struct BumpSpec {
  std::uint32_t side = 0;
  std::uint32_t by_time = 0;
  double at = 0;     // [m] or [s]
  double shift = 0;  // [m], outward
};

inline constexpr std::size_t max_bumps = 64;
inline constexpr double standard_gravity = 9.80665;  // [m/s²]

struct Spec {
  double width = 0;
  double com_left = 0;
  double com_right = 0;
  double com_height = 0;
  Outline<double> outline{};
  PalmSpec palms[2]{};
  RobotSpec robots[2]{};
  std::array<Zone<double>, max_zones> zones{};
  std::size_t zone_count = 0;
  double false_rate = 0;
  double period = 0.01;
  double latency = 0.05;
  double jitter = 0;
  double loss = 0;
  double distance = 1.5;
  double slope = 0;      // specific force towards −x
  double inertia = 1;    // 0: accelerations do not count, as the paper assumes
  double direction = 1;  // +1: the right robot leads, −1: the left one
  std::uint64_t timeout_ticks = 5000;
  double start[2]{};
  std::array<BumpSpec, max_bumps> bumps{};
  std::size_t bump_count = 0;
  double bump_rate = 0;    // random bumps per metre and robot
  double bump_max = 0;     // largest random shift
  double safe_reach = -1;  // see Fixture; whoever fills in a spec may leave it out
};

}  // namespace palmbots
