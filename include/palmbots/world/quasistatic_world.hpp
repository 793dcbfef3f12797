// SPDX-License-Identifier: Apache-2.0
// The quasistatic world: exact motion of the contacts while the robots move and the palms turn.
//
// A step moves the pivots and turns the palms, both linearly. Nothing is integrated, and a contact that
// sticks is never written, so it cannot drift. If one contact slides through a whole step,
// world/fast_step.hpp computes it; if the regime changes, world/general_step.hpp does. If a further
// contact closes, world/contact_step.hpp takes over until it opens again.
//
// `push` is the sideways specific force of the object's inertia when the pair changes its speed. It
// affects only which contact slips first; the conditions that end a carry are evaluated without it.
//
// Source: docs/theory/mechanics.md, which also explains why accelerations take part.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "palmbots/world/contact_shapes.hpp"
#include "palmbots/world/contact_step.hpp"
#include "palmbots/world/general_step.hpp"
#include "palmbots/world/palm_contacts.hpp"
#include "palmbots/world/small_fall.hpp"
#include "palmbots/world/vertex_pose.hpp"

namespace palmbots {

// The world of one carry.
template <class Real>
class World {
 public:
  World() = default;
  World(const Model<Real>& model, const Configuration<Real>& configuration)
      : model_(model),
        state_{{configuration, palmbots::contact_vector(configuration, model.offset)},
               {Real(0), Real(0), Real(takes_single_steps(model) ? 1 : 0)}} {}

  const Configuration<Real>& configuration() const { return state_.configuration; }
  const Model<Real>& model() const { return model_; }
  ContactVector<Real> contact_vector() const { return state_.contact_vector; }
  // Places palms and object anew, for example the object on the floor. `pivots` are positions [m].
  // Palms, object and floor must not overlap.
  void put(const PerSide<Vec>& pivots, const PerSide<Real>& angles, const Pose& pose) {
    separation_ = pivots[right].x - pivots[left].x;
    middle_ = 0.5 * (pivots[left].x + pivots[right].x);
    for (const std::size_t side : {left, right}) {
      height_[side] = pivots[side].y;
      state_.configuration.palms[side] = PalmAngle<Real>::at(angles[side]);
    }
    posed_ = true;
    pose_ = pose;
    regime_ = {};
    state_.multi_contact = Real(1);
    place(travel({}, angles).frames(0.0));
  }
  // The phase of the task, which decides what ends a step (mechanics/carry_ends.hpp).
  void set_phase(CarryPhase phase) { phase_ = phase; }
  // Also sets by how much a contact vertex may fall [m] where the object may fall in this phase.
  void set_phase(CarryPhase phase, double most_fall) {
    phase_ = phase;
    most_fall_ = most_fall;
    small_fall_ = [](Instant& now, double most) { return SmallFall(now, most).run(); };
  }

  // The angle of the object, whose contacts are `width` apart [rad]. For people and pictures only: no
  // motion depends on it, so libm may serve.
  double tilt(double width) const {
    return posed_ || is_pipe(model_.object) ? pose().angle
                                            : std::asin(double(state_.contact_vector.dy) / width);
  }
  // Draws what follows ambiguous events: from a stream of the random numbers of a seed.
  void draw_ambiguous(std::uint64_t seed, std::uint32_t stream) {
    ambiguous_ = {true, seed, stream, ambiguous_.count};
  }
  // How many events were ambiguous so far.
  std::uint32_t ambiguous_events() const { return ambiguous_.count; }
  // Those of the last step that was not fast; empty where no event in it was ambiguous.
  const std::vector<AmbiguousChoice>& choices() const { return choices_; }
  // The contacts that ran off the end of their feature in that step.
  const std::vector<FeaturePair>& run_off() const { return run_off_; }

  Pose pose() const { return posed_ ? pose_ : pose_on_vertices(model_, state_, here()); }
  // The position of a pivot.
  Vec pivot(std::size_t side) const {
    return {middle_ + 0.5 * outward<double>(side) * separation(), height_[side]};
  }
  // Whether the object touches a palm.
  bool is_touched(std::size_t side) const {
    return !posed_ || regime_.first_on_palms()[side] != nullptr;
  }
  // The coordinates at which the palms are touched: p of the contact vertex as long as that is on
  // the palm [m].
  PerSide<Real> touched() const {
    const PerSide<Real>& places = state_.configuration.contacts;
    if (!posed_) return places;
    const ContactProblem problem = this->problem();
    const PerSide<double> found = touched_places({problem, here(), pose_}, regime_,
                                                 {double(places[left]), double(places[right])});
    return {Real(found[left]), Real(found[right])};
  }
  const Advance<Real>& last() const { return last_; }
  // The fall that ended the last step, if one did: the rest of the step was not done.
  const std::optional<Fall>& fall() const { return fall_; }
  // Whether robots may stall: the ways of both then matter, and not only their difference.
  bool is_limited() const { return model_.limit != no_limits<double>; }

