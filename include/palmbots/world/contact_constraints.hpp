// SPDX-License-Identifier: Apache-2.0
// Contact constraints: the position of the object while it rests on more contacts than its two
// contact vertices, or on other ones.
//
// The unknowns are the coordinates p of the contact vertices along their palms and their heights
// ("lift") above them. The loop (mechanics/loop_closure.hpp) relates them, and so does every
// contact: a closed contact has no gap, and a sticking one keeps its place. With as many equations
// as unknowns the object's position follows from the separation and the palm angles alone. The
// equations are solved to rounding by Newton's method with exact derivatives. Nothing is
// integrated, so nothing drifts.
//
// All equations are multiplied by w, so their unit is m². In a palm's frame, (inward, normal) is
// the vector from its own contact vertex to the other one. Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/base/small_linear.hpp"
#include "palmbots/mechanics/contact_detection.hpp"

namespace palmbots {

// A gap (times w) below this counts as closed while the world moves, because states are exact
// there.
template <class Real>
inline constexpr Real closed_tolerance = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-4);

// A contact that persists: a vertex of the outline on a palm's plate, or a palm's tip on an edge.
template <class Real>
struct ActiveContact {
  std::size_t side;
  bool tip;
  std::size_t feature;  // as in ContactPoint
  Real end;             // of a tip: its coordinate on the palm [m]
  bool sticks;
  Real at;  // place while it sticks: on the palm or on the edge, times w

  constexpr bool is(const ContactPoint<Real>& p) const {
    return p.support.side == side && p.feature == feature && p.palm_end == tip &&
           (!tip || p.place == end);
  }
};

// All contacts that persist. If there are none, the object rests on its two contact vertices alone,
// as in world/quasistatic_world.hpp.
template <class Real>
struct ContactConstraints {
  std::array<ActiveContact<Real>, max_supports> active{};
  std::size_t count = 0;
  std::size_t first =
      left;  // the palm that is computed first, so that the mirrored problem rounds alike
  Real alike = Real(0);  // w (p − p of the other), if nothing else decides which contact slides
  bool full = false;     // the gaps alone leave no freedom

  constexpr bool none() const { return count == 0; }
};

namespace detail {

// The equations of one state. The unknowns are a step of (p, lift) on the first palm and on the
// second.
template <class Real>
class Equations {
 public:
  using Row = typename EchelonForm<Real>::Row;
  struct Equation {
    Real value;
    Row by;
  };

  Equations(const Model<Real>& model, const Configuration<Real>& configuration, std::size_t first)
      : model_(model), configuration_(configuration), first_(first), width_(model.object.width) {
    const PalmAngle<Real>& own = configuration.palms[first];
    const PalmAngle<Real>& partner = configuration.palms[other(first)];
    // Sine and cosine of the sum of both angles, that is of the angle between the palms' planes.
    sin_ = own.sin * partner.cos + partner.sin * own.cos;
    cos_ = own.cos * partner.cos - own.sin * partner.sin;
    const ContactVector<Real> vertices =
        contact_vector(configuration, vertex_offset(model, configuration));
    for (const std::size_t side : {left, right}) {
      vectors_[side] = palm_frame_vector(vertices, side, configuration.palms[side]);
    }
  }

  Equation loop() const {
    const PalmFrameVector<Real> r = vectors_[first_];
    const Real square = r.inward * r.inward + r.normal * r.normal;
    return {Real(0.5) * (square - width_ * width_),
            sum(inward(first_), r.inward, normal(first_), r.normal)};
  }

  Equation gap(const ActiveContact<Real>& h) const {
    const Vertex<Real>& v = model_.outline.vertices[h.feature];
    const Real along = v.along[h.side];
    const PalmFrameVector<Real> r = vectors_[h.side];
    if (!h.tip) {
      Row by = sum(normal(h.side), along, inward(h.side), v.height);
      by[slot(h.side) + 1] += width_;
      return {(along * r.normal + v.height * r.inward) + configuration_.lift[h.side] * width_, by};
    }
    const OutlineEdge e = edge(h);
    const Tip t = tip(h);
    return {(e.along * width_ - t.along) * e.nx + (e.height * width_ - t.height) * e.ny,
            sum(t.along_by, -e.nx, t.height_by, -e.ny)};
  }

