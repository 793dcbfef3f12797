// SPDX-License-Identifier: Apache-2.0
// Every point at which the palms touch the object, and how far it would sink into a palm.
//
// Seen from a contact vertex: a palm is a segment along the x axis of its own frame (inward,
// normal), as in mechanics/clearance.hpp. The object touches it with a vertex, with an edge that
// lies flush on it (whose two ends on the palm hold it like two points), or meets a palm's tip with
// an edge, whose normal counts there. What is nearer than a tolerance touches. Source:
// docs/theory/contacts.md.
#pragma once

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/twist_feasibility.hpp"

namespace palmbots {

// 2.5 µm for the paper's box: finer than any measured length, coarser than a coordinate that a
// person writes down.
template <class Real>
inline constexpr Real contact_tolerance = Real(1e-5);

template <class Real>
struct ContactPoint {
  ContactKind kind;
  // What touches: an end of the palm and the edge that starts at this vertex, or this vertex.
  bool palm_end;
  std::size_t feature;
  Real place;           // p on the palm [m]
  PerSide<Real> along;  // in the object's frame, as Vertex
  Real height;
  Support<Real> support;
};

template <class Real>
struct ContactSet {
  std::array<ContactPoint<Real>, max_supports> points{};  // left first; a palm's own vertex first
  std::size_t count = 0;                                  // may exceed what `points` holds
  PerSide<Real> sunk{};     // how deep a palm lies in the object; 0 where it does not [m]
  PerSide<Real> pivot_x{};  // of the palms, from the COM [m]
  PerSide<Real> pivot_y{};
};

namespace detail {

// One palm and the object in the palm's frame, whose origin is the contact vertex's foot on the
// palm. The outline is walked from that vertex inward along the object's bottom, which in the
// mirror is the same walk: every number comes out alike to the last bit, and the events found by it
// come at one instant.
template <class Real>
class PalmView {
 public:
  PalmView(const Model<Real>& model, const Configuration<Real>& configuration, std::size_t side,
           ContactVector<Real> contact_vector, Real near)
      : model_(model),
        side_(side),
        palm_(configuration.palms[side]),
        own_(configuration.contacts[side]),
        lift_(configuration.lift[side]),
        half_(model.half_length[side]),
        near_(near) {
    const PalmFrameVector<Real> r = palm_frame_vector(contact_vector, side, palm_);
    cos_ = r.inward / model.object.width;
    sin_ = r.normal / model.object.width;
    com_ = seen(side == left ? model.object.com_left : model.object.com_right,
                model.object.com_height);
    for (std::size_t i = 0; i < count(); ++i) {
      const Vertex<Real>& v = model.outline.vertices[vertex(i)];
      at_[i] = seen(v.along[side], v.height);
    }
  }

  void add_to(ContactSet<Real>& found) const {
    const Point pivot = world({own_, -model_.offset[side_]});
    found.pivot_x[side_] = pivot.inward;
    found.pivot_y[side_] = pivot.above;
    Surface surface{};
    const bool stands = lift_ <= near_;
    if (stands) {
      surface.places[surface.count++] = {own_, ContactKind::vertex, false,
                                         model_.outline.contact[side_]};
    }
    add_flush(surface);
    add_vertices(surface);
    found.sunk[side_] = sunk(surface);
    for (std::size_t k = 0; k < surface.count; ++k) {
      // Between the outermost contacts of one plate others add nothing: their forces and velocities
      // lie between those of the outer ones.
      const Real p = surface.places[k].place;
      if ((k == 0 && stands) || p == surface.low() || p == surface.high()) {
        put(found, surface.places[k], {Real(0), Real(1)});
      }
    }
    add_tips(found, surface);
  }

 private:
  struct Point {
    Real inward;
    Real above;
  };
  struct OnPalm {
    Real place;
    ContactKind kind;
    bool palm_end;
    std::size_t feature;
  };
  struct Surface {
    std::array<OnPalm, 3 * max_outline + 1> places{};
    std::size_t count = 0;

    Real low() const {
      Real p = places[0].place;
      for (std::size_t k = 1; k < count; ++k) p = places[k].place < p ? places[k].place : p;
      return p;
    }
    Real high() const {
      Real p = places[0].place;
      for (std::size_t k = 1; k < count; ++k) p = places[k].place > p ? places[k].place : p;
      return p;
    }
  };

  Point seen(Real along, Real height) const {
    return {along * cos_ - height * sin_, along * sin_ + height * cos_ + lift_};
  }

