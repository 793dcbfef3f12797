// SPDX-License-Identifier: Apache-2.0
// palmbots._batch: many carries at once, in lanes and on several threads.
//
// Built from this file for any processor, for those of level x86-64-v3 (_batch_v3) and for those of
// level x86-64-v4 (_batch_v4); the results have the same bits. Specs come as bytes (Spec is
// trivially copyable), so that the two modules share nothing with each other or with
// palmbots._core.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "palmbots/batch/lane_carries.hpp"
#include "palmbots/sim/spec_bytes.hpp"
#include "palmbots/sim/team_registry.hpp"

namespace palmbots {

namespace {

namespace nb = nanobind;

template <class T>
using Input = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// What is to be carried: carry i is specs[which[i]] with seeds[i].
struct Task {
  std::vector<Spec> specs;
  const std::uint32_t* which;
  const std::uint64_t* seeds;
  std::size_t count;
};

// A column of results, handed over to NumPy without a copy.
template <class T>
class Column {
 public:
  explicit Column(std::size_t rows, std::size_t width = 1)
      : values_(new std::vector<T>(rows * width)), rows_(rows), width_(width) {}
  T& operator()(std::size_t row, std::size_t i = 0) { return (*values_)[row * width_ + i]; }
  nb::object give() {
    auto* values = values_.release();
    const nb::capsule owner(values,
                            [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    if (width_ == 1) return nb::cast(nb::ndarray<nb::numpy, T>(values->data(), {rows_}, owner));
    return nb::cast(nb::ndarray<nb::numpy, T>(values->data(), {rows_, width_}, owner));
  }

 private:
  std::unique_ptr<std::vector<T>> values_;
  std::size_t rows_;
  std::size_t width_;
};

// One row a carry; each is written by one thread.
struct Results {
  explicit Results(std::size_t n)
      : finished(n),
        outcome(n),
        reason(n),
        time_s(n),
        distance_m(n),
        contact_rms_m(n, 2),
        contact_peak_m(n, 2),
        waiting_s(n, 2),
        waits_since_s(n, 2),
        corrections(n),
        messages(n),
        messages_lost(n) {}

  template <class Carry>
  void put(std::size_t i, const Carry& carry) {
    const Metrics& m = carry.metrics();
    const Spec& spec = carry.spec();
    outcome(i) = static_cast<std::uint8_t>(m.outcome);
    reason(i) = static_cast<std::uint8_t>(m.reason);
    time_s(i) = m.time_ticks * spec.period;
    distance_m(i) = double(carry.midpoint()) * spec.direction;
    for (const std::size_t side : {left, right}) {
      contact_rms_m(i, side) = m.rms(side);
      contact_peak_m(i, side) = m.peak[side];
      waiting_s(i, side) = m.waiting_ticks[side] * spec.period;
      waits_since_s(i, side) = m.waits_since[side] * spec.period;
    }
    corrections(i) = m.corrections;
    messages(i) = carry.team().link_totals.sent;
    messages_lost(i) = carry.team().link_totals.lost;
    finished(i) = 1;
  }

  Column<std::uint8_t> finished;
  Column<std::uint8_t> outcome;
  Column<std::uint8_t> reason;
  Column<double> time_s;
  Column<double> distance_m;
  Column<double> contact_rms_m;
  Column<double> contact_peak_m;
  Column<double> waiting_s;
  Column<double> waits_since_s;
  Column<std::uint32_t> corrections;
  Column<std::uint32_t> messages;
  Column<std::uint32_t> messages_lost;
};

// What the threads share while they work.
struct Progress {
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t working = 0;  // threads; guarded by the mutex
  std::string failure;      // of a thread; guarded by the mutex
};

// One thread's share: takes the next carry whenever a lane is free.
template <class Real, class Make>
void work(const Task& task, Progress& progress, Results& results, Make make) {
  using Team = decltype(make(task.specs[0], std::uint64_t{}));
  // Large, so not on the stack.
  const auto lanes = std::make_unique<LaneCarries<Real, lanes_of<Real>, Team>>();
  lanes->run(
      [&](auto& slot, std::size_t& index) {
        if (progress.stop.load(std::memory_order_relaxed)) return false;
        index = progress.next.fetch_add(1, std::memory_order_relaxed);
        if (index >= task.count) return false;
        const Spec& spec = task.specs[task.which[index]];
        const std::uint64_t seed = task.seeds[index];
        slot.emplace(spec, seed, make(spec, seed), NoRecorder{});
        return true;
      },
      [&](std::size_t index, const auto& carry) {
        results.put(index, carry);
        progress.done.fetch_add(1, std::memory_order_relaxed);
      },
      [&] { return progress.stop.load(std::memory_order_relaxed); });
}

Task task_of(const nb::bytes& specs, const Input<std::uint32_t>& which,
             const Input<std::uint64_t>& seeds) {
  if (which.shape(0) != seeds.shape(0)) {
    throw std::invalid_argument("which, seeds: as many of one as of the other");
  }
  Task task{{}, which.data(), seeds.data(), seeds.shape(0)};
  std::span<const std::byte> rest(static_cast<const std::byte*>(specs.data()), specs.size());
  do {
    const auto spec = take_spec(rest);
    if (!spec) throw std::invalid_argument("specs: whole Specs as bytes, at least one");
    task.specs.push_back(*spec);
  } while (!rest.empty());
  for (std::size_t i = 0; i < task.count; ++i) {
    if (task.which[i] >= task.specs.size()) throw std::out_of_range("which: not that many specs");
  }
  return task;
}

nb::dict run_many(const nb::bytes& specs, const Input<std::uint32_t>& which,
                  const Input<std::uint64_t>& seeds, const std::string& controller,
                  const std::string& precision, std::size_t threads, const nb::object& watch) {
  if (!is_controller(controller)) {
    throw std::invalid_argument("controller: one of " + controller_list());
  }
  if (precision != "double" && precision != "float") {
    throw std::invalid_argument("precision: double or float");
  }
  if (threads < 1) throw std::invalid_argument("threads: at least 1");
  const Task task = task_of(specs, which, seeds);
  Results results(task.count);
  Progress progress;
  bool interrupted = false;
  std::exception_ptr raised;
  {
    const nb::gil_scoped_release release;
    progress.working = threads;
    std::vector<std::jthread> pool;
    for (std::size_t t = 0; t < threads; ++t) {
      pool.emplace_back([&] {
        std::string failure;
        try {
          visit_team(controller, [&](auto make) {
            if (precision == "float") {
              work<float>(task, progress, results, make);
            } else {
              work<double>(task, progress, results, make);
            }
          });
        } catch (const std::exception& error) {
          failure = error.what();
          progress.stop = true;
        }
        const std::lock_guard lock(progress.mutex);
        --progress.working;
        if (!failure.empty()) progress.failure = failure;
        progress.changed.notify_one();
      });
    }
    std::unique_lock lock(progress.mutex);
    while (progress.working > 0) {
      progress.changed.wait_for(lock, std::chrono::milliseconds(50));
      if (progress.working == 0 || interrupted) continue;
      lock.unlock();
      {
        const nb::gil_scoped_acquire acquire;
        // Ctrl-C, or an exception in the progress callback: finished carries are kept.
        if (PyErr_CheckSignals() != 0) {
          PyErr_Clear();
          interrupted = true;
        } else if (!watch.is_none()) {
          try {
            watch(progress.done.load(std::memory_order_relaxed));
          } catch (nb::python_error& error) {
            if (!error.matches(PyExc_KeyboardInterrupt)) raised = std::current_exception();
            interrupted = true;
          }
        }
        if (interrupted) progress.stop = true;
      }
      lock.lock();
    }
  }
  if (raised) std::rethrow_exception(raised);
  if (!progress.failure.empty()) throw std::runtime_error(progress.failure);
  nb::dict d;
  d["interrupted"] = interrupted;
  d["finished"] = results.finished.give();
  d["outcome"] = results.outcome.give();
  d["reason"] = results.reason.give();
  d["time_s"] = results.time_s.give();
  d["distance_m"] = results.distance_m.give();
  d["contact_rms_m"] = results.contact_rms_m.give();
  d["contact_peak_m"] = results.contact_peak_m.give();
  d["waiting_s"] = results.waiting_s.give();
  d["waits_since_s"] = results.waits_since_s.give();
  d["corrections"] = results.corrections.give();
  d["messages"] = results.messages.give();
  d["messages_lost"] = results.messages_lost.give();
  return d;
}

}  // namespace

}  // namespace palmbots

NB_MODULE(PALMBOTS_BATCH, m) {
  namespace nb = nanobind;
  m.doc() = "Many carries at once, in lanes.";
  m.attr("lanes_double") = palmbots::lanes_of<double>;
  m.attr("lanes_float") = palmbots::lanes_of<float>;
  m.def("run_many", &palmbots::run_many, nb::arg("specs"), nb::arg("which"), nb::arg("seeds"),
        nb::arg("controller"), nb::arg("precision"), nb::arg("threads"),
        nb::arg("watch").none() = nb::none(),
        "Carry i is specs[which[i]] with seeds[i]: metrics as columns.");
}
