// SPDX-License-Identifier: Apache-2.0
// Small falls: where an object comes to rest that its contacts no longer hold, for example after it
// has slipped off the nose of a palm.
//
// In every pose the object begins to move as a rigid body at rest does: M a = weight + contact forces,
// with Coulomb friction and no contact that closes further. It follows that direction, always slowly,
// until the closed contacts hold it. So the places are those of a fall without momentum; its time is
// zero, and the surfaces stand still. M needs the radius of gyration, which no scene states:
// `gyration` of the object's size, about that of a box. It decides only between several directions.
//
// Source: docs/theory/contacts.md, Small falls, also of what limits a fall.
#pragma once

#include <initializer_list>
#include <optional>

#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

class SmallFall {
 public:
  // A fall of a contact vertex by at most `most` [m], as far as friction does not slow it.
  SmallFall(Instant& now, double most) : now_(now), most_(most) {}

  // Moves the object to where it rests. How far a contact vertex falls at most [m]; nothing if the
  // object has farther to fall.
  std::optional<double> run() {
    const PerSide<double> from = heights();
    PerSide<double> before = from;
    PerSide<double> free{};
    Neighbourhood around;
    const std::size_t first = leading_side(now_, {});
    for (int i = 0; i < most_steps; ++i) {
      const NearPairs near = around.near(now_, first, 4 * pace * size_, closed_);
      const ClosedPairs closed = closed_among(now_, near, closed_);
      if (i > 0 && reason_of(now_.problem, closed) == DropReason::none) {
        rest(closed);
        const PerSide<double> now = heights();
        return larger(from[left] - now[left], from[right] - now[right]);
      }
      const std::optional<Way> way = fastest(closed);
      if (!way) return std::nullopt;
      follow(*way, near);
      const PerSide<double> now = heights();
      for (const std::size_t side : {left, right}) {
        free[side] += way->unslowed * (before[side] - now[side]);
        if (free[side] > most_) return std::nullopt;
      }
      before = now;
    }
    return std::nullopt;
  }

 private:
  static constexpr double gyration = 0.3;
  static constexpr double pace = 1e-4;  // of a step, in sizes
  static constexpr int most_steps = 5000;
  static constexpr double slack = 1e-9;   // of an acceleration: one about to tip has hardly any
  static constexpr double still = 1e-12;  // what rounding makes of none [that of gravity]
  // How far a contact may leave its features: more than what counts as closed, and so little that the
  // contact that takes over is closed, too.
  static constexpr double beyond = 1e-6;

  // A direction in which the object does not move, the force that sees to it, and by how much the
  // motion is to change along the direction.
  struct Hold {
    Triple row;
    Triple force;
    double part;
  };
  using Holds = FixedList<Hold, 2>;  // more leave no direction
  // A direction in which the object begins to move: x, y, turn × size.
  struct Way {
    Triple by{};
    Regime bonds;           // contacts that persist: one sticks, or up to two slide
    double unslowed = 1.0;  // the share of the potential energy that becomes kinetic
  };

  // M⁻¹ of a wrench (its third part divided by the size).
  Triple moved_by(Triple wrench) const {
    return {wrench.x, wrench.y, wrench.z / (gyration * gyration)};
  }

  // M times an acceleration.
  Triple inertia_of(Triple by) const { return {by.x, by.y, by.z * (gyration * gyration)}; }

  // Of the contact vertices.
  PerSide<double> heights() const {
    const ContactShapes& shapes = now_.problem.shapes;
    const auto height = [&](std::size_t side) {
      const Corner& corner = shapes.body.corners[shapes.own[side].feature];
      return now_.pose.at.y + now_.pose.to_world(corner.centre).y;
    };
    return {height(left), height(right)};
  }

  // A direction in which the closed contacts let it begin to move. At most two equations leave it
  // one: the object sticks to one contact, or slides along up to two.
  std::optional<Way> fastest(const ClosedPairs& closed) const {
    constexpr std::array<Motion, 2> slides{Motion::up, Motion::down};
    std::optional<Way> way;
    const auto finds = [&](std::initializer_list<ActivePair> bonds, bool rough) {
      way = tried(closed, {bonds}, rough);
      return way.has_value();
    };
    for (const bool rough : {true, false}) {
      for (std::size_t i = 0; rough && i < closed.size(); ++i)
        if (finds({active_of(closed[i], Motion::stick)}, rough)) return way;
      for (std::size_t i = 0; i < closed.size(); ++i)
        for (std::size_t j = i + 1; j < closed.size(); ++j)
          for (const Motion a : slides)
            for (const Motion b : slides)
              if (finds({active_of(closed[i], a), active_of(closed[j], b)}, rough)) return way;
      for (const FeatureContact& c : closed)
        for (const Motion a : slides)
          if (finds({active_of(c, a)}, rough)) return way;
    }
    finds({}, false);
    return way;
  }

