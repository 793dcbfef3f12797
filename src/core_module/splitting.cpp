// SPDX-License-Identifier: Apache-2.0
// Rare drops: carries as the processes of multilevel splitting (sim/multilevel_splitting.hpp).
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "bindings.hpp"
#include "given_team.hpp"
#include "palmbots/sim/multilevel_splitting.hpp"
#include "palmbots/sim/recorder.hpp"

namespace palmbots::bindings {

namespace {

// Lets Ctrl-C end work that lasts for many seconds. Of the threads that share this object, the one
// that Python called looks for signals; the others stop when it has found one.
class Interruption {
 public:
  struct Stop {};  // thrown in the other threads

  // To be called in every tick.
  void poll() {
    static thread_local std::uint32_t ticks = 0;
    if (++ticks % ticks_between_looks == 0) look();
  }

  // Raises the Python exception of a signal handler.
  void look() {
    if (stop_.load(std::memory_order_relaxed)) throw Stop{};
    if (std::this_thread::get_id() != caller_) return;
    const nb::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) {
      stop_.store(true, std::memory_order_relaxed);
      throw nb::python_error();
    }
  }

 private:
  static constexpr std::uint32_t ticks_between_looks = 1U << 14;  // some milliseconds
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> stop_ = false;
};

// A carry whose top is to be dropped. Its height is how far out a contact is, 1 at the end of its
// palm.
template <class Team>
class Climb {
 public:
  Climb(const Spec& spec, std::uint64_t seed, Team team, Interruption& interruption)
      : carry_(spec, seed, std::move(team), NoRecorder{}), interruption_(&interruption) {
    carry_.begin();
  }

  RunStatus step() {
    interruption_->poll();
    carry_.tick();
    switch (carry_.metrics().outcome) {
      case Outcome::running: return RunStatus::running;
      case Outcome::dropped: return RunStatus::hit;
      default: return RunStatus::finished;
    }
  }

  double height() const {
    const auto& world = carry_.world();
    const PerSide<double> at = world.touched();
    double highest = 0;
    for (const std::size_t side : {left, right}) {
      highest = std::max(highest, std::abs(at[side]) / world.model().reach[side]);
    }
    return highest;
  }

  void fork(std::uint64_t seed) { carry_.fork(seed); }

 private:
  Carry<double, Team, NoRecorder> carry_;
  Interruption* interruption_;
};

// A controller: its name, or its machines, which the caller holds.
struct Controller {
  explicit Controller(const nb::object& given) {
    if (nb::isinstance<Machines>(given)) {
      machines = &nb::cast<const Machines&>(given);
    } else {
      name = nb::cast<std::string>(given);
      check_name(name);
    }
  }
  std::string name;
  const Machines* machines = nullptr;
};

// Calls visit(splitting) with the splitting of a controller's carries.
template <class Visit>
auto with_splitting(const Spec& spec, const Controller& controller, std::uint64_t seed,
                    std::uint32_t effort, Interruption& interruption, Visit&& visit) {
  if (effort < 2) throw std::invalid_argument("effort: at least 2");
  const auto split = [&](auto make) {
    using Team = decltype(make(spec, seed));
    const auto start = [&spec, &interruption, make](std::uint64_t own) {
      return Climb<Team>(spec, own, make(spec, own), interruption);
    };
    return visit(Splitting<Climb<Team>, decltype(start)>(start, seed, effort));
  };
  if (controller.machines != nullptr) {
    return split([machines = controller.machines](const Spec& of, std::uint64_t own) {
      return machine_team(*machines, of, own);
    });
  }
  return visit_team(controller.name, split);
}

// The levels, and the ticks that finding them took.
std::pair<std::vector<double>, std::uint64_t> choose_levels(const Spec& spec,
                                                            const nb::object& given,
                                                            std::uint64_t seed,
                                                            std::uint32_t effort, double share,
                                                            std::uint64_t most) {
  const Controller controller(given);
  const nb::gil_scoped_release release;
  Interruption interruption;
  return with_splitting(spec, controller, seed, effort, interruption, [&](auto splitting) {
    std::vector<double> levels = splitting.choose_levels(share, most);
    return std::pair(std::move(levels), splitting.steps());
  });
}

// Replicates `first` to `first + count`: of each and each stage (reached, hits), and the ticks of
// all.
nb::tuple replicates(const Spec& spec, const nb::object& given, std::uint64_t seed,
                     std::uint32_t effort, const std::vector<double>& levels, std::uint32_t first,
                     std::uint32_t count, std::uint32_t threads) {
  const Controller controller(given);
  std::vector<std::vector<Stage>> found(count);
  std::atomic<std::uint32_t> next = 0;
  std::atomic<std::uint64_t> ticks = 0;
  if (threads < 1) throw std::invalid_argument("threads: at least 1");
  {
    const nb::gil_scoped_release release;
    Interruption interruption;
    const auto work = [&] {
      with_splitting(spec, controller, seed, effort, interruption, [&](auto splitting) {
        for (std::uint32_t i = next++; i < count; i = next++) {
          found[i] = splitting.replicate(first + i, levels);
        }
        ticks += splitting.steps();
      });
    };
    std::atomic<std::uint32_t> working = threads - 1;
    std::vector<std::jthread> others;
    for (std::uint32_t i = 1; i < threads; ++i) {
      others.emplace_back([&] {
        try {
          work();
        } catch (const Interruption::Stop&) {  // the caller's thread raises
        }
        --working;
      });
    }
    work();
    while (working > 0) {
      interruption.look();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  nb::list rows;
  for (const auto& stages : found) {
    nb::list row;
    for (const Stage& stage : stages) row.append(nb::make_tuple(stage.reached, stage.hits));
    rows.append(row);
  }
  return nb::make_tuple(rows, ticks.load());
}

}  // namespace

void bind_splitting(nb::module_& m) {
  m.def(
      "choose_levels", &choose_levels, nb::arg("spec"), nb::arg("controller"), nb::arg("seed"),
      nb::arg("effort"), nb::arg("share"), nb::arg("most") = ~std::uint64_t{0},
      "Heights, as parts of the palm's half-length, each reached by about `share` of the carries "
      "from the one before, or none if that takes more than `most` ticks; and the ticks of finding "
      "them.");
  m.def("replicates", &replicates, nb::arg("spec"), nb::arg("controller"), nb::arg("seed"),
        nb::arg("effort"), nb::arg("levels"), nb::arg("first"), nb::arg("count"),
        nb::arg("threads"),
        "Of each replicate and stage (reached, drops); and the ticks of all together.");
}

}  // namespace palmbots::bindings
