// SPDX-License-Identifier: Apache-2.0
// The slip rule against its statement in docs/theory/mechanics.md. The squeezes that a contact
// carries are found here by brute force: a scan over squeezes H, and of each whether the contact's
// force leans by at most φ from the palm's normal. Angles and leans come from the library's atan2.
#include "palmbots/mechanics/slip_rule.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "palmbots/mechanics/sliding.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;

constexpr double inf = std::numeric_limits<double>::infinity();

// A state of object and palms. Lengths in m, angles in rad; `s` is the sideways force in weights.
struct Case {
  double width;
  double com_along;
  double com_height;
  double s;
  PerSide<double> angles;
  PerSide<double> friction;
  ContactVector<double> between;

  ObjectParams<double> object() const {
    return {width, com_along, width - com_along, com_height, s};
  }
  PerSide<PalmAngle<double>> palms() const {
    return {PalmAngle<double>::at(angles[left]), PalmAngle<double>::at(angles[right])};
  }
  Moments<double> moments() const { return moments_under(object(), 0.0); }
  PerSide<ConeEdge<double>> edges(double way) const { return edges_at(friction, palms(), way); }
  SlipOnset<double> onset(double way) const {
    return SlipOnset<double>::at(moments(), edges(way), between, way);
  }

  // The COM, from the left contact.
  std::array<double, 2> com() const {
    const double sin = between.dy / width;
    const double cos = between.dx / width;
    return {com_along * cos - com_height * sin, com_along * sin + com_height * cos};
  }
  // True if the object would tip over a contact.
  bool tips() const {
    const auto [x, y] = com();
    return between.dx - x + s * (y - between.dy) <= 0 || x - s * y <= 0;
  }

  // True if the force on this contact lies in its cone under the squeeze tan(u).
  bool carries(std::size_t side, double u) const {
    const double h = std::tan(u);
    const auto [x_left, y_left] = com();
    const double x_right = between.dx - x_left;
    const double y = y_left - 0.5 * between.dy;  // above the middle of the contacts
    const double up = side == left ? (x_right + h * between.dy + s * y) / between.dx
                                   : (x_left - h * between.dy - s * y) / between.dx;
    const double inward = side == left ? h + 0.5 * s : h - 0.5 * s;
    const double lean = std::atan2(inward, up);
    const double off = std::remainder(lean - angles[side], 2 * std::numbers::pi);
    return std::abs(off) <= std::atan(friction[side]);
  }

  // True if the edge of the cone is almost parallel to the line to the other contact.
  bool nearly_wedges(std::size_t side, double way) const {
    const double rise = (side == left ? between.dy : -between.dy) / between.dx;
    const double edge = angles[side] + way * std::atan(friction[side]);
    const double off = std::remainder(std::atan2(way, way * rise) - edge, 2 * std::numbers::pi);
    return std::abs(off) < 0.01;
  }

  // The squeezes that it carries, as angles u with H = tan u; infinite: unbounded.
  Interval<double> squeezes(std::size_t side) const {
    constexpr int samples = 1000;
    constexpr double far = 0.5 * std::numbers::pi;
    const auto u_of = [](int i) { return far * ((2.0 * i + 1) / samples - 1); };
    int first = 0;
    while (first < samples && !carries(side, u_of(first))) ++first;
    if (first == samples) return {1, -1};
    int last = first;
    while (last + 1 < samples && carries(side, u_of(last + 1))) ++last;
    const auto border = [&](double inside, double outside) {
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + outside);
        (carries(side, middle) ? inside : outside) = middle;
      }
      return inside;
    };
    return {first == 0 ? -inf : border(u_of(first), u_of(first - 1)),
            last == samples - 1 ? inf : border(u_of(last), u_of(last + 1))};
  }
};

Case random_case(std::mt19937& chance) {
  const auto number = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(chance);
  };
  Case c{};
  c.width = number(0.1, 0.4);
  c.com_along = c.width * number(0.2, 0.8);
  c.com_height = number(0.01, 0.15);
  c.s = number(-0.05, 0.05);
  const bool steep = number(0, 1) < 0.3;
  for (const std::size_t side : {left, right}) {
    c.angles[side] = steep ? number(0.3, 1.3) : number(0.0, 0.4);
    c.friction[side] = number(0, 1) < 0.2 ? number(1, 6) : number(0.05, 0.8);
  }
  const double tilt = number(-0.3, 0.3);
  c.between = {c.width * std::cos(tilt), c.width * std::sin(tilt)};
  return c;
}

struct Seen {
  int one = 0;
  int wedged = 0;
  int jammed = 0;
};

