// Carries whose robots are told what to do tick by tick: of the quasistatic world, and of a crew.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <memory>
#include <variant>

#include "palmbots/crew.hpp"
#include "palmbots/told.hpp"
#include "run.hpp"

namespace palmbots::bindings {

namespace {

// (sign, palm turned, letter that is there, program runs, it has just begun anew) of a robot in the tick
// to come.
using Seen = std::tuple<int, bool, int, bool, bool>;
// (outcome, ticks and letters so far, midpoint [m], contacts [m]).
using Now =
    std::tuple<const char*, std::uint32_t, std::uint32_t, double, std::pair<double, double>>;
// (palm, move, letter to send) of a robot.
using Do = std::tuple<int, int, int>;
using Two = std::pair<double, double>;

// Sends and reads in the first tick only.
void give(PerSide<Order>& orders, const Do& l, const Do& r) {
  const Do* both[2] = {&l, &r};
  for (const std::size_t side : {left, right}) {
    const auto [palm, move, send] = *both[side];
    if (palm < 0 || palm > 1 || move < 0 || move > 2 || send < 0 || send > 3) {
      throw std::out_of_range("palm is 0 or 1; move is 0 to 2; letter is 0 to 3");
    }
    orders[side] = {
        {static_cast<Palm>(palm), static_cast<Move>(move)}, static_cast<Letter>(send), true};
  }
}

void go_on(PerSide<Order>& orders) {
  for (Order& order : orders) {
    order.send = Letter::none;
    order.read = false;
  }
}

const char* outcome_of(const Metrics& metrics) {
  return result_names[static_cast<int>(metrics.outcome)];
}

Pair<Told> team_of(const Spec& spec, std::uint64_t seed, const PerSide<Order>& orders) {
  return {{Told(&orders[left]), Told(&orders[right])},
          channel_of(spec),
          seed,
          leader_of(spec),
          Faults::of(spec, seed)};
}

// What both robots see in the tick to come.
template <class Carry>
std::pair<Seen, Seen> seen_of(const Carry& carry) {
  const PerSide<Sensed> sensed = carry.sense();
  const auto one = [&](std::size_t side) {
    return Seen{static_cast<int>(sensed[side].sign), sensed[side].turned,
                static_cast<int>(carry.team().letter(carry.ticks(), side)),
                carry.team().is_on(carry.ticks(), side), carry.team().boots(carry.ticks(), side)};
  };
  return {one(left), one(right)};
}

// A carry in the quasistatic world that has begun its next tick, or is over.
template <class Recorder>
struct Begun {
  Carry<double, Pair<Told>, Recorder> carry;

  Begun(const Spec& spec, std::uint64_t seed, const PerSide<Order>& orders)
      : carry(spec, seed, team_of(spec, seed, orders), Recorder{}) {
    carry.begin();
    open();
  }
  bool done() const { return carry.metrics().outcome != Result::running; }
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
      with_.emplace<Begun<TraceRecorder>>(spec, seed, orders_);
    } else {
      with_.emplace<Begun<NoRecorder>>(spec, seed, orders_);
    }
  }
  Episode(const Episode&) = delete;  // the controllers know where the orders lie
  Episode& operator=(const Episode&) = delete;

  template <class Visit>
  auto visit(Visit&& what) {
    return with_.index() == 1 ? what(std::get<1>(with_)) : what(std::get<2>(with_));
  }

  Now step(const Do& l, const Do& r, int ticks) {
    give(orders_, l, r);
    return visit([&](auto& begun) {
      if (begun.done()) throw std::runtime_error("the carry is over");
      for (int k = 0; k < ticks && !begun.done(); ++k) {
        begun.tick();
        go_on(orders_);
      }
      const auto& carry = begun.carry;
      const auto& p = carry.world().stance().contacts;
      return Now{outcome_of(carry.metrics()),
                 carry.ticks(),
                 carry.team().traffic.sent,
                 carry.midpoint(),
                 {p[left], p[right]}};
    });
  }

  std::pair<Seen, Seen> seen() {
    return visit([&](auto& begun) { return seen_of(begun.carry); });
  }

  Run run() {
    return visit([](auto& begun) {
      Run run = run_of(begun.carry);
      if constexpr (requires { begun.carry.recorder().take_rows(); }) {
        run.hash = begun.carry.recorder().hash();
        run.rows = begun.carry.recorder().take_rows();
        run.posted = begun.carry.recorder().take_posted();
      }
      return run;
    });
  }

 private:
  PerSide<Order> orders_{};
  std::variant<std::monostate, Begun<NoRecorder>, Begun<TraceRecorder>> with_;
};

