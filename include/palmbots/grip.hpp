// Where the object is while it rests on more, or on something else, than its two contact vertices.
//
// Unknown are the coordinates p of the contact vertices along their palms and their heights ("lift")
// above them; the loop (stance.hpp) relates them, and so does every contact: what touches has no gap,
// what sticks keeps its place. With as many equations as unknowns the object's place follows from the
// separation and the palm angles alone. The equations are solved to rounding by Newton's method with
// exact derivatives; nothing is integrated, so nothing drifts.
//
// All equations are in m², that is times w. Seen from a palm, (inward, normal) is the vector from its
// own contact vertex to the other one. Source: MECHANICS sections 1, 5, 6.
#pragma once

#include "palmbots/touching.hpp"

namespace palmbots {

// What is nearer than this, times w, touches while the world moves: states are exact there.
template <class Real>
inline constexpr Real closed_tolerance = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-4);

// A contact that stays: a vertex of the outline on a palm's plate, or a palm's tip on an edge.
template <class Real>
struct Hold {
  std::size_t side;
  bool tip;
  std::size_t feature;  // as in TouchPoint
  Real end;             // of a tip: its coordinate on the palm [m]
  bool sticks;
  Real at;  // where it is, for as long as it sticks: on the palm, or on the edge; times w

  constexpr bool is(const TouchPoint<Real>& p) const {
    return p.support.side == side && p.feature == feature && p.palm_end == tip &&
           (!tip || p.place == end);
  }
};

// All contacts that stay. None: the two contact vertices and nothing else, as in world.hpp.
template <class Real>
struct Grip {
  std::array<Hold<Real>, max_supports> holds{};
  std::size_t count = 0;
  std::size_t first =
      left;              // the palm that is computed first, so that a mirrored grip rounds alike
  Real alike = Real(0);  // w (p − p of the other), if nothing else says which contact gives way
  bool full = false;     // the gaps alone leave no freedom

  constexpr bool none() const { return count == 0; }
};

namespace detail {

// Equations for a step of (p, lift) on the first palm and on the second, in echelon form. One that
// depends on those before it is left out.
template <class Real>
class Echelon {
 public:
  using Row = std::array<Real, 4>;

  constexpr bool add(Row row, Real value) {
    const Real scale = largest(row);
    for (std::size_t k = 0; k < count_; ++k) {
      const Real factor = row[pivots_[k]] / rows_[k][pivots_[k]];
      for (std::size_t c = 0; c < 4; ++c) row[c] -= factor * rows_[k][c];
      row[pivots_[k]] = Real(0);
      value -= factor * values_[k];
    }
    if (count_ == 4 || !(largest(row) > dependent * scale)) return false;
    std::size_t pivot = 0;
    for (std::size_t c = 1; c < 4; ++c)
      pivot = magnitude(row[c]) > magnitude(row[pivot]) ? c : pivot;
    rows_[count_] = row;
    values_[count_] = value;
    pivots_[count_++] = pivot;
    return true;
  }
  constexpr bool full() const { return count_ == 4; }

  constexpr Row solution() const {
    Row x{};
    for (std::size_t k = count_; k-- > 0;) {
      Real rest = values_[k];
      for (std::size_t c = 0; c < 4; ++c) {
        if (c != pivots_[k]) rest -= rows_[k][c] * x[c];
      }
      x[pivots_[k]] = rest / rows_[k][pivots_[k]];
    }
    return x;
  }

  static constexpr Real dependent = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-5);

  static constexpr Real largest(const Row& row) {
    Real most = Real(0);
    for (const Real x : row) most = magnitude(x) > most ? magnitude(x) : most;
    return most;
  }

 private:
  std::array<Row, 4> rows_{};
  std::array<Real, 4> values_{};
  std::array<std::size_t, 4> pivots_{};
  std::size_t count_ = 0;
};

// The equations of one state.
template <class Real>
class Equations {
 public:
  using Row = typename Echelon<Real>::Row;
  struct Equation {
    Real value;
    Row by;
  };