  // A direction, or a point relative to the COM, in the world (as x and y).
  Point turned(Point v) const {
    const Real lateral = v.inward * palm_.cos + v.above * palm_.sin;
    return {mirrored(side_, lateral), v.above * palm_.cos - v.inward * palm_.sin};
  }
  Point world(Point v) const { return turned({v.inward - com_.inward, v.above - com_.above}); }

  // The walk: its vertices, and their numbers and those of its edges in the outline.
  std::size_t count() const { return model_.outline.count; }
  std::size_t next(std::size_t i) const { return i + 1 == count() ? 0 : i + 1; }
  std::size_t vertex(std::size_t i) const { return model_.outline.walked(side_, i); }
  std::size_t edge(std::size_t i) const { return vertex(side_ == left ? i : next(i)); }

  // Across the edge from vertex i to the next one, into the object.
  Point into(std::size_t i) const {
    const Point& a = at_[i];
    const Point& b = at_[next(i)];
    const Real x = a.above - b.above;
    const Real y = b.inward - a.inward;
    const Real length = std::sqrt(x * x + y * y);
    return {x / length, y / length};
  }

  bool on_palm(Real place) const { return magnitude(place) <= half_ + near_; }

  // The same place once; an end of a flush edge is that before it is a vertex.
  void insert(Surface& surface, const OnPalm& point) const {
    for (std::size_t k = 0; k < surface.count; ++k) {
      if (magnitude(surface.places[k].place - point.place) <= Real(2) * near_) {
        if (point.kind == ContactKind::flush) surface.places[k].kind = point.kind;
        return;
      }
    }
    surface.places[surface.count++] = point;
  }

  void add_flush(Surface& surface) const {
    for (std::size_t i = 0; i < count(); ++i) {
      const Point& a = at_[i];
      const Point& b = at_[next(i)];
      const Real run = b.inward - a.inward;
      if (!(run > Real(0))) continue;  // the object is below this edge
      const Real low = clamp(own_ - b.inward, -half_, half_);
      const Real high = clamp(own_ - a.inward, -half_, half_);
      if (!(high - low > Real(100) * near_)) continue;  // too short a stretch to have a direction
      const Real rise = (b.above - a.above) / run;
      const Real above_low = a.above + rise * ((own_ - low) - a.inward);
      const Real above_high = a.above + rise * ((own_ - high) - a.inward);
      if (magnitude(above_low) <= near_ && magnitude(above_high) <= near_) {
        const bool ends_low = own_ - b.inward < -half_ - near_;
        const bool ends_high = own_ - a.inward > half_ + near_;
        insert(surface, {low, ContactKind::flush, ends_low, ends_low ? edge(i) : vertex(next(i))});
        insert(surface, {high, ContactKind::flush, ends_high, ends_high ? edge(i) : vertex(i)});
      }
    }
  }

  void add_vertices(Surface& surface) const {
    for (std::size_t i = 0; i < count(); ++i) {
      const Point& v = at_[i];
      const Point& before = at_[i == 0 ? count() - 1 : i - 1];
      const Point& after = at_[next(i)];
      const Real turn = (v.inward - before.inward) * (after.above - v.above) -
                        (v.above - before.above) * (after.inward - v.inward);
      // Where an edge goes below the plate, the plate ends at this vertex: a tip meets an edge.
      const bool below = before.above < -near_ || after.above < -near_;
      if (magnitude(v.above) <= near_ && on_palm(own_ - v.inward) && turn > Real(0) && !below) {
        insert(surface,
               {clamp(own_ - v.inward, -half_, half_), ContactKind::vertex, false, vertex(i)});
      }
    }
  }

  // True if the plate touches so near to this place that both are one contact.
  bool touches_at(const Surface& surface, Real place) const {
    for (std::size_t k = 0; k < surface.count; ++k) {
      if (magnitude(surface.places[k].place - place) <= Real(100) * near_) return true;
    }
    return false;
  }

  // Where a palm's tip meets an edge, unless the plate touches there anyway.
  void add_tips(ContactSet<Real>& found, const Surface& surface) const {
    for (const Real end : {-half_, half_}) {
      if (touches_at(surface, end)) continue;
      for (std::size_t i = 0; i < count(); ++i) {
        if (distance({own_ - end, Real(0)}, i) <= near_) {
          put(found, {end, ContactKind::tip, true, edge(i)}, into(i));
        }
      }
    }
  }

