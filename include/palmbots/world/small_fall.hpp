// SPDX-License-Identifier: Apache-2.0
// Small falls: where an object comes to rest that its contacts no longer hold, for example after it
// has slipped off the nose of a palm.
//
// The surfaces stand still meanwhile. In every pose the object begins to move as a rigid body at
// rest does: M a = weight + contact forces, with Coulomb friction and no contact that closes
// further. It follows that direction, always slowly, until the closed contacts hold it. So the
// places are those of a fall without momentum; its time is zero.
//
// The momentum that is left out limits a fall: the height of a contact vertex counts times the share
// of the potential energy that friction does not take up. An object that slides down a palm which is
// hardly steeper than the friction angle falls by nearly nothing, and off an edge by the whole height.
//
// M needs the radius of gyration, which no scene states: `gyration` of the object's size, about that
// of a box. It decides between directions only where several of them are possible.
#pragma once

#include <optional>

#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

class SmallFall {
 public:
  // A fall of a contact vertex by at most `most` [m], as far as friction does not slow it.
  SmallFall(const ContactProblem& problem, const Frames& frames, double most)
      : problem_(problem),
        frames_(frames),
        most_(most),
        size_(problem.shapes.size),
        closed_(ContactTolerance::closed * problem.shapes.size) {}

  // Moves the pose to where the object rests. How far a contact vertex falls at most [m]; nothing if
  // the object has farther to fall.
  std::optional<double> run(Pose& pose) const {
    const PerSide<double> from = heights(pose);
    PerSide<double> before = from;
    PerSide<double> free{};
    Neighbourhood around;
    const std::size_t first = leading_side(pose);
    for (int i = 0; i < most_steps; ++i) {
      const NearPairs near = around.near(problem_, first, frames_, pose, 4 * pace * size_, closed_);
      const ClosedPairs closed = closed_among(problem_, frames_, pose, near, closed_);
      if (i > 0 && reason_of(problem_, closed) == DropReason::none) {
        rest(closed, pose);
        const PerSide<double> now = heights(pose);
        return larger(from[left] - now[left], from[right] - now[right]);
      }
      const Way way = fastest(closed);
      if (!way.found) return std::nullopt;
      follow(way, closed, near, pose);
      const PerSide<double> now = heights(pose);
      for (const std::size_t side : {left, right}) {
        free[side] += way.unslowed * (before[side] - now[side]);
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
  static constexpr double slack = 1e-9;  // of an acceleration, in those of gravity
  // How far a contact may leave its features: more than what counts as closed, and so little that the
  // contact that takes over is closed, too.
  static constexpr double beyond = 1e-6;

  using Rows = std::array<Triple, 2>;  // more leave no direction
  using Solver = EchelonForm<double, 2>;

  // A contact that takes part: it slides, or both of its rows belong to one that sticks.
  struct Bond {
    std::size_t closed;
    Motion motion;
  };
  // A direction in which the object begins to move.
  struct Way {
    bool found = false;
    Triple by{};            // x, y, turn × size
    double unslowed = 1.0;  // the share of the potential energy that becomes kinetic
    std::array<Bond, 2> bonds{};
    std::size_t count = 0;
  };

  // M⁻¹ of a wrench (its third part divided by the size).
  Triple moved_by(Triple wrench) const {
    return {wrench.x, wrench.y, wrench.z / (gyration * gyration)};
  }

  // M times an acceleration.
  Triple inertia_of(Triple by) const { return {by.x, by.y, by.z * (gyration * gyration)}; }

  PerSide<double> heights(const Pose& pose) const {
    PerSide<double> found{};
    for (const std::size_t side : {left, right})
      found[side] =
          pose.at.y +
          pose.to_world(problem_.shapes.body.corners[problem_.shapes.own[side].feature].centre).y;
    return found;
  }

  // In the mirror the right side is computed first.
  std::size_t leading_side(const Pose& pose) const {
    const auto ranks = [&](std::size_t side) {
      const Vec com = frames_[side].from_world(pose.at - frames_[side].origin);
      return std::array<double, 3>{frames_[side].angle, com.x, com.y};
    };
    return leader(ranks(left), ranks(right), problem_.shapes.lopsided);
  }

  // A direction in which the closed contacts let it begin to move. At most two equations leave it
  // one: the object sticks to one contact, or slides along up to two.
  Way fastest(const ClosedPairs& closed) const {
    constexpr std::array<Motion, 2> slides{Motion::up, Motion::down};
    Way way;
    const auto finds = [&](std::array<Bond, 2> bonds, std::size_t count, bool rough) {
      way = tried(closed, bonds, count, rough);
      return way.found;
    };
    for (const bool rough : {true, false}) {
      for (std::size_t i = 0; rough && i < closed.count; ++i)
        if (finds({{{i, Motion::stick}}}, 1, rough)) return way;
      for (std::size_t i = 0; i < closed.count; ++i)
        for (std::size_t j = i + 1; j < closed.count; ++j)
          for (const Motion a : slides)
            for (const Motion b : slides)
              if (finds({{{i, a}, {j, b}}}, 2, rough)) return way;
      for (std::size_t i = 0; i < closed.count; ++i)
        for (const Motion a : slides)
          if (finds({{{i, a}}}, 1, rough)) return way;
    }
    return tried(closed, {}, 0, false);
  }

  Way tried(const ClosedPairs& closed, std::array<Bond, 2> bonds, std::size_t count,
            bool rough) const {
    const Triple weight = problem_.weight(false) * -1.0;
    // Directions in which nothing moves, and the forces that see to it. A contact that sticks is alone.
    Rows fixed{};
    Rows forces{};
    std::size_t rows = count;
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [pair, c] = closed.at[bonds[k].closed];
      const double friction = rough ? problem_.surface(pair).friction : 0.0;
      const double along = bonds[k].motion == Motion::up ? -friction : friction;
      const bool sticks = bonds[k].motion == Motion::stick;
      fixed[k] = problem_.row(c, c.normal);
      forces[k] = problem_.row(c, sticks ? c.normal : c.normal + c.tangent * along);
      if (!sticks) continue;
      fixed[1] = forces[1] = problem_.row(c, c.tangent);
      rows = 2;
    }
    std::array<double, 2> sizes{};
    if (!solve(fixed, forces, rows,
               {-dot(fixed[0], moved_by(weight)), -dot(fixed[1], moved_by(weight))}, sizes))
      return {};
    Way way{true, moved_by(weight), 1.0, bonds, count};
    for (std::size_t r = 0; r < rows; ++r) way.by = way.by + moved_by(forces[r]) * sizes[r];
    std::array<bool, ClosedPairs::most> bound{};
    double heat = 0.0;  // of friction that the direction leaves out
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [pair, c] = closed.at[bonds[k].closed];
      bound[bonds[k].closed] = true;
      if (bonds[k].motion == Motion::stick) {
        const double most = problem_.surface(pair).friction * sizes[0];
        if (sizes[0] < 0.0 || magnitude(sizes[1]) > most) return {};
        continue;
      }
      if (sizes[k] < 0.0) return {};
      const double slips = dot(problem_.row(c, c.tangent), way.by);
      if (rough && double(static_cast<int>(bonds[k].motion)) * slips < 0.0) return {};
      if (!rough) heat += problem_.surface(pair).friction * sizes[k] * magnitude(slips);
    }
    for (std::size_t i = 0; i < closed.count; ++i) {
      if (bound[i]) continue;
      const FeatureContact& c = closed.at[i].contact;
      if (dot(problem_.row(c, c.normal), way.by) < -slack) return {};
    }
    // It goes down, or it does not fall.
    const double potential = dot(way.by, weight);
    way.found = potential > slack;
    way.unslowed = larger(dot(way.by, inertia_of(way.by)) - heat, 0.0) / potential;
    return way;
  }

  // The sizes of forces with which M⁻¹ of their sum has given parts along fixed directions.
  bool solve(const Rows& fixed, const Rows& forces, std::size_t rows,
             const std::array<double, 2>& parts, std::array<double, 2>& sizes) const {
    Solver system;
    for (std::size_t r = 0; r < 2; ++r) {
      Solver::Row row{};
      row[r] = rows <= r ? 1.0 : 0.0;
      for (std::size_t s = 0; r < rows && s < rows; ++s)
        row[s] = dot(fixed[r], moved_by(forces[s]));
      if (!system.add(row, r < rows ? parts[r] : 0.0)) return false;
    }
    sizes = system.solution();
    return true;
  }

  // Follows a way for a step, at most until a further gap closes.
  void follow(const Way& way, const ClosedPairs& closed, const NearPairs& near, Pose& pose) const {
    const double fast = length(Vec{way.by.x, way.by.y}) + magnitude(way.by.z);
    const double whole = pace * size_ / fast;
    const Pose start = pose;
    double done = 0.0;
    double ahead = whole;
    for (int i = 0; i < 60; ++i) {
      Pose there = advanced(start, way.by, done + ahead);
      const bool kept = keep(way, closed, there);
      if (kept && stays(way, closed, there) && is_free(way, closed, near, there)) {
        done += ahead;
        pose = there;
        if (done >= whole) return;
      }
      ahead *= 0.5;
    }
  }

  Pose advanced(const Pose& pose, Triple by, double t) const {
    return Pose::of(pose.at + Vec{by.x * t, by.y * t}, pose.angle + by.z * t / size_);
  }

  // Closes the gaps of the contacts that persist again, and puts one that sticks back.
  bool keep(const Way& way, const ClosedPairs& closed, Pose& pose) const {
    for (int i = 0; way.count > 0 && i < 20; ++i) {
      Rows fixed{};
      std::array<double, 2> off{};
      std::size_t rows = 0;
      for (std::size_t k = 0; k < way.count; ++k) {
        const auto& [pair, before] = closed.at[way.bonds[k].closed];
        const FeatureContact c = problem_.contact(frames_, pose, pair, before.on_body);
        fixed[rows] = problem_.row(c, c.normal);
        off[rows++] = -c.gap;
        if (way.bonds[k].motion != Motion::stick) continue;
        const double held = pair.kind == PairKind::tip_on_arc ? 0.0 : before.run;
        fixed[rows] = problem_.row(c, c.tangent);
        off[rows++] = held - c.run;
      }
      std::array<double, 2> sizes{};
      if (!solve(fixed, fixed, rows, off, sizes)) return false;
      Triple by{};
      for (std::size_t r = 0; r < rows; ++r) by = by + moved_by(fixed[r]) * sizes[r];
      pose = advanced(pose, by, 1.0);
      if (EchelonForm<double, 3>::largest({by.x, by.y, by.z}) < 1e-14 * size_) break;
    }
    return true;
  }

  // Whether the contacts that persist are not much beyond their features' ends, where others take
  // over.
  bool stays(const Way& way, const ClosedPairs& closed, const Pose& pose) const {
    for (std::size_t b = 0; b < way.count; ++b) {
      const FeaturePair pair = closed.at[way.bonds[b].closed].pair;
      if (problem_.contact(frames_, pose, pair).inside < -beyond) return false;
    }
    return true;
  }

  bool is_free(const Way& way, const ClosedPairs& closed, const NearPairs& near,
               const Pose& pose) const {
    for (std::size_t k = 0; k < near.count; ++k) {
      if (near.at[k].behind) continue;
      bool bound = false;
      for (std::size_t b = 0; b < way.count; ++b)
        bound = bound || closed.at[way.bonds[b].closed].pair == near.at[k].pair;
      const FeatureContact c = problem_.contact(frames_, pose, near.at[k].pair);
      if (!bound && c.inside >= 0.0 && c.gap < -0.5 * closed_) return false;
    }
    return true;
  }

  // Closes the gaps of all contacts that hold the object to the last bit.
  void rest(const ClosedPairs& closed, Pose& pose) const {
    for (int i = 0; i < 4; ++i) {
      EchelonForm<double, 3> system;
      for (std::size_t k = 0; k < closed.count && !system.full(); ++k) {
        const FeatureContact c = problem_.contact(frames_, pose, closed.at[k].pair);
        const Triple row = problem_.row(c, c.normal);
        system.add({row.x, row.y, row.z}, -c.gap);
      }
      for (std::size_t k = 0; k < 3 && !system.full(); ++k)
        system.add({k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, 0.0);
      const auto by = system.solution();
      pose = advanced(pose, {by[0], by[1], by[2]}, 1.0);
    }
  }

  const ContactProblem& problem_;
  Frames frames_;
  double most_;
  double size_;
  double closed_;
};

// `SmallFall::run`.
inline std::optional<double> small_fall(const ContactProblem& problem, const Frames& frames,
                                        double most, Pose& pose) {
  return SmallFall(problem, frames, most).run(pose);
}

}  // namespace palmbots