  Equations(const Rig<Real>& rig, const Stance<Real>& stance, std::size_t first)
      : rig_(rig), stance_(stance), first_(first), width_(rig.load.width) {
    const PalmAngle<Real>& own = stance.palms[first];
    const PalmAngle<Real>& partner = stance.palms[other(first)];
    // Of the sum of both angles, between the palms' planes.
    sin_ = own.sin * partner.cos + partner.sin * own.cos;
    cos_ = own.cos * partner.cos - own.sin * partner.sin;
    const Span<Real> vertices = span(stance, vertex_offset(rig, stance));
    for (const std::size_t side : {left, right}) {
      reach_[side] = reach(vertices, side, stance.palms[side]);
    }
  }

  Equation loop() const {
    const Reach<Real> r = reach_[first_];
    const Real square = r.inward * r.inward + r.normal * r.normal;
    return {Real(0.5) * (square - width_ * width_),
            sum(inward(first_), r.inward, normal(first_), r.normal)};
  }

  Equation gap(const Hold<Real>& h) const {
    const Vertex<Real>& v = rig_.outline.vertices[h.feature];
    const Real along = v.along[h.side];
    const Reach<Real> r = reach_[h.side];
    if (!h.tip) {
      Row by = sum(normal(h.side), along, inward(h.side), v.height);
      by[slot(h.side) + 1] += width_;
      return {(along * r.normal + v.height * r.inward) + stance_.lift[h.side] * width_, by};
    }
    const Edge e = edge(h);
    const Tip t = tip(h);
    return {(e.along * width_ - t.along) * e.nx + (e.height * width_ - t.height) * e.ny,
            sum(t.along_by, -e.nx, t.height_by, -e.ny)};
  }

  // Where the contact is: of a vertex on its palm, of a tip along its edge; less `h.at`.
  Equation place(const Hold<Real>& h) const {
    const Vertex<Real>& v = rig_.outline.vertices[h.feature];
    const Real along = v.along[h.side];
    const Reach<Real> r = reach_[h.side];
    if (!h.tip) {
      Row by = sum(normal(h.side), v.height, inward(h.side), -along);
      by[slot(h.side)] += width_;
      const Real from = along * r.inward - v.height * r.normal;
      return {(width_ * stance_.contacts[h.side] - from) - h.at, by};
    }
    const Edge e = edge(h);
    const Tip t = tip(h);
    return {(t.along * e.ny - t.height * e.nx) - h.at, sum(t.along_by, e.ny, t.height_by, -e.nx)};
  }

  // Both vertices move alike along their palms.
  Equation alike(Real at) const {
    const auto& p = stance_.contacts;
    return {width_ * (p[first_] - p[other(first_)]) - at, {width_, Real(0), -width_, Real(0)}};
  }

  std::size_t slot(std::size_t side) const { return side == first_ ? 0 : 2; }

 private:
  // A tip seen along the object from the contact vertex, times w.
  struct Tip {
    Real along;
    Real height;
    Row along_by;
    Row height_by;
  };
  // A point of an edge, and its unit normal into the object.
  struct Edge {
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

  Edge edge(const Hold<Real>& h) const {
    const auto& outline = rig_.outline;
    const Vertex<Real>& a = outline.vertices[h.feature];
    const Vertex<Real>& b = outline.vertices[h.feature + 1 == outline.count ? 0 : h.feature + 1];
    const Real x = mirrored(h.side, a.height - b.height);
    const Real y = mirrored(h.side, b.along[h.side] - a.along[h.side]);
    const Real length = std::sqrt(x * x + y * y);
    // In the mirror the edge's other end comes first.
    const Vertex<Real>& from = h.side == left ? a : b;
    return {from.along[h.side], from.height, x / length, y / length};
  }

