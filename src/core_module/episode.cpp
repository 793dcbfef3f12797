// SPDX-License-Identifier: Apache-2.0
// Carries whose robots are commanded from outside tick by tick: in the quasistatic world, or in a
// world outside the core.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <memory>
#include <variant>

#include "carry.hpp"
#include "palmbots/control/external.hpp"
#include "palmbots/sim/commanded_lift.hpp"
#include "palmbots/sim/cosimulation.hpp"

namespace palmbots::bindings {

namespace {

// (sign, palm turned, message that is there, program runs, it has just begun anew) of a robot in
// the tick to come.
using Seen = std::tuple<int, bool, int, bool, bool>;
// (outcome, ticks and messages so far, midpoint [m], contacts [m]).
using Now =
    std::tuple<const char*, std::uint32_t, std::uint32_t, double, std::pair<double, double>>;
// (palm, move, message to send) of a robot.
using Do = std::tuple<int, int, int>;
using Two = std::pair<double, double>;

// Sends and reads in the first tick only.
void give(PerSide<ExternalCommand>& commands, const Do& l, const Do& r) {
  const Do* both[2] = {&l, &r};
  for (const std::size_t side : {left, right}) {
    const auto [palm, move, send] = *both[side];
    if (palm < 0 || palm > 1 || move < 0 || move > 2 || send < 0 || send > 3) {
      throw std::out_of_range("palm is 0 or 1; move is 0 to 2; message is 0 to 3");
    }
    const bool stop = commands[side].command.stop;
    commands[side] = {{static_cast<Palm>(palm), static_cast<Move>(move), stop},
                      static_cast<MessageKind>(send),
                      true};
  }
}

void go_on(PerSide<ExternalCommand>& commands) {
  for (ExternalCommand& command : commands) {
    command.send = MessageKind::none;
    command.read = false;
  }
}

const char* outcome_of(const Metrics& metrics) { return name_of(metrics.outcome); }

RobotTeam<ExternalController> team_of(const Spec& spec, std::uint64_t seed,
                                      const PerSide<ExternalCommand>& commands) {
  return robot_team_of<ExternalController>(
      {ExternalController(&commands[left]), ExternalController(&commands[right])}, spec, seed);
}

template <class Carry>
WorldObservation sight_of(const Carry& carry) {
  const auto& at = carry.world().configuration();
  WorldObservation sight;
  for (const std::size_t side : {left, right}) {
    sight.contacts[side] = sight.touched[side] = at.contacts[side];
    sight.lift[side] = at.lift[side];
    sight.palms[side] = sight.wrists[side] = at.palms[side].angle;
    sight.motion[side] = static_cast<int>(carry.world().last().motion[side]);
  }
  sight.separation = at.separation;
  sight.midpoint = carry.midpoint();
  sight.rise = carry.world().contact_vector().dy;
  sight.turn = carry.world().tilt(carry.spec().width);
  return sight;
}

// What both robots see in the tick to come.
template <class Carry>
std::pair<Seen, Seen> seen_of(const Carry& carry) {
  const PerSide<RobotObservation> sensed = carry.sense();
  const auto one = [&](std::size_t side) {
    return Seen{static_cast<int>(sensed[side].sign), sensed[side].palm_at_target,
                static_cast<int>(carry.team().message(carry.ticks(), side)),
                carry.team().is_on(carry.ticks(), side), carry.team().boots(carry.ticks(), side)};
  };
  return {one(left), one(right)};
}

// A carry in the quasistatic world that has begun its next tick, or is over.
template <class Recorder>
struct Begun {
  Carry<double, RobotTeam<ExternalController>, Recorder> carry;

  Begun(const Spec& spec, std::uint64_t seed, const PerSide<ExternalCommand>& commands)
      : carry(spec, seed, team_of(spec, seed, commands), Recorder{}) {
    carry.begin();
    open();
  }
  bool done() const { return carry.metrics().outcome != Outcome::running; }
  void tick() {
    carry.recorder().make_room();
    carry.act(carry.sense());
    open();
  }

 private:
  void open() {
    if (!done()) carry.open();
    if (done()) {
      carry.recorder().make_room();
      carry.recorder().end(carry);
    }
  }
};

// A carry in a world outside the core: a Python object with `move` and `sight`.
struct Outside {
  nb::object world;
  CoSimulation<RobotTeam<ExternalController>> carry;