  // The place of the contact minus `h.at`: of a vertex on its palm, of a tip along its edge.
  Equation place(const ActiveContact<Real>& h) const {
    const Vertex<Real>& v = model_.outline.vertices[h.feature];
    const Real along = v.along[h.side];
    const PalmFrameVector<Real> r = vectors_[h.side];
    if (!h.tip) {
      Row by = sum(normal(h.side), v.height, inward(h.side), -along);
      by[slot(h.side)] += width_;
      const Real from = along * r.inward - v.height * r.normal;
      return {(width_ * configuration_.contacts[h.side] - from) - h.at, by};
    }
    const OutlineEdge e = edge(h);
    const Tip t = tip(h);
    return {(t.along * e.ny - t.height * e.nx) - h.at, sum(t.along_by, e.ny, t.height_by, -e.nx)};
  }

  // Both vertices move by the same amount along their palms.
  Equation alike(Real at) const {
    const auto& p = configuration_.contacts;
    return {width_ * (p[first_] - p[other(first_)]) - at, {width_, Real(0), -width_, Real(0)}};
  }

  std::size_t slot(std::size_t side) const { return side == first_ ? 0 : 2; }

 private:
  // The position of a tip in the object's frame, from the contact vertex, times w.
  struct Tip {
    Real along;
    Real height;
    Row along_by;
    Row height_by;
  };
  // A point of an edge, and its unit normal into the object.
  struct OutlineEdge {
    Real along;
    Real height;
    Real nx;
    Real ny;
  };

  Row inward(std::size_t side) const {
    Row by{};
    by[slot(side)] = Real(1);
    by[slot(other(side))] = cos_;
    by[slot(other(side)) + 1] = -sin_;
    return by;
  }
  Row normal(std::size_t side) const {
    Row by{};
    by[slot(side) + 1] = Real(-1);
    by[slot(other(side))] = sin_;
    by[slot(other(side)) + 1] = cos_;
    return by;
  }
  static Row sum(const Row& a, Real k, const Row& b, Real l) {
    Row s{};
    for (std::size_t c = 0; c < 4; ++c) s[c] = k * a[c] + l * b[c];
    return s;
  }

  OutlineEdge edge(const ActiveContact<Real>& h) const {
    const auto& outline = model_.outline;
    const Vertex<Real>& a = outline.vertices[h.feature];
    const Vertex<Real>& b = outline.vertices[h.feature + 1 == outline.count ? 0 : h.feature + 1];
    const Real x = mirrored(h.side, a.height - b.height);
    const Real y = mirrored(h.side, b.along[h.side] - a.along[h.side]);
    const Real length = std::sqrt(x * x + y * y);
    // In the mirror the edge's other end comes first.
    const Vertex<Real>& from = h.side == left ? a : b;
    return {from.along[h.side], from.height, x / length, y / length};
  }

  Tip tip(const ActiveContact<Real>& h) const {
    const PalmFrameVector<Real> r = vectors_[h.side];
    const Real in = configuration_.contacts[h.side] - h.end;
    const Real below = configuration_.lift[h.side];
    Tip t{in * r.inward - below * r.normal, Real(0) - in * r.normal - below * r.inward,
          sum(inward(h.side), in, normal(h.side), -below),
          sum(normal(h.side), -in, inward(h.side), -below)};
    const std::size_t own = slot(h.side);
    t.along_by[own] += r.inward;
    t.along_by[own + 1] -= r.normal;
    t.height_by[own] -= r.normal;
    t.height_by[own + 1] -= r.inward;
    return t;
  }