  std::optional<Way> tried(const ClosedPairs& closed, const Regime& bonds, bool rough) const {
    const Triple weight = now_.problem.weight(false) * -1.0;
    const PosedRegime at(now_, bonds);
    Way way{moved_by(weight), bonds};
    Holds holds = holds_of(at, rough);
    for (Hold& hold : holds) hold.part = -dot(hold.row, way.by);
    std::array<double, 2> sizes{};
    if (!push(holds, way.by, sizes)) return {};
    const double fast = size(way.by);
    if (!(fast > still)) return {};
    double heat = 0.0;
    for (std::size_t k = 0; k < at.contacts.size(); ++k) {
      const ActiveContact& c = at.contacts[k];
      const double most = c.friction * sizes[k];
      if (sizes[k] < 0.0) return {};
      if (c.motion == Motion::stick) {
        if (magnitude(sizes[1]) > most) return {};
        continue;
      }
      const double slips = dot(now_.row(c, c.tangent), way.by);
      if (rough && way_of(c.motion) * slips < 0.0) return {};
      heat += most * magnitude(slips);
    }
    for (const FeatureContact& c : closed)
      if (!bonds.has(c.pair) && dot(now_.row(c, c.normal), way.by) < -(slack * fast + still))
        return {};
    // Friction that the direction leaves out would have slowed it.
    const double kinetic = dot(way.by, inertia_of(way.by));
    way.unslowed = rough ? kinetic / (kinetic + heat) : larger(kinetic - heat, 0.0) / kinetic;
    return way;
  }

  // The parts are those that put the contacts back to where they hold.
  Holds holds_of(const PosedRegime& at, bool rough) const {
    Holds holds;
    for (const ActiveContact& c : at.contacts) {
      const Vec along = c.tangent * (-way_of(c.motion) * (rough ? c.friction : 0.0));
      const Triple tangent = now_.row(c, c.tangent);
      holds.push_back({now_.row(c, c.normal), now_.row(c, c.normal + along), -c.gap});
      if (c.motion == Motion::stick) holds.push_back({tangent, tangent, -c.slipped()});
    }
    return holds;
  }

  // Adds forces of the holds, of these sizes, so that a motion changes by their parts. False if no
  // forces do that.
  bool push(const Holds& holds, Triple& by, std::array<double, 2>& sizes) const {
    EchelonForm<double, 2> system;
    for (const Hold& hold : holds) {
      EchelonForm<double, 2>::Row row{};
      for (std::size_t s = 0; s < holds.size(); ++s)
        row[s] = dot(hold.row, moved_by(holds[s].force));
      if (!system.add(row, hold.part)) return false;
    }
    sizes = system.solution();
    for (std::size_t r = 0; r < holds.size(); ++r) by = by + moved_by(holds[r].force) * sizes[r];
    return true;
  }

  // Follows a way for a step, at most until a further gap closes.
  void follow(const Way& way, const NearPairs& near) {
    const double fast = length(Vec{way.by.x, way.by.y}) + magnitude(way.by.z);
    const double whole = pace * size_ / fast;
    const Instant start = now_;
    double done = 0.0;
    double ahead = whole;
    for (int i = 0; i < 60; ++i) {
      PosedRegime there({now_.problem, now_.frames, start.after(way.by, done + ahead)}, way.bonds);
      if (keep(there) && is_free(there, near)) {
        done += ahead;
        now_.pose = there.pose;
        if (done >= whole) return;
      }
      ahead *= 0.5;
    }
  }

  // Closes the gaps of the contacts that persist again, and puts one that sticks back.
  bool keep(PosedRegime& there) const {
    for (int i = 0; !there.regime.none() && i < 20; ++i) {
      Triple by{};
      std::array<double, 2> sizes{};
      if (!push(holds_of(there, false), by, sizes)) return false;
      there.put(there.after(by));
      if (EchelonForm<double, 3>::largest({by.x, by.y, by.z}) < 1e-14 * size_) break;
    }
    return true;
  }

  // Whether nothing else overlaps, and the contacts that persist are not much beyond their features'
  // ends, where others take over.
  bool is_free(const PosedRegime& there, const NearPairs& near) const {
    for (const auto& [pair, behind] : near) {
      const FeatureContact c = there.contact(pair);
      const bool overlaps = !behind && c.inside >= 0.0 && c.gap < -0.5 * closed_;
      if (there.regime.has(pair) ? c.inside < -beyond : overlaps) return false;
    }
    return true;
  }

  // Closes the gaps of all contacts that hold the object to the last bit.
  void rest(const ClosedPairs& closed) {
    for (int i = 0; i < 4; ++i) {
      EchelonForm<double, 3> system;
      for (const FeatureContact& one : closed) {
        const FeatureContact c = now_.contact(one.pair);
        const Triple row = now_.row(c, c.normal);
        system.add({row.x, row.y, row.z}, -c.gap);
      }
      for (std::size_t k = 0; k < 3 && !system.full(); ++k)
        system.add({k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, 0.0);
      const auto by = system.solution();
      now_.pose = now_.after({by[0], by[1], by[2]});
    }
  }

  Instant& now_;
  double most_;
  double size_ = now_.problem.shapes.size;
  double closed_ = Tolerance::closed * size_;
};

}  // namespace palmbots