class ToldCrew {
 public:
  ToldCrew(const Spec& spec, std::uint64_t seed, const Sight& first, double slack)
      : crew_(spec, seed, team_of(spec, seed, orders_), slack, first) {}
  ToldCrew(const ToldCrew&) = delete;
  ToldCrew& operator=(const ToldCrew&) = delete;

  PerSide<Order>& orders() { return orders_; }
  Crew<Pair<Told>>& crew() { return crew_; }
  bool done() const { return crew_.done(); }
  std::pair<Seen, Seen> seen() const { return seen_of(crew_); }

 private:
  PerSide<Order> orders_{};
  Crew<Pair<Told>> crew_;
};

}  // namespace

void bind_episode(nb::module_& m) {
  nb::class_<Episode>(m, "Episode",
                      "A carry in the quasistatic world whose robots are told what to do.")
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
                       const auto& p = b.carry.world().stance().contacts;
                       return Two{p[left], p[right]};
                     });
                   })
      .def_prop_ro("lift",
                   [](Episode& e) {
                     return e.visit([](auto& b) {
                       const auto& y = b.carry.world().stance().lift;
                       return Two{y[left], y[right]};
                     });
                   })
      .def_prop_ro("palms",
                   [](Episode& e) {
                     return e.visit([](auto& b) {
                       const auto& palms = b.carry.world().stance().palms;
                       return Two{palms[left].angle, palms[right].angle};
                     });
                   })
      .def_prop_ro(
          "motion",
          [](Episode& e) {
            return e.visit([](auto& b) {
              const Mode motion = b.carry.world().last().motion;
              return std::pair(static_cast<int>(motion[left]), static_cast<int>(motion[right]));
            });
          },
          "Over the last tick: contacts slide down -1, stick 0, slide up +1.")
      .def_prop_ro("separation",
                   [](Episode& e) {
                     return e.visit([](auto& b) { return b.carry.world().stance().separation; });
                   })
      .def_prop_ro(
          "rise",
          [](Episode& e) { return e.visit([](auto& b) { return b.carry.world().span().dy; }); },
          "Of the right contact vertex over the left one [m].")
      .def_prop_ro("midpoint",
                   [](Episode& e) { return e.visit([](auto& b) { return b.carry.midpoint(); }); })
      .def_prop_ro(
          "sent",
          [](Episode& e) { return e.visit([](auto& b) { return b.carry.team().traffic.sent; }); },
          "Letters so far.")
      .def(
          "seen", &Episode::seen,
          "Of each robot (sign, palm turned, letter that is there, program runs, it has just begun "
          "anew) in the tick to come.")
      .def(
          "step", &Episode::step, nb::arg("left"), nb::arg("right"), nb::arg("ticks") = 1,
          "So many ticks with (palm, move, letter to send) of each robot. What is there to be "
          "read is read in the first of them, in which letters go out too. Returns (outcome, ticks "
          "and letters so far, midpoint [m], contacts [m]).")
      .def("run", &Episode::run, "What became of it; takes the trace with it.");

  nb::class_<ToldCrew>(m, "ToldCrew", "A crew whose robots are told what to do.")
      .def(nb::init<const Spec&, std::uint64_t, const Sight&, double>(), nb::arg("spec"),
           nb::arg("seed"), nb::arg("first"), nb::arg("slack") = 0.0)
      .def_prop_ro("done", &ToldCrew::done)
      .def_prop_ro("outcome", [](ToldCrew& c) { return outcome_of(c.crew().metrics()); })
      .def_prop_ro("ticks", [](ToldCrew& c) { return c.crew().ticks(); })
      .def_prop_ro("sent", [](ToldCrew& c) { return c.crew().team().traffic.sent; })
      .def("seen", &ToldCrew::seen)
      .def(
          "tell", [](ToldCrew& c, const Do& l, const Do& r) { give(c.orders(), l, r); },
          nb::arg("left"), nb::arg("right"),
          "(palm, move, letter to send) of each robot, from the next command on.")
      .def(
          "command",
          [](ToldCrew& c) {
            if (c.done()) throw std::runtime_error("the carry is over");
            const Actuation<double> act = c.crew().command();
            go_on(c.orders());
            const PerSide<double>& v = c.crew().speeds();
            return std::pair(Two{v[left], v[right]}, Two{act.angles[left], act.angles[right]});
          },
          "(Speeds [m/s] towards +x, palm angles [rad] at the end of the tick.)")
      .def(
          "observe", [](ToldCrew& c, const Sight& sight) { c.crew().observe(sight); },
          nb::arg("sight"))
      .def(
          "run",
          [](ToldCrew& c) {
            Run run = run_of(c.crew());
            run.hash = c.crew().recorder().hash();
            run.rows = c.crew().recorder().take_rows();
            run.posted = c.crew().recorder().take_posted();
            return run;
          },
          "What became of it; takes the trace with it.");
}

}  // namespace palmbots::bindings