  // The moving state, for a caller that runs several worlds in lanes and copies states out and
  // back.
  const WorldState<Real>& state() const { return state_; }
  void set_state(const WorldState<Real>& state) { state_ = state; }

  // The contacts on which the object rests; `none()` if these are its two contact vertices (or not
  // known before the first step after `put`).
  const Regime& regime() const { return regime_; }
  // Made when first needed: most carries never need them.
  const ContactShapes& shapes() const {
    if (!shapes_) shapes_ = shapes_of(model_);
    return *shapes_;
  }
  const ContactEventCounter<Real>& contact_events() const { return contact_events_; }
  // The contacts whose gap is at most `within` [m].
  std::vector<Touched> touched_in(double within) const {
    const ContactProblem problem = this->problem();
    return touched_by(shapes(), touching({problem, here(), pose()}, within), within);
  }
  // The palm whose faces, moved by `deep` into it, still lie in the object.
  std::optional<std::size_t> pierced_palm(double deep) const {
    const ContactProblem problem = this->problem();
    const auto carrier = pierced_carrier({problem, here(), pose()}, deep);
    return carrier == std::size_t(Carrier::ground) ? std::nullopt : carrier;
  }

  // Why the object is not held in its present position, or `none`.
  DropReason check() const { return ends_as(checked(), CarryPhase::placed); }

  // Shifts the contacts suddenly, by `by` [m]. The robots are displaced so that the loop stays
  // closed.
  DropReason shift(const PerSide<Real>& by) {
    Configuration<Real>& now = state_.configuration;
    for (const std::size_t side : {left, right}) now.contacts[side] += by[side];
    now.lift = {};
    now.separation = closing_separation(now, model_.offset, model_.object.width);
    state_.contact_vector = palmbots::contact_vector(now, model_.offset);
    state_.tied = Real(0);
    regime_ = {};
    posed_ = false;
    state_.multi_contact = Real(takes_single_steps(model_) ? 1 : 0);
    return check();
  }

  // Changes the separation by `change` [m] and turns the palms to `angles` [rad], both linearly.
  // Returns the events of the step; the reference is valid until the next step.
  const Advance<Real>& advance(Real change, const PerSide<Real>& angles, Real push = Real(0)) {
    if (state_.multi_contact != Real(0)) [[unlikely]] {
      state_.push = push;
      return take_apart(change, angles);
    }
    const ModelParams<Real>& params = model_;
    const FastStep<Real> step = step_fast(params, state_, change, angles, push);
    if (!step.done) return take_apart(change, angles);
    const std::size_t side = step.on_left ? left : right;  // it slid, at last or all the time
    last_.reason = DropReason::none;
    last_.fraction = Real(1);
    last_.motion[side] = step.closing ? SlipDirection::up : SlipDirection::down;
    last_.motion[other(side)] = SlipDirection::stick;
    last_.segments = step.switched ? 2 : 1;
    return last_;
  }

  // Moves each pivot by `by` [m].
  const Advance<Real>& advance(const PerSide<Vec>& by, const PerSide<Real>& angles,
                               Real push = Real(0)) {
    const bool level = height_[left] == height_[right] && by[left].y == by[right].y;
    if (model_.surroundings.empty() && level && !posed_ && !is_limited()) {
      height_ = {height_[left] + by[left].y, height_[right] + by[right].y};
      middle_ += 0.5 * (by[left].x + by[right].x);
      return advance(Real(by[right].x - by[left].x), angles, push);
    }
    state_.push = push;
    return take_apart(by, angles);
  }

  // The same, for a step that the fast step has left undone. Both robots travel alike.
  const Advance<Real>& take_apart(Real change, const PerSide<Real>& angles) {
    return take_apart({Vec{-0.5 * double(change), 0.0}, Vec{0.5 * double(change), 0.0}}, angles);
  }

