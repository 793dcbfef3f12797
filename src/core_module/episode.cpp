// SPDX-License-Identifier: Apache-2.0
// Carries whose robots are commanded from outside tick by tick: of the quasistatic world, and
// co-simulated.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <memory>
#include <variant>

#include "carry.hpp"
#include "palmbots/control/external.hpp"
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

// From the next command on, a robot stops travelling, or travels.
void set_stops(PerSide<ExternalCommand>& commands, bool l, bool r) {
  commands[left].command.stop = l;
  commands[right].command.stop = r;
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

class Episode {
 public:
  Episode(const Spec& spec, std::uint64_t seed, bool record) {
    if (record) {
      with_.emplace<Begun<TraceRecorder>>(spec, seed, commands_);
    } else {
      with_.emplace<Begun<NoRecorder>>(spec, seed, commands_);
    }
  }
  Episode(const Episode&) = delete;  // the controllers know where the commands lie
  Episode& operator=(const Episode&) = delete;

  template <class Visit>
  auto visit(Visit&& what) {
    return with_.index() == 1 ? what(std::get<1>(with_)) : what(std::get<2>(with_));
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

  void stop(bool l, bool r) { set_stops(commands_, l, r); }

  std::pair<Seen, Seen> seen() {
    return visit([&](auto& begun) { return seen_of(begun.carry); });
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
  std::variant<std::monostate, Begun<NoRecorder>, Begun<TraceRecorder>> with_;
};

class ExternalCoSimulation {
 public:
  ExternalCoSimulation(const Spec& spec, std::uint64_t seed, const WorldObservation& first,
                       double slack)
      : cosimulation_(spec, seed, team_of(spec, seed, commands_), slack, first) {}
  ExternalCoSimulation(const ExternalCoSimulation&) = delete;
  ExternalCoSimulation& operator=(const ExternalCoSimulation&) = delete;

  PerSide<ExternalCommand>& commands() { return commands_; }
  CoSimulation<RobotTeam<ExternalController>>& cosimulation() { return cosimulation_; }
  bool done() const { return cosimulation_.done(); }
  std::pair<Seen, Seen> seen() const { return seen_of(cosimulation_); }

 private:
  PerSide<ExternalCommand> commands_{};
  CoSimulation<RobotTeam<ExternalController>> cosimulation_;
};

}  // namespace

void bind_episode(nb::module_& m) {
  nb::class_<Episode>(m, "Episode",
                      "A carry in the quasistatic world whose robots are commanded from outside.")
      .def(nb::init<const Spec&, std::uint64_t, bool>(), nb::arg("spec"), nb::arg("seed"),
           nb::arg("record") = false)
      .def_prop_ro(
          "outcome",
          [](Episode& e) { return e.visit([](auto& b) { return outcome_of(b.carry.metrics()); }); },
          "running, delivered, dropped or stalled.")
      .def_prop_ro("ticks",
                   [](Episode& e) { return e.visit([](auto& b) { return b.carry.ticks(); }); })
      .def_prop_ro("contacts",
                   [](Episode& e) {
                     return e.visit([](auto& b) {
                       const auto& p = b.carry.world().configuration().contacts;
                       return Two{p[left], p[right]};
                     });
                   })
      .def_prop_ro("lift",
                   [](Episode& e) {
                     return e.visit([](auto& b) {
                       const auto& y = b.carry.world().configuration().lift;
                       return Two{y[left], y[right]};
                     });
                   })
      .def_prop_ro("palms",
                   [](Episode& e) {
                     return e.visit([](auto& b) {
                       const auto& palms = b.carry.world().configuration().palms;
                       return Two{palms[left].angle, palms[right].angle};
                     });
                   })
      .def_prop_ro(
          "motion",
          [](Episode& e) {
            return e.visit([](auto& b) {
              const ContactMode motion = b.carry.world().last().motion;
              return std::pair(static_cast<int>(motion[left]), static_cast<int>(motion[right]));
            });
          },
          "Over the last tick: contacts slide down -1, stick 0, slide up +1.")
      .def_prop_ro(
          "separation",
          [](Episode& e) {
            return e.visit([](auto& b) { return b.carry.world().configuration().separation; });
          })
      .def_prop_ro(
          "rise",
          [](Episode& e) {
            return e.visit([](auto& b) { return b.carry.world().contact_vector().dy; });
          },
          "Of the right contact vertex over the left one [m].")
      .def_prop_ro("midpoint",
                   [](Episode& e) { return e.visit([](auto& b) { return b.carry.midpoint(); }); })
      .def_prop_ro(
          "sent",
          [](Episode& e) {
            return e.visit([](auto& b) { return b.carry.team().link_totals.sent; });
          },
          "Messages so far.")
      .def("observations", &Episode::seen,
           "Of each robot (sign, palm turned, message that is there, program runs, it has just "
           "begun "
           "anew) in the tick to come.")
      .def("step", &Episode::step, nb::arg("left"), nb::arg("right"), nb::arg("ticks") = 1,
           "So many ticks with (palm, move, message to send) of each robot. What is there to be "
           "read is read in the first of them, in which messages go out too. Returns (outcome, "
           "ticks "
           "and messages so far, midpoint [m], contacts [m]).")
      .def("stop", &Episode::stop, nb::arg("left"), nb::arg("right"),
           "Whether each robot rests, from the next step on, until it is called again.")
      .def("run", &Episode::run, "What became of it; takes the trace with it.");

  nb::class_<ExternalCoSimulation>(m, "ExternalCoSimulation",
                                   "A co-simulation whose robots are commanded from outside.")
      .def(nb::init<const Spec&, std::uint64_t, const WorldObservation&, double>(), nb::arg("spec"),
           nb::arg("seed"), nb::arg("first"), nb::arg("slack") = 0.0)
      .def_prop_ro("done", &ExternalCoSimulation::done)
      .def_prop_ro("outcome",
                   [](ExternalCoSimulation& c) { return outcome_of(c.cosimulation().metrics()); })
      .def_prop_ro("ticks", [](ExternalCoSimulation& c) { return c.cosimulation().ticks(); })
      .def_prop_ro("sent",
                   [](ExternalCoSimulation& c) { return c.cosimulation().team().link_totals.sent; })
      .def("observations", &ExternalCoSimulation::seen)
      .def(
          "set_commands",
          [](ExternalCoSimulation& c, const Do& l, const Do& r) { give(c.commands(), l, r); },
          nb::arg("left"), nb::arg("right"),
          "(palm, move, message to send) of each robot, from the next command on.")
      .def(
          "stop", [](ExternalCoSimulation& c, bool l, bool r) { set_stops(c.commands(), l, r); },
          nb::arg("left"), nb::arg("right"),
          "Whether each robot rests, from the next command on, until it is called again.")
      .def(
          "step_controllers",
          [](ExternalCoSimulation& c) {
            if (c.done()) throw std::runtime_error("the carry is over");
            const Actuation<double> act = c.cosimulation().step_controllers();
            go_on(c.commands());
            const PerSide<double>& v = c.cosimulation().speeds();
            return std::pair(Two{v[left], v[right]}, Two{act.angles[left], act.angles[right]});
          },
          "(Speeds [m/s] towards +x, palm angles [rad] at the end of the tick.)")
      .def(
          "observe",
          [](ExternalCoSimulation& c, const WorldObservation& observation) {
            c.cosimulation().observe(observation);
          },
          nb::arg("sight"))
      .def(
          "run",
          [](ExternalCoSimulation& c) {
            Run run = run_of(c.cosimulation());
            run.hash = c.cosimulation().recorder().hash();
            run.rows = c.cosimulation().recorder().take_rows();
            run.sent_messages = c.cosimulation().recorder().take_sent_messages();
            return run;
          },
          "What became of it; takes the trace with it.");
}

}  // namespace palmbots::bindings
