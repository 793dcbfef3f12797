// SPDX-License-Identifier: Apache-2.0
// Loop closure and the rate that decides about sliding, against positions computed from their
// definition: C = P + p u + o n.
#include <cmath>
#include <random>

#include "palmbots/mechanics/sliding.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;

struct State {
  double separation;
  PerSide<double> angles;
  PerSide<double> contacts;
  PerSide<double> offset;
};

struct Vector {
  double x;
  double y;
};

// From the left contact to the right one. The left palm's u points left and up, its n up and right.
Vector between_contacts(const State& s) {
  const auto contact = [&](std::size_t side) {
    const double outward_sense = side == left ? -1 : 1;
    const double sin = std::sin(s.angles[side]);
    const double cos = std::cos(s.angles[side]);
    const double pivot = outward_sense * 0.5 * s.separation;
    return Vector{pivot + outward_sense * (s.contacts[side] * cos - s.offset[side] * sin),
                  s.contacts[side] * sin + s.offset[side] * cos};
  };
  const Vector l = contact(left);
  const Vector r = contact(right);
  return {r.x - l.x, r.y - l.y};
}

double square(const State& s) {
  const Vector v = between_contacts(s);
  return v.x * v.x + v.y * v.y;
}

PerSide<PalmAngle<double>> palms_of(const State& s) {
  return {PalmAngle<double>::at(s.angles[left]), PalmAngle<double>::at(s.angles[right])};
}

Configuration<double> configuration_of(const State& s) {
  return {s.separation, palms_of(s), s.contacts};
}

State random_state(std::mt19937& chance) {
  const auto number = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(chance);
  };
  return {number(0.1, 0.5),
          {number(-0.6, 0.6), number(-0.6, 0.6)},
          {number(-0.08, 0.08), number(-0.08, 0.08)},
          {number(-0.02, 0.02), number(-0.02, 0.02)}};
}

// The rate is half the derivative of the squared distance of the contacts: by central differences.
void drive_rate_is_a_derivative() {
  std::mt19937 chance(1);
  std::uniform_real_distribution<double> rate(-1, 1);
  constexpr double h = 1e-5;
  for (int again = 0; again < 2000; ++again) {
    const State s = random_state(chance);
    const double change = rate(chance);
    const PerSide<double> turn{rate(chance), rate(chance)};
    const auto after = [&](double time) {
      State then = s;
      then.separation += change * time;
      for (const std::size_t side : {left, right}) then.angles[side] += turn[side] * time;
      return square(then);
    };
    const double wanted = (after(h) - after(-h)) / (4 * h);
    const Vector v = between_contacts(s);
    const ContactVector<double> found = contact_vector(configuration_of(s), s.offset);
    CHECK(std::abs(found.dx - v.x) < 1e-12 && std::abs(found.dy - v.y) < 1e-12);
    const double value = drive_rate(palms_of(s), s.contacts, s.offset, found, change, turn);
    CHECK(std::abs(value - wanted) < 1e-8);
  }
}

// One contact slides, or the robots move, until the contacts are as far apart as the object is wide.
void one_contact_slides_or_the_robots_move() {
  std::mt19937 chance(4);
  for (int again = 0; again < 2000; ++again) {
    const State s = random_state(chance);
    const double width = std::sqrt(square(s)) * 1.01;
    for (const std::size_t side : {left, right}) {
      const Slipped<double> found =
          slip<double>(side == left, s.separation, palms_of(s), s.contacts, s.offset, width);
      State slid = s;
      slid.contacts = found.contacts;
      const Vector v = between_contacts(slid);
      CHECK(std::abs(std::hypot(v.x, v.y) - width) < 1e-12);
      CHECK(std::abs(found.contact_vector.dx - v.x) < 1e-12);
      CHECK(std::abs(found.contact_vector.dy - v.y) < 1e-12);
    }
    State moved = s;
    moved.separation = closing_separation(configuration_of(s), s.offset, width);
    CHECK(std::abs(std::sqrt(square(moved)) - width) < 1e-12 && between_contacts(moved).x > 0);
  }
}

// Sliding both contacts closes the loop with the object in the wanted direction.
void both_contacts_slide() {
  std::mt19937 chance(2);
  for (int again = 0; again < 2000; ++again) {
    State s = random_state(chance);
    if (std::abs(std::sin(s.angles[left] + s.angles[right])) < 0.05) continue;
    const double width = std::sqrt(square(s)) * 1.01;
    const double slope = std::uniform_real_distribution<double>(-0.3, 0.3)(chance);
    s.contacts = solve_slide_along(configuration_of(s), slope, s.offset, width);
    const Vector v = between_contacts(s);
    CHECK(std::abs(v.y - slope * v.x) < 1e-10 && std::abs(std::hypot(v.x, v.y) - width) < 1e-10);
  }
}

// Between parallel palms each contact takes half of the change.
void parallel_palms_share_the_slide() {
  std::mt19937 chance(3);
  for (int again = 0; again < 2000; ++again) {
    State s = random_state(chance);
    s.angles[right] = -s.angles[left];
    const double width = std::sqrt(square(s)) * 1.01;
    const PerSide<double> before = s.contacts;
    s.contacts = solve_slide_along(configuration_of(s), 0.0, s.offset, width);
    const double moved = s.contacts[left] - before[left];
    CHECK(std::abs(s.contacts[right] - before[right] - moved) < 1e-15);
    CHECK(moved > 0 && std::abs(std::sqrt(square(s)) - width) < 1e-10);
  }
}

}  // namespace

int main() {
  drive_rate_is_a_derivative();
  one_contact_slides_or_the_robots_move();
  both_contacts_slide();
  parallel_palms_share_the_slide();
}