 private:
  const Advance<Real>& take_apart(const PerSide<Vec>& by, const PerSide<Real>& angles) {
    choices_.clear();
    run_off_.clear();
    fall_.reset();
    last_ = go(by, angles);
    const Then then = consequence(last_.reason, phase_).then;
    if (then == Then::stalls) {
      for (const std::size_t side : {left, right})
        if (by[side].x != 0) last_.stalled[side] += 1 - double(last_.fraction);
    }
    const bool falls = then == Then::falls && has_fallen();
    last_.reason = falls ? DropReason::none : ends_as(last_.reason, phase_);
    state_.multi_contact = Real(posed_ || takes_single_steps(model_) ? 1 : 0);
    return last_;
  }

  // Whether contacts may leave the part of the palm on which the heel touches nothing, up to the heel.
  bool may_leave_reach() const { return model_.profile[left].stops || model_.profile[right].stops; }
  bool is_beyond_reach() const {
    const PerSide<Real>& p = state_.configuration.contacts;
    return !(within(p[left], model_.reach[left]) && within(p[right], model_.reach[right]));
  }

  // Whether this is a further contact, with which the object moves on.
  static bool goes_on(DropReason event) {
    return consequence(event, CarryPhase::carried).then == Then::goes_on;
  }

  DropReason checked() const {
    const Configuration<Real>& here = state_.configuration;
    if (posed_ || takes_single_steps(model_)) return check_all();
    const DropReason reason = drop_reason(model_, here.palms, here.contacts, state_.contact_vector);
    if (reason == DropReason::off_palm && may_leave_reach()) return check_all();
    if (!goes_on(reason)) return reason;
    const DropReason found = check_all();
    return goes_on(found) ? reason : found;
  }

  // Why all contacts together do not hold the object.
  DropReason check_all() const {
    const ContactProblem problem = this->problem();
    const Instant now{problem, here(), pose()};
    const double closed = double(closed_tolerance<Real> * Real(shapes().size));
    // Smaller than the gap of a closed contact: a corner penetrates a palm deeper than the palm
    // penetrates the corner.
    const double deep = closed / 64.0;
    if (pierced_carrier(now, deep)) return DropReason::flush;
    if (off_palm(now, closed)) return DropReason::off_palm;
    return reason_of(problem, touching(now, closed));
  }

  ContactProblem problem() const {
    return {shapes(), double(model_.object.slope), double(state_.push), needs_both_palms(phase_),
            model_.limit};
  }

  PerSide<Real> angles() const {
    const auto& palms = state_.configuration.palms;
    return {palms[left].angle, palms[right].angle};
  }

  // The palms from here on, while the pivots move and the palms turn to goals.
  Travel travel(const PerSide<Vec>& by, const PerSide<Real>& goals) const {
    const PerSide<Real> from = angles();
    return Travel::of({pivot(left), pivot(right)}, {double(from[left]), double(from[right])}, by,
                      {double(goals[left]), double(goals[right])});
  }
  Frames here() const { return travel({}, angles()).frames(0.0); }
  double separation() const {
    return posed_ ? separation_ : double(state_.configuration.separation);
  }

  // Lets an object that its contacts no longer hold fall to where it rests, while the palms stand
  // still. Returns false, and changes nothing, if it does not fall or would fall too far.
  bool has_fallen() {
    if (!small_fall_) return false;
    const ContactProblem problem{shapes(), double(model_.object.slope), 0.0, false};
    Instant now{problem, here(), pose()};
    const double before = now.pose.at.y;
    const auto height = small_fall_(now, most_fall_);
    if (!height) return false;
    fall_ = {*height, before - now.pose.at.y};
    put({pivot(left), pivot(right)}, angles(), now.pose);
    return true;
  }

