// What a finished carry gave, and controllers written in Python: for both ways to run a carry.
#pragma once

#include <nanobind/stl/tuple.h>

#include <vector>

#include "bindings.hpp"
#include "palmbots/recorder.hpp"

namespace palmbots::bindings {

// A controller written in Python: an object with
//   step(sign, letter, turned) -> (palm, move, letter sent, letter read, case, waits).
class PythonController {
 public:
  explicit PythonController(nb::object step) : step_(std::move(step)) {}

  Distributed::Output step(Distributed::Input in) {
    const nb::object answer =
        step_(static_cast<int>(in.sign), static_cast<int>(in.letter), in.turned);
    const auto [palm, move, send, read, name, waits] =
        nb::cast<std::tuple<int, int, int, bool, int, bool>>(answer);
    now_ = {static_cast<char>(name),
            {static_cast<Palm>(palm), static_cast<Move>(move)},
            waits,
            Letter::none};
    return {now_.command, static_cast<Letter>(send), read};
  }
  const Distributed::Doing& now() const { return now_; }

 private:
  nb::object step_;
  Distributed::Doing now_ = Distributed::doing[0];
};

// What a carry gave, in seconds and metres.
struct Run {
  Metrics metrics;
  double period = 0;
  double distance = 0;
  Traffic traffic;
  PerSide<Letter> awaits{};
  PerSide<bool> rests{};  // at the end
  std::uint64_t hash = 0;
  std::vector<Row> rows;
  std::vector<Posted> posted;
};

// A carry (or a crew) that is over; what its recorder kept is not in it yet.
template <class Carry>
Run run_of(const Carry& carry) {
  Run run;
  run.metrics = carry.metrics();
  run.period = carry.spec().period;
  run.distance = double(carry.midpoint()) * carry.spec().direction;
  run.traffic = carry.team().traffic;
  for (const std::size_t side : {left, right}) {
    run.awaits[side] = carry.team().awaits(side);
    run.rests[side] = carry.commands()[side].rest;
  }
  return run;
}

}  // namespace palmbots::bindings