  Outside(const Spec& spec, std::uint64_t seed, const PerSide<ExternalCommand>& commands,
          nb::object moved, double slack)
      : world(std::move(moved)),
        carry(spec, seed, team_of(spec, seed, commands), slack,
              nb::cast<WorldObservation>(world.attr("sight")(true))) {}
  bool done() const { return carry.done(); }
  void tick() {
    const Actuation<double> act = carry.step_controllers();
    const PerSide<double>& v = carry.speeds();
    world.attr("move")(Two{v[left], v[right]}, Two{act.angles[left], act.angles[right]});
    carry.observe(nb::cast<WorldObservation>(world.attr("sight")()));
  }
};

class Episode {
 public:
  Episode(const Spec& spec, std::uint64_t seed, bool record, nb::object world, double slack) {
    if (!world.is_none()) {
      with_.emplace<Outside>(spec, seed, commands_, std::move(world), slack);
    } else if (record) {
      with_.emplace<Begun<TraceRecorder>>(spec, seed, commands_);
    } else {
      with_.emplace<Begun<NoRecorder>>(spec, seed, commands_);
    }
  }
  Episode(const Episode&) = delete;  // the controllers know where the commands lie
  Episode& operator=(const Episode&) = delete;

  template <class Visit>
  auto visit(Visit&& what) {
    switch (with_.index()) {
      case 1: return what(std::get<1>(with_));
      case 2: return what(std::get<2>(with_));
      default: return what(std::get<3>(with_));
    }
  }

  Now step(const Do& l, const Do& r, int ticks) {
    give(commands_, l, r);
    return visit([&](auto& begun) {
      if (begun.done()) throw std::runtime_error("the carry is over");
      for (int k = 0; k < ticks && !begun.done(); ++k) {
        begun.tick();
        go_on(commands_);
      }
      const auto& carry = begun.carry;
      const auto& p = carry.world().configuration().contacts;
      return Now{outcome_of(carry.metrics()),
                 carry.ticks(),
                 carry.team().link_totals.sent,
                 carry.midpoint(),
                 {p[left], p[right]}};
    });
  }

  // From the next step on, a robot stops travelling, or travels.
  void stop(bool l, bool r) {
    commands_[left].command.stop = l;
    commands_[right].command.stop = r;
  }

  Run run() {
    return visit([](auto& begun) {
      Run run = run_of(begun.carry);
      if constexpr (requires { begun.carry.recorder().take_rows(); }) {
        run.hash = begun.carry.recorder().hash();
        run.rows = begun.carry.recorder().take_rows();
        run.sent_messages = begun.carry.recorder().take_sent_messages();
      }
      return run;
    });
  }

 private:
  PerSide<ExternalCommand> commands_{};
  std::variant<std::monostate, Begun<NoRecorder>, Begun<TraceRecorder>, Outside> with_;
};

// (sign, palm turned, travelled [m], touches, arm, arm there, arm steps, beneath) of a robot.
using Feels = std::tuple<int, bool, double, bool, int, bool, int, bool>;
// (palm, move, stop, arm, state of the table) of a robot. State −1: as before.
using Does = std::tuple<int, int, bool, int, int>;

// A job on the floor in the quasistatic world, commanded from outside.
class FloorEpisode {
 public:
  FloorEpisode(const Spec& spec, std::uint64_t seed) {
    with_job_table(spec, [&]<class Table>(Table) { begin<Table>(spec, seed); });
  }
  FloorEpisode(const FloorEpisode&) = delete;  // the team knows where the commands lie
  FloorEpisode& operator=(const FloorEpisode&) = delete;

  template <class Visit>
  auto visit(Visit&& what) {
    switch (job_.index()) {
      case 1: return what(*std::get<1>(job_));
      case 2: return what(*std::get<2>(job_));
      default: return what(*std::get<3>(job_));
    }
  }

  std::pair<Feels, Feels> seen() {
    return visit([&](auto& job) {
      const PerSide<RobotObservation> sensed = job.sense();
      const auto one = [&](std::size_t side) {
        const LiftSenses& senses = job.team().senses()[side];
        return Feels{static_cast<int>(sensed[side].sign),
                     sensed[side].palm_at_target,
                     job.travelled()[side],
                     senses.touches,
                     static_cast<int>(commands_[side].arm),
                     senses.arm_there,
                     senses.steps,
                     senses.beneath};
      };
      return std::pair(one(left), one(right));
    });
  }

  void step(const Does& l, const Does& r) {
    visit([&](auto& job) {
      using Table = std::remove_reference_t<decltype(job)>::TheTable;
      if (job.done()) throw std::runtime_error("the job is over");
      const Does* both[2] = {&l, &r};
      for (const std::size_t side : {left, right}) {
        const auto [palm, move, stop, arm, state] = *both[side];
        if (palm < 0 || palm > 1 || move < 0 || move > 2 || arm < 0 || arm > 4 || state < -1 ||
            state >= Table::states)
          throw std::out_of_range(
              "palm is 0 or 1; move is 0 to 2; arm is 0 to 4; state is one of the table, or -1");
        commands_[side] = {{static_cast<Palm>(palm), static_cast<Move>(move), stop},
                           static_cast<ArmMove>(arm),
                           state < 0 ? commands_[side].state : state};
      }
      job.recorder().make_room();
      job.tick();
    });
  }

 private:
  template <class Table>
  using Job = LiftCarry<CommandedLift, TraceRecorder, Table>;