// Closing: the contact whose interval has the lower upper end. Opening: the one whose interval has
// the higher lower end.
void the_end_of_the_overlap_decides() {
  std::mt19937 chance(1);
  Seen seen;
  for (int again = 0; again < 6000; ++again) {
    const Case c = random_case(chance);
    if (c.tips()) continue;
    const PerSide<Interval<double>> carried{c.squeezes(left), c.squeezes(right)};
    if (carried[left].empty() || carried[right].empty()) continue;
    if (intersect(carried[left], carried[right]).empty()) continue;
    for (const double way : {1.0, -1.0}) {
      const SlipOnset<double> onset = c.onset(way);
      // Of the squeeze as it changes in this direction, as an angle.
      const auto end = [&](std::size_t side) {
        return way > 0 ? carried[side].high : -carried[side].low;
      };
      const double of_left = end(left);
      const double of_right = end(right);
      if (c.nearly_wedges(left, way) || c.nearly_wedges(right, way)) continue;
      if (std::abs(of_left - of_right) < 1e-9) continue;  // inf − inf is no number
      CHECK(onset.wedged[left] == (of_left == inf));
      CHECK(onset.wedged[right] == (of_right == inf));
      const SlidingContact slides = first_to_slip(onset, false);
      if (of_left == inf && of_right == inf) {
        CHECK(slides == SlidingContact::none);
        ++seen.jammed;
        continue;
      }
      CHECK(slides == (of_left < of_right ? SlidingContact::on_left : SlidingContact::on_right));
      if (of_left == inf || of_right == inf) {
        CHECK(onset.own_lead(true) == 0 && onset.own_lead(false) == 0);
        ++seen.wedged;
        continue;
      }
      CHECK((onset.own_lead(true) > 0) == (of_left < of_right));
      CHECK(onset.own_lead(false) == -onset.own_lead(true));
      CHECK(first_to_slip(onset, true) == SlidingContact::tie);
      ++seen.one;
    }
  }
  CHECK(seen.one > 3000 && seen.wedged > 100 && seen.jammed > 20);
}

// Along the tied slope both intervals end at the same squeeze.
void the_ends_are_equal_along_the_tied_slope() {
  std::mt19937 chance(2);
  int seen = 0;
  for (int again = 0; again < 4000; ++again) {
    Case c = random_case(chance);
    for (const double way : {1.0, -1.0}) {
      const auto edges = c.edges(way);
      const double slope =
          tied_slope(slip_order(c.moments(), edges[left], edges[right]), c.between);
      if (!(std::abs(slope) < 0.5)) continue;
      const double dx = c.width / std::sqrt(1 + slope * slope);
      c.between = {dx, slope * dx};
      if (c.tips() || c.nearly_wedges(left, way) || c.nearly_wedges(right, way)) continue;
      const Interval<double> l = c.squeezes(left);
      const Interval<double> r = c.squeezes(right);
      if (l.empty() || r.empty() || intersect(l, r).empty()) continue;
      const double of_left = way > 0 ? l.high : l.low;
      const double of_right = way > 0 ? r.high : r.low;
      if (std::abs(of_left) > 1.5 || std::abs(of_right) > 1.5) continue;
      CHECK(std::abs(of_left - of_right) < 1e-9);
      CHECK(std::abs(c.onset(way).left_lead) < 1e-12);
      ++seen;
    }
  }
  CHECK(seen > 500);
  const SlipOrder<double> everywhere{0, 0};
  CHECK(tied_slope(everywhere, {2.0, 0.5}) == 0.25);
}

// All four cases at a tie, and the mirrored ones.
void a_tie_goes_on_as_the_regions_say() {
  CHECK(slides_at_tie(false, false) == SlidingContact::both);
  CHECK(slides_at_tie(true, true) == SlidingContact::both);
  CHECK(slides_at_tie(true, false) == SlidingContact::on_left);
  CHECK(slides_at_tie(false, true) == SlidingContact::on_right);
}

// Properties 1 and 2 of the paper's scene: closing moves the contact on the shallow palm, opening
// the one on the steep palm.
void the_properties_of_the_paper() {
  constexpr double degree = std::numbers::pi / 180;
  for (const std::size_t shallow : {left, right}) {
    Case c{0.25, 0.125, 0.04, 0, {}, {0.3, 0.3}, {0.25, 0}};
    c.angles[shallow] = 5 * degree;
    c.angles[other(shallow)] = 15 * degree;
    const auto on = [](std::size_t side) {
      return side == left ? SlidingContact::on_left : SlidingContact::on_right;
    };
    CHECK(first_to_slip(c.onset(1), false) == on(shallow));
    CHECK(first_to_slip(c.onset(-1), false) == on(other(shallow)));
  }
}

// The moment of weight and sideways force about the other contact, and about one at mean height.
void the_moment_arms_are_those_of_the_com() {
  std::mt19937 chance(3);
  for (int again = 0; again < 1000; ++again) {
    const Case c = random_case(chance);
    const Moments<double> moments = c.moments();
    const auto [x, y] = c.com();
    const auto [dx, dy] = c.between;
    const PerSide<double> arms{dx - x + c.s * (y - dy), x - c.s * y};
    const PerSide<double> mean{dx - x + c.s * (y - 0.5 * dy), x - c.s * (y - 0.5 * dy)};
    for (const std::size_t side : {left, right}) {
      const double rise = side == left ? dy : -dy;
      CHECK(std::abs(moments.moment_arm(side, dx, rise) - c.width * arms[side]) < 1e-12);
      CHECK(std::abs(moments.arm(side, dx, rise) - c.width * mean[side]) < 1e-12);
    }
  }
}

void closing_slides_up() {
  CHECK(direction_of(-1e-300) == SlipDirection::up);
  CHECK(direction_of(1e-300) == SlipDirection::down);
  CHECK(direction_of(0.0) == SlipDirection::stick);
}

}  // namespace

int main() {
  the_end_of_the_overlap_decides();
  the_ends_are_equal_along_the_tied_slope();
  a_tie_goes_on_as_the_regions_say();
  the_properties_of_the_paper();
  the_moment_arms_are_those_of_the_com();
  closing_slides_up();
}