  const Model<Real>& model_;
  const Configuration<Real>& configuration_;
  std::size_t first_;
  Real width_;
  Real sin_ = Real(0);
  Real cos_ = Real(1);
  PerSide<PalmFrameVector<Real>> vectors_{};
};

// True if the contact is that of the palm's own contact vertex.
template <class Real>
constexpr bool is_own(const Model<Real>& model, const ActiveContact<Real>& h) {
  return !h.tip && h.feature == model.outline.contact[h.side];
}

// The equations of the constraints. Those of the gaps come first.
template <class Real>
EchelonForm<Real> echelon(const Model<Real>& model, const ContactConstraints<Real>& constraints,
                          const Configuration<Real>& configuration, bool gaps_only) {
  const Equations<Real> equations(model, configuration, constraints.first);
  EchelonForm<Real> system{};
  const auto add = [&](const typename Equations<Real>::Equation& e) { system.add(e.by, e.value); };
  const auto each = [&](bool own, auto&& done) {
    for (std::size_t i = 0; i < constraints.count; ++i) {
      if (is_own(model, constraints.active[i]) == own) done(constraints.active[i]);
    }
  };
  const auto close = [&](const ActiveContact<Real>& h) { add(equations.gap(h)); };
  const auto stick = [&](const ActiveContact<Real>& h) {
    if (h.sticks) add(equations.place(h));
  };
  each(true, close);
  add(equations.loop());
  each(false, close);
  if (gaps_only) return system;
  each(true, stick);
  each(false, stick);
  if (!system.full()) add(equations.alike(constraints.alike));
  return system;
}

}  // namespace detail

// Stores the places of the contacts, and whether the gaps alone leave no freedom.
template <class Real>
void remember(const Model<Real>& model, const Configuration<Real>& configuration,
              ContactConstraints<Real>& constraints) {
  const detail::Equations<Real> equations(model, configuration, constraints.first);
  for (std::size_t i = 0; i < constraints.count; ++i) {
    constraints.active[i].at = Real(0);
    constraints.active[i].at = equations.place(constraints.active[i]).value;
  }
  constraints.alike = equations.alike(Real(0)).value;
  constraints.full = detail::echelon(model, constraints, configuration, true).full();
}

// Moves the object to where the constraints hold it. Returns false if that is not near its present
// position.
template <class Real>
bool settle(const Model<Real>& model, const ContactConstraints<Real>& constraints,
            Configuration<Real>& configuration) {
  const Real width = model.object.width;
  const Configuration<Real> before = configuration;
  const std::size_t first = constraints.first;
  constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
  Real last = width;
  for (int i = 0; i < 40; ++i) {
    const auto step = detail::echelon(model, constraints, configuration, false).solution();
    const Real most = EchelonForm<Real>::largest(step);
    if (!(most < width)) return false;
    configuration.contacts[first] -= step[0];
    configuration.lift[first] -= step[1];
    configuration.contacts[other(first)] -= step[2];
    configuration.lift[other(first)] -= step[3];
    // The last steps are rounding and do not become smaller.
    if (most <= epsilon * width ||
        (most < contact_tolerance<Real> * width && most >= Real(0.5) * last)) {
      break;
    }
    last = most;
    if (i == 39) return false;
  }
  for (std::size_t i = 0; i < constraints.count; ++i) {
    const ActiveContact<Real>& h = constraints.active[i];
    if (!detail::is_own(model, h)) continue;
    configuration.lift[h.side] = Real(0);
    // A sticking contact keeps every bit of its coordinate.
    const Real moved = configuration.contacts[h.side] - before.contacts[h.side];
    const Real slack = Real(64) * epsilon * width;
    if (h.sticks && moved < slack && moved > -slack) {
      configuration.contacts[h.side] = before.contacts[h.side];
    }
  }
  return true;
}

// The coordinate at which a palm is touched, outward from the foot of its pivot [m]: that of its
// contact vertex if this is on the palm.
template <class Real>
Real felt(const Model<Real>& model, const ContactConstraints<Real>& constraints,
          const Configuration<Real>& configuration, std::size_t side) {
  for (std::size_t i = 0; i < constraints.count; ++i) {
    ActiveContact<Real> h = constraints.active[i];
    if (h.side != side) continue;
    if (h.tip) return h.end;
    h.at = Real(0);
    return detail::Equations<Real>(model, configuration, constraints.first).place(h).value /
           model.object.width;
  }
  return configuration.contacts[side];
}

}  // namespace palmbots