  Tip tip(const Hold<Real>& h) const {
    const Reach<Real> r = reach_[h.side];
    const Real in = stance_.contacts[h.side] - h.end;
    const Real below = stance_.lift[h.side];
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

  const Rig<Real>& rig_;
  const Stance<Real>& stance_;
  std::size_t first_;
  Real width_;
  Real sin_ = Real(0);
  Real cos_ = Real(1);
  PerSide<Reach<Real>> reach_{};
};

template <class Real>
constexpr bool is_own(const Rig<Real>& rig, const Hold<Real>& h) {
  return !h.tip && h.feature == rig.outline.contact[h.side];
}

// The equations of a grip, those of its gaps first.
template <class Real>
Echelon<Real> echelon(const Rig<Real>& rig, const Grip<Real>& grip, const Stance<Real>& stance,
                      bool gaps_only) {
  const Equations<Real> equations(rig, stance, grip.first);
  Echelon<Real> system{};
  const auto add = [&](const typename Equations<Real>::Equation& e) { system.add(e.by, e.value); };
  const auto each = [&](bool own, auto&& done) {
    for (std::size_t i = 0; i < grip.count; ++i) {
      if (is_own(rig, grip.holds[i]) == own) done(grip.holds[i]);
    }
  };
  const auto close = [&](const Hold<Real>& h) { add(equations.gap(h)); };
  const auto stick = [&](const Hold<Real>& h) {
    if (h.sticks) add(equations.place(h));
  };
  each(true, close);
  add(equations.loop());
  each(false, close);
  if (gaps_only) return system;
  each(true, stick);
  each(false, stick);
  if (!system.full()) add(equations.alike(grip.alike));
  return system;
}

}  // namespace detail

// Remembers where the contacts of a grip are, and whether its gaps alone leave no freedom.
template <class Real>
void remember(const Rig<Real>& rig, const Stance<Real>& stance, Grip<Real>& grip) {
  const detail::Equations<Real> equations(rig, stance, grip.first);
  for (std::size_t i = 0; i < grip.count; ++i) {
    grip.holds[i].at = Real(0);
    grip.holds[i].at = equations.place(grip.holds[i]).value;
  }
  grip.alike = equations.alike(Real(0)).value;
  grip.full = detail::echelon(rig, grip, stance, true).full();
}

// Moves the object to where the grip holds it; false where that is not near to where it is.
template <class Real>
bool settle(const Rig<Real>& rig, const Grip<Real>& grip, Stance<Real>& stance) {
  const Real width = rig.load.width;
  const Stance<Real> before = stance;
  const std::size_t first = grip.first;
  constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
  Real last = width;
  for (int i = 0; i < 40; ++i) {
    const auto step = detail::echelon(rig, grip, stance, false).solution();
    const Real most = detail::Echelon<Real>::largest(step);
    if (!(most < width)) return false;
    stance.contacts[first] -= step[0];
    stance.lift[first] -= step[1];
    stance.contacts[other(first)] -= step[2];
    stance.lift[other(first)] -= step[3];
    // The last steps are rounding; they do not become smaller.
    if (most <= epsilon * width ||
        (most < touch_tolerance<Real> * width && most >= Real(0.5) * last)) {
      break;
    }
    last = most;
    if (i == 39) return false;
  }
  for (std::size_t i = 0; i < grip.count; ++i) {
    const Hold<Real>& h = grip.holds[i];
    if (!detail::is_own(rig, h)) continue;
    stance.lift[h.side] = Real(0);
    // What sticks keeps every bit.
    const Real moved = stance.contacts[h.side] - before.contacts[h.side];
    const Real slack = Real(64) * epsilon * width;
    if (h.sticks && moved < slack && moved > -slack) {
      stance.contacts[h.side] = before.contacts[h.side];
    }
  }
  return true;
}

// Where a palm is touched, outward from the foot of its pivot: at its contact vertex if that is on it.
template <class Real>
Real felt(const Rig<Real>& rig, const Grip<Real>& grip, const Stance<Real>& stance,
          std::size_t side) {
  for (std::size_t i = 0; i < grip.count; ++i) {
    Hold<Real> h = grip.holds[i];
    if (h.side != side) continue;
    if (h.tip) return h.end;
    h.at = Real(0);
    return detail::Equations<Real>(rig, stance, grip.first).place(h).value / rig.load.width;
  }
  return stance.contacts[side];
}

}  // namespace palmbots