  // A whole step: on the two vertices alone and, from a further contact on, on any contacts.
  [[gnu::noinline]] Advance<Real> go(const PerSide<Vec>& by, const PerSide<Real>& goals) {
    Travel step = travel(by, goals);
    const double widens = by[right].x - by[left].x;
    Advance<Real> total{DropReason::none, Real(0), {}, 0};
    bool on_vertices = rests_on_vertices();
    if (!posed_) {
      const bool alone =
          model_.surroundings.empty() && by[left].y == by[right].y && !is_general(model_);
      if (alone) total = GeneralStep<Real>{model_, state_, Real(widens), goals}.run();
      const bool continues =
          goes_on(total.reason) || (total.reason == DropReason::off_palm && may_leave_reach());
      if (alone && !continues) {
        carry_on(by, double(total.fraction));
        return total;
      }
      pose_ = pose_on_vertices(model_, state_, here());
      separation_ = separation();
      posed_ = true;
    }
    ContactProblem problem = this->problem();
    problem.commanded = {by[left].x, by[right].x};
    const double rounding = double(Real(64) * std::numeric_limits<Real>::epsilon()) * shapes().size;
    std::uint32_t seen = ambiguous_.count;
    const auto note = [&](const Instant& now, double t, const ActivePairs& run_off) {
      for (const ActivePair& one : run_off) run_off_.push_back(one.pair);
      if (ambiguous_.count != seen) choices_.push_back({t, regime_});
      seen = ambiguous_.count;
      const bool before = std::exchange(on_vertices, rests_on_vertices());
      if (!before && on_vertices) contact_events_.ended = Real(t);
      if (!before || on_vertices) return;
      if (const auto one = first_further(now, regime_))
        contact_events_ = {contact_events_.count + 1, one->kind, one->side, Real(t), Real(t)};
    };
    ContactStep contact_step(problem, step, pose_, regime_, around_, ambiguous_, rounding, note);
    const Advance<double> done = contact_step.run(double(total.fraction));
    total = {done.reason, Real(done.fraction), motion_on_palms(regime_),
             total.segments + done.segments};
    carry_on(by, done.fraction);
    if (is_limited()) {
      total.lag = {Real(done.lag[left]), Real(done.lag[right])};
      total.stalled = done.stalled;
      middle_ += 0.5 * (done.lag[left] + done.lag[right]);
      for (const std::size_t side : {left, right}) step.palms[side].pivot.x += done.lag[side];
    }
    place(step.frames(done.fraction));
    // Rounded contacts that both slide go on in this way.
    const bool both_slide = rolls(model_) && regime_.unknown_forces() == 2;
    if (on_vertices && !both_slide && !is_general(model_) && model_.surroundings.empty() &&
        height_[left] == height_[right] && !(may_leave_reach() && is_beyond_reach())) {
      regime_ = {};
      posed_ = false;
    }
    return total;
  }

  // Moves midpoint and heights of the pivots by a part of a step; the separation is set elsewhere.
  void carry_on(const PerSide<Vec>& by, double done) {
    middle_ += 0.5 * done * (by[left].x + by[right].x);
    for (const std::size_t side : {left, right}) height_[side] += done * by[side].y;
  }

  // The moving state at an instant of a step, from the pose.
  void place(const Frames& frames) {
    separation_ = frames[right].origin.x - frames[left].origin.x;
    const PerSide<bool> held{regime_.has(shapes().own[left]), regime_.has(shapes().own[right])};
    const Real slack = Real(64) * std::numeric_limits<Real>::epsilon() * Real(shapes().size);
    place_vertices(model_, frames, pose_, held, slack, state_);
  }

  bool rests_on_vertices() const {
    if (!posed_) return true;
    return regime_.active.size() == 2 && regime_.has(shapes().own[left]) &&
           regime_.has(shapes().own[right]);
  }

  Model<Real> model_{};
  mutable std::optional<ContactShapes> shapes_;
  CarryPhase phase_ = CarryPhase::carried;
  double most_fall_ = 0.0;  // [m]
  // Set only where something may fall, so that other programs need not contain the code.
  std::optional<double> (*small_fall_)(Instant&, double) = nullptr;
  std::optional<Fall> fall_;
  double middle_ = 0.0;       // of the pivots, along the floor [m]
  PerSide<double> height_{};  // of the pivots [m]
  bool posed_ = false;        // whether the object may rest on more than its two contact vertices
  Regime regime_;             // valid if `posed_`
  Pose pose_{};               // valid if `posed_`
  Neighbourhood around_;
  AmbiguousEvents ambiguous_{};
  std::vector<AmbiguousChoice> choices_;
  std::vector<FeaturePair> run_off_;
  double separation_ = 0;  // valid if `posed_`; unlike the configuration's, not rounded to Real
  WorldState<Real> state_{};
  Advance<Real> last_{};
  ContactEventCounter<Real> contact_events_{};
};

}  // namespace palmbots
