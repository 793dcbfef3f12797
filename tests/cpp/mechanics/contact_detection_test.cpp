// SPDX-License-Identifier: Apache-2.0
// Contacts and outcomes over many states, in both precisions, and the most contacts there can be.
#include "palmbots/mechanics/contact_detection.hpp"

#include "palmbots/sim/carry.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"
#include "support/random_outline.hpp"

namespace {

using namespace palmbots;

struct Counted {
  std::size_t contacts = 0;
  std::size_t outcomes = 0;
  std::size_t sunk = 0;
};

// The paper's box at every pair of some angles and some coordinates; level palms make it lie flush.
template <class Real>
Counted over_many_states() {
  const Model<Real> model = model_of<Real>(paper_spec());
  Counted counted{};
  for (int a = -1; a <= 4; ++a) {
    for (int b = -1; b <= 4; ++b) {
      for (int p = -3; p <= 3; ++p) {
        const Configuration<Real> configuration{
            Real(0),
            {PalmAngle<Real>::at(Real(0.1) * Real(a)), PalmAngle<Real>::at(Real(0.1) * Real(b))},
            {Real(0.025) * Real(p), Real(0)}};
        const ContactSet<Real> found = detect_contacts(model, configuration);
        CHECK(found.count >= 2 && found.count <= 4);
        for (std::size_t i = 0; i < found.count; ++i) {
          const Support<Real>& s = found.points[i].support;
          CHECK(magnitude(std::hypot(s.nx, s.ny) - Real(1)) < Real(1e-6));
        }
        const Real near = contact_tolerance<Real> * model.object.width;
        if (found.sunk[left] > near || found.sunk[right] > near) {
          ++counted.sunk;
          continue;
        }
        Supports<Real> supports{};
        Velocities<Real> closing{};
        for (std::size_t i = 0; i < found.count; ++i) {
          const Support<Real>& s = found.points[i].support;
          supports.at[supports.count] = s;
          closing[supports.count++] = {-outward<Real>(s.side), Real(0)};
        }
        counted.contacts += supports.count;
        each_outcome(supports, closing, Real(0), [&](const Motions& motions) {
          ++counted.outcomes;
          bool slides = false;
          for (std::size_t i = 0; i < supports.count; ++i) slides |= motions[i] != Motion::stick;
          CHECK(slides);  // closing cannot leave all contacts where they are
        });
      }
    }
  }
  return counted;
}

// A palm that falls inward carries the box with its tip alone, and the contact vertex is above the
// palm. By Pythagoras, the tip meets the bottom as far from that vertex as the vertex is from the
// tip.
template <class Real>
void lifted_by_a_tip() {
  const Model<Real> model = model_of<Real>(paper_spec());
  const Real near = contact_tolerance<Real> * model.object.width;
  for (const std::size_t side : {left, right}) {
    for (int a = 1; a <= 3; ++a) {
      const PalmAngle<Real> falls = PalmAngle<Real>::at(Real(-0.1) * Real(a));
      const PalmAngle<Real> rises = PalmAngle<Real>::at(Real(0.25));
      Configuration<Real> at{Real(0),
                             {side == left ? falls : rises, side == left ? rises : falls},
                             {Real(0), Real(0)}};
      Real sunk = Real(0);
      Real above = Real(0.0625);
      for (int k = 0; k < 60; ++k) {
        at.lift[side] = Real(0.5) * (sunk + above);
        (detect_contacts(model, at).sunk[side] > Real(0) ? sunk : above) = at.lift[side];
      }
      at.lift[side] = above;
      CHECK(above > Real(0.001));
      const ContactSet<Real> found = detect_contacts(model, at);
      CHECK(found.count == 2 && found.sunk[side] <= near);
      const ContactPoint<Real>& tip = found.points[side];
      const Real half = model.half_length[side];
      CHECK(tip.kind == ContactKind::tip && tip.palm_end && tip.place == -half);
      CHECK(magnitude(tip.height) <= Real(2) * near);
      CHECK(magnitude(tip.along[side] - std::sqrt(half * half + above * above)) <= Real(2) * near);
      CHECK(magnitude(tip.along[left] + tip.along[right] - model.object.width) <= near);
      // 4 mm lower, the box turns about its other contact as well: the tip is less than 4 mm deep.
      at.lift[side] = above - Real(0.004);
      const Real deep = detect_contacts(model, at).sunk[side];
      CHECK(deep > Real(0.002) && deep < Real(0.004));
    }
  }
}

// How deep a palm lies in random outlines: no less than 0 where some of its points are inside by
// their winding number, and no more than the deepest of them.
template <class Real>
void sunk_against_winding_numbers() {
  std::mt19937 chance(3);
  int sunk_palms = 0;
  int clear_palms = 0;
  for (int again = 0; again < 500; ++again) {
    const outlines::Object object = outlines::random_object(chance);
    Model<Real> model = model_of<Real>(paper_spec());
    model.outline = outlines::outline_of<Real>(object);
    model.object.width = Real(object.width);
    const double half = outlines::between(chance, 0.03, 0.2);
    model.half_length = model.reach = {Real(half), Real(half)};
    PerSide<double> angles{};
    PerSide<double> contacts{};
    for (const std::size_t side : {left, right}) {
      angles[side] = outlines::between(chance, -0.2, 0.5);
      contacts[side] = outlines::between(chance, -half, half);
    }
    const double rise =
        contacts[right] * std::sin(angles[right]) - contacts[left] * std::sin(angles[left]);
    const double tilt = std::asin(rise / object.width);
    const ContactSet<Real> found = detect_contacts(
        model, {Real(0),
                {PalmAngle<Real>::at(Real(angles[left])), PalmAngle<Real>::at(Real(angles[right]))},
                {Real(contacts[left]), Real(contacts[right])}});
    for (const std::size_t side : {left, right}) {
      const double angle = angles[side] + (side == left ? tilt : -tilt);
      const outlines::Polygon seen = outlines::seen_from(object, side, angle);
      constexpr int points = 300;
      const double deep =
          outlines::deepest(seen, contacts[side] - half, contacts[side] + half, points);
      const double sunk = static_cast<double>(found.sunk[side]);
      const double near = static_cast<double>(contact_tolerance<Real>) * object.width;
      if (deep > 20 * near) CHECK(sunk > near);
      CHECK(sunk <= deep + half / points + near);
      CHECK(sunk >= 0.3 * (deep - 20 * near));
      ++(deep > 20 * near ? sunk_palms : clear_palms);
    }
  }
  CHECK(sunk_palms > 200 && clear_palms > 100);
}

// A box with corners at the top that are none, up to the most that an outline holds.
template <class Real>
Model<Real> box(double width, double half_length, std::size_t corners = 4) {
  Model<Real> model = model_of<Real>(paper_spec());
  outlines::Object object{{{0, 0}, {width, 0}}, 1, width};
  const auto top = static_cast<double>(corners - 3);
  for (double k = top; k >= 0; --k) object.corners.push_back({width * k / top, 0.125});
  model.outline = outlines::outline_of<Real>(object);
  model.object.width = Real(width);
  model.half_length = model.reach = {Real(half_length), Real(half_length)};
  return model;
}

// A box that lies on both level plates touches each with both ends of its bottom, wherever on the
// plates that is, and whatever its top is like.
template <class Real>
void flush_box_anywhere() {
  const PalmAngle<Real> level = PalmAngle<Real>::at(Real(0));
  for (const std::size_t corners : {std::size_t{4}, max_outline}) {
    const Model<Real> model = box<Real>(0.25, 0.5, corners);
    for (int at_left = -4; at_left <= 8; ++at_left) {
      const PerSide<Real> contacts{Real(at_left) / Real(16), Real(4 - at_left) / Real(16)};
      const ContactSet<Real> found =
          detect_contacts(model, Configuration<Real>{Real(0), {level, level}, contacts});
      CHECK(found.count == 4);
      for (std::size_t i = 0; i < 4; ++i) {
        const ContactPoint<Real>& point = found.points[i];
        CHECK(point.kind == ContactKind::flush && point.support.side == i / 2);
        CHECK(point.place == contacts[i / 2] - (i % 2 == 0 ? Real(0) : Real(0.25)));
      }
      CHECK(found.sunk[left] == Real(0) && found.sunk[right] == Real(0));
    }
  }
}

// An edge lies flush if all of its stretch on the plate is near. The box is lifted and turned by
// some tolerances, so that its bottom approaches or leaves the plate along the way.
template <class Real>
void flush_where_all_of_the_stretch_is_near() {
  std::mt19937 chance(4);
  int flush = 0;
  int not_flush = 0;
  constexpr double width = 0.25;
  const double near = static_cast<double>(contact_tolerance<Real>) * width;
  for (int again = 0; again < 4000; ++again) {
    const double half = outlines::between(chance, 0.05, 0.3);
    const Model<Real> model = box<Real>(width, half);
    const std::size_t side = chance() % 2;
    const double angle = outlines::between(chance, -6, 6) * near / width;
    const double place = outlines::between(chance, -half, half);
    const double lift = outlines::between(chance, 0, 3) * near;
    PerSide<PalmAngle<Real>> palms{PalmAngle<Real>::at(Real(0)), PalmAngle<Real>::at(Real(0))};
    palms[side] = PalmAngle<Real>::at(Real(angle));
    Configuration<Real> at{Real(0), palms, {Real(0), Real(0)}};
    at.contacts[side] = Real(place);
    at.lift[side] = Real(lift);
    const double height = place * std::sin(angle) + lift * std::cos(angle);
    const double from_palm = angle - std::asin(height / width);  // to the box's bottom
    const auto above = [&](double inward) { return lift + std::tan(from_palm) * inward; };
    const double first = above(std::clamp(place - half, 0.0, width));
    const double last = above(std::clamp(place + half, 0.0, width));
    const double farthest = std::max(std::abs(first), std::abs(last));
    if (std::abs(farthest - near) < 0.1 * near) continue;
    const ContactSet<Real> found = detect_contacts(model, at);
    bool found_flush = false;
    for (std::size_t i = 0; i < found.count; ++i) {
      const ContactPoint<Real>& point = found.points[i];
      found_flush |= point.support.side == side && point.kind == ContactKind::flush;
    }
    CHECK(found_flush == (farthest < near));
    ++(found_flush ? flush : not_flush);
  }
  CHECK(flush > 200 && not_flush > 200);
}

// A small tooth close to the contact vertex sinks into the plate as a large one does.
template <class Real>
void small_teeth_sink() {
  constexpr double width = 0.25;
  for (int k = 6; k <= 13; ++k) {
    const double size = std::ldexp(1.0, -k);
    outlines::Object object{{{0, 0},
                             {size, -size},
                             {2 * size, size},
                             {width - 2 * size, size},
                             {width - size, -size},
                             {width, 0},
                             {width, 0.125},
                             {0, 0.125}},
                            5,
                            width};
    Model<Real> model = box<Real>(width, 0.125);
    model.outline = outlines::outline_of<Real>(object);
    const PalmAngle<Real> level = PalmAngle<Real>::at(Real(0));
    const ContactSet<Real> found =
        detect_contacts(model, Configuration<Real>{Real(0), {level, level}, {Real(0), Real(0)}});
    const double deep = outlines::deepest(object.corners, 0, 2 * size, 1000);
    for (const std::size_t side : {left, right}) {
      const double sunk = static_cast<double>(found.sunk[side]);
      CHECK(sunk > 0.5 * deep && sunk < 1.01 * deep);
    }
  }
}

// Random half spaces meet if a point in all of them is known. They do not if shares of four of them
// add up to 0 · z > something that is not negative.
void half_spaces_against_witnesses() {
  std::mt19937 chance(5);
  const auto whole = [&](int most) {
    return double(static_cast<int>(chance() % static_cast<unsigned>(2 * most + 1)) - most);
  };
  const auto row = [&] {
    Triple<double> found{0, 0, 0};
    while (dot(found, found) == 0) found = {whole(3), whole(3), whole(3)};
    return found;
  };
  const TwistSpace<double> space{};
  for (int again = 0; again < 20000; ++again) {
    const Triple<double> witness{whole(2), whole(2), whole(2)};
    HalfSpaces<double> open;
    for (std::size_t i = 0; i < max_supports; ++i) {
      const Triple<double> g = row();
      CHECK(open.add(space, {g, dot(g, witness) - double(1 + chance() % 2)}));
    }
    CHECK(open.meet());
    HalfSpaces<double> closed;
    Triple<double> left_over{0, 0, 0};
    double value = -double(chance() % 2);
    for (int i = 0; i < 3; ++i) {
      const Triple<double> g = row();
      const double share = double(1 + chance() % 3);
      const double h = whole(2);
      CHECK(closed.add(space, {g, h}));
      left_over = left_over - g * share;
      value += share * h;
    }
    if (dot(left_over, left_over) == 0) continue;
    CHECK(closed.add(space, {left_over, -value}));
    CHECK(!closed.meet());
  }
}

// Between plates at rest the body can rest, and leave one of them, but not both.
template <class Real>
void plates_at_rest() {
  const Support<Real> at_left{left, Real(-0.125), Real(0), Real(1), Real(0), Real(0.5)};
  const Support<Real> at_right{right, Real(0.125), Real(0), Real(-1), Real(0), Real(0.5)};
  const Supports<Real> between{{at_left, at_right}, 2};
  const Twists<Real> twists(between, Velocities<Real>{});
  CHECK(twists.exist({Motion::stick, Motion::stick}, 2));
  CHECK(twists.exist({Motion::leave}, 1));
  CHECK(!twists.exist({Motion::leave, Motion::leave}, 2));
  CHECK(!twists.exist({Motion::stick, Motion::leave}, 2));
}

// Eight legs on level ground: closing makes those of either palm slide, and all those alike.
template <class Real>
void most_contacts() {
  Supports<Real> supports{};
  Velocities<Real> closing{};
  for (std::size_t i = 0; i < max_supports; ++i) {
    const std::size_t side = i % 2;
    const Real x = outward<Real>(side) * Real(0.03125) * Real(static_cast<int>(i / 2 + 1));
    supports.at[i] = {side, x, Real(-0.0625), Real(0), Real(1), Real(0.5)};
    closing[i] = {-outward<Real>(side), Real(0)};
  }
  supports.count = max_supports;
  CHECK(balances(supports, Motions{}, Real(0)));
  CHECK(!balances(supports, Motions{}, Real(0.75)));
  std::size_t outcomes = 0;
  each_outcome(supports, closing, Real(0), [&](const Motions& motions) {
    ++outcomes;
    for (std::size_t i = 2; i < max_supports; ++i) CHECK(motions[i] == motions[i % 2]);
  });
  CHECK(outcomes == 3);
}

}  // namespace

int main() {
  const Counted doubles = over_many_states<double>();
  const Counted floats = over_many_states<float>();
  CHECK(doubles.sunk > 0 && doubles.contacts > 200 && doubles.outcomes > 50);
  CHECK(doubles.sunk == floats.sunk && doubles.contacts == floats.contacts);
  lifted_by_a_tip<double>();
  lifted_by_a_tip<float>();
  sunk_against_winding_numbers<double>();
  sunk_against_winding_numbers<float>();
  flush_box_anywhere<double>();
  flush_box_anywhere<float>();
  flush_where_all_of_the_stretch_is_near<double>();
  small_teeth_sink<double>();
  half_spaces_against_witnesses();
  plates_at_rest<double>();
  plates_at_rest<float>();
  most_contacts<double>();
  most_contacts<float>();
}