  void put(ContactSet<Real>& found, const OnPalm& at, Point normal) const {
    if (found.count < max_supports) {
      const Real inward = own_ - at.place;
      const Real along = inward * cos_ - lift_ * sin_;
      const Real beyond = model_.object.width - along;
      const Point point = world({inward, Real(0)});
      const Point n = turned(normal);
      found.points[found.count] = {
          at.kind,
          at.palm_end,
          at.feature,
          at.place,
          side_ == left ? PerSide<Real>{along, beyond} : PerSide<Real>{beyond, along},
          Real(0) - inward * sin_ - lift_ * cos_,
          {side_, point.inward, point.above, n.inward, n.above, model_.friction[side_]}};
    }
    ++found.count;
  }

  // Distance of a point from the edge from vertex i to the next one.
  Real distance(Point p, std::size_t i) const {
    const Point& a = at_[i];
    const Point& b = at_[next(i)];
    const Point along{b.inward - a.inward, b.above - a.above};
    const Real square = along.inward * along.inward + along.above * along.above;
    const Real share =
        ((p.inward - a.inward) * along.inward + (p.above - a.above) * along.above) / square;
    const Real t = clamp(share, Real(0), Real(1));
    const Real x = p.inward - (a.inward + t * along.inward);
    const Real y = p.above - (a.above + t * along.above);
    return std::sqrt(x * x + y * y);
  }

  // How far inside the object a point of the palm lies.
  Real depth(Real inward) const {
    const Real along = inward * cos_ - lift_ * sin_;
    if (!inside(model_.outline, side_, along, -inward * sin_ - lift_ * cos_)) return Real(0);
    Real least = distance({inward, Real(0)}, 0);
    for (std::size_t i = 1; i < count(); ++i) {
      const Real other = distance({inward, Real(0)}, i);
      if (other < least) least = other;
    }
    return least;
  }

  // The deepest of the palm's tips, the places where edges cross it or below or above which
  // vertices lie, and the places halfway between two of those: no piece of palm in the object
  // escapes. A tip that is one contact with a corner is as deep in the object as that was above the
  // palm, which is nothing.
  Real sunk(const Surface& surface) const {
    std::array<Real, 2 * max_outline + 2> marks{};
    std::size_t found = 0;
    const auto mark = [&](Real inward) {
      if (magnitude(own_ - inward) <= half_) marks[found++] = inward;
    };
    for (std::size_t i = 0; i < count(); ++i) {
      const Point& a = at_[i];
      const Point& b = at_[next(i)];
      mark(a.inward);
      if ((a.above > Real(0)) != (b.above > Real(0))) {
        mark(a.inward + (b.inward - a.inward) * (a.above / (a.above - b.above)));
      }
    }
    marks[found++] = own_ - half_;
    marks[found++] = own_ + half_;
    sort_few(marks.data(), found);
    Real deepest = Real(0);
    const auto look = [&](Real inward) {
      const Real place = own_ - inward;
      const bool at_tip = magnitude(place) > half_ - Real(100) * near_;
      if (at_tip && touches_at(surface, place)) return;
      const Real here = depth(inward);
      if (here > deepest) deepest = here;
    };
    look(marks[0]);
    for (std::size_t k = 1; k < found; ++k) {
      look(marks[k]);
      look(Real(0.5) * (marks[k - 1] + marks[k]));
    }
    return deepest;
  }

  const Model<Real>& model_;
  std::size_t side_;
  PalmAngle<Real> palm_;
  Real own_;
  Real lift_;
  Real half_;
  Real near_;
  Real cos_ = Real(1);
  Real sin_ = Real(0);
  Point com_{};
  std::array<Point, max_outline> at_{};  // the vertices, as they are walked
};

}  // namespace detail

// How far the contact vertices are from the pivots, along the palms' normals.
template <class Real>
constexpr PerSide<Real> vertex_offset(const Model<Real>& model,
                                      const Configuration<Real>& configuration) {
  return {model.offset[left] + configuration.lift[left],
          model.offset[right] + configuration.lift[right]};
}

// All contacts of a state, nearer than `tolerance` × w; the configuration's separation does not
// count, the contacts and angles give it.
template <class Real>
ContactSet<Real> detect_contacts(const Model<Real>& model, const Configuration<Real>& configuration,
                                 Real tolerance = contact_tolerance<Real>) {
  const Real width = model.object.width;
  const Real dy = contact_vector(configuration, vertex_offset(model, configuration)).dy;
  const ContactVector<Real> between{std::sqrt((width - dy) * (width + dy)), dy};
  ContactSet<Real> found{};
  for (const std::size_t side : {left, right}) {
    detail::PalmView<Real>(model, configuration, side, between, tolerance * width).add_to(found);
  }
  return found;
}

}  // namespace palmbots