  template <class Table>
  void begin(const Spec& spec, std::uint64_t seed) {
    const bool low = spec.begins_on != StandsOn::palms;
    for (const std::size_t side : {left, right}) {
      if (low) commands_[side].arm = ArmMove::follow;
      commands_[side].state = static_cast<int>(Table::first(low, stands_by(spec, side)));
    }
    const CommandedLift commanded{&commands_};
    job_ = std::make_unique<Job<Table>>(spec, seed, commanded, false);
    visit([](auto& job) { job.begin(); });
  }

  PerSide<LiftCommand> commands_{};
  std::variant<std::monostate, std::unique_ptr<Job<Lifting>>, std::unique_ptr<Job<Lone>>,
               std::unique_ptr<Job<HandOver>>>
      job_;
};

}  // namespace

void bind_episode(nb::module_& m) {
  const auto of_job = [](auto what) { return [what](FloorEpisode& e) { return e.visit(what); }; };
  nb::class_<FloorEpisode>(m, "FloorEpisode",
                           "A job on the floor whose robots are commanded from outside.")
      .def(nb::init<const Spec&, std::uint64_t>(), nb::arg("spec"), nb::arg("seed"))
      .def_prop_ro("outcome", of_job([](auto& job) { return outcome_of(job.metrics()); }))
      .def_prop_ro("reason", of_job([](auto& job) -> nb::object {
                     const DropReason reason = job.metrics().reason;
                     if (reason == DropReason::none) return nb::none();
                     return nb::str(name_of(reason));
                   }))
      .def_prop_ro("midpoint", of_job([](auto& job) { return double(job.midpoint()); }),
                   "Displacement of the midpoint of the robots [m].")
      .def_prop_ro("moved", of_job([](auto& job) { return job.moved(); }),
                   "Displacement of the COM [m].")
      .def_prop_ro("stands", of_job([](auto& job) { return job.stands(); }),
                   "Whether the object is on the floor or on a stand alone.")
      .def_prop_ro("contacts", of_job([](auto& job) {
                     const auto& p = job.world().configuration().contacts;
                     return std::pair(p[left], p[right]);
                   }))
      .def_prop_ro("heights", of_job([](auto& job) {
                     return std::pair(job.heights()[left], job.heights()[right]);
                   }),
                   "Heights of the pivots, as commanded [m].")
      .def_prop_ro("travelled", of_job([](auto& job) {
                     return std::pair(job.travelled()[left], job.travelled()[right]);
                   }),
                   "What each robot has moved while it carried [m].")
      .def_prop_ro("states", of_job([](auto& job) {
                     return std::remove_reference_t<decltype(job)>::TheTable::states;
                   }),
                   "How many states the table of the job has.")
      .def_prop_ro("seen", &FloorEpisode::seen,
                   "Of each robot (sign, palm turned, travelled [m], touches, what the arm does, "
                   "arm there, arm steps, beneath).")
      .def("step", &FloorEpisode::step, nb::arg("left"), nb::arg("right"),
           "One tick with (palm, move, stop, arm, state of the table) of each robot; state -1: as "
           "before.");
  nb::class_<Episode>(m, "Episode", "A carry whose robots are commanded from outside.")
      .def(nb::init<const Spec&, std::uint64_t, bool, nb::object, double>(), nb::arg("spec"),
           nb::arg("seed"), nb::arg("record") = false, nb::arg("world") = nb::none(),
           nb::arg("slack") = 0.0,
           "world: what moves the object, with move(speeds, palm angles) and sight(first); None: "
           "the quasistatic world. slack: how far from the angle commanded [rad] a wrist counts as "
           "turned.")
      .def_prop_ro(
          "outcome",
          [](Episode& e) { return e.visit([](auto& b) { return outcome_of(b.carry.metrics()); }); },
          "running, delivered, dropped or stalled.")
      .def_prop_ro("ticks",
                   [](Episode& e) { return e.visit([](auto& b) { return b.carry.ticks(); }); })
      .def_prop_ro(
          "sent",
          [](Episode& e) {
            return e.visit([](auto& b) { return b.carry.team().link_totals.sent; });
          },
          "Messages so far.")
      .def(
          "sight", [](Episode& e) { return e.visit([](auto& b) { return sight_of(b.carry); }); },
          "The present state of the world.")
      .def(
          "seen", [](Episode& e) { return e.visit([](auto& b) { return seen_of(b.carry); }); },
          "Of each robot (sign, palm turned, message that is there, program runs, it has just "
          "begun "
          "anew) in the tick to come.")
      .def("step", &Episode::step, nb::arg("left"), nb::arg("right"), nb::arg("ticks") = 1,
           "So many ticks with (palm, move, message to send) of each robot. What is there to be "
           "read is read in the first of them, in which messages go out too. Returns (outcome, "
           "ticks and messages so far, midpoint [m], contacts [m]).")
      .def("stop", &Episode::stop, nb::arg("left"), nb::arg("right"),
           "Whether each robot rests, from the next step on, until it is called again.")
      .def("run", &Episode::run, "What became of it; takes the trace with it.");
}

}  // namespace palmbots::bindings
