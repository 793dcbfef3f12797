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
    model.half_length = {Real(half), Real(half)};
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
  most_contacts<double>();
  most_contacts<float>();
}
