// Whole carries: one with everything that was seen, or many with their metrics.
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "bindings.hpp"
#include "palmbots/recorder.hpp"
#include "palmbots/resilient_bounds.hpp"

namespace palmbots::bindings {

namespace {

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

  double rms(std::size_t side) const {
    return metrics.samples == 0 ? 0 : std::sqrt(metrics.square_sum[side] / metrics.samples);
  }
};

template <class Real, class Recorder, class Team>
Run run_team(const Spec& spec, std::uint64_t seed, Team team) {
  Carry<Real, Team, Recorder> carry(spec, seed, std::move(team), Recorder{});
  carry.run();
  Run run;
  run.metrics = carry.metrics();
  run.period = spec.period;
  run.distance = double(carry.midpoint()) * spec.direction;
  run.traffic = carry.team().traffic;
  for (const std::size_t side : {left, right}) {
    run.awaits[side] = carry.team().awaits(side);
    run.rests[side] = carry.commands()[side].rest;
  }
  if constexpr (!std::is_same_v<Recorder, NoRecorder>) run.hash = carry.recorder().hash();
  if constexpr (std::is_same_v<Recorder, TraceRecorder>) {
    run.rows = carry.recorder().take_rows();
    run.posted = carry.recorder().take_posted();
  }
  return run;
}

// A built-in controller by its name.
template <class Real, class Recorder>
Run run_named(const Spec& spec, const std::string& name, std::uint64_t seed) {
  const Channel channel = channel_of(spec);
  const Faults faults = Faults::of(spec, seed);
  const std::size_t leader = leader_of(spec);
  if (name == "none") return run_team<Real, Recorder>(spec, seed, Unattended{});
  if (name == "centralized") {
    return run_team<Real, Recorder>(spec, seed, Station(channel, seed, leader, faults));
  }
  if (name == "distributed") {
    return run_team<Real, Recorder>(spec, seed,
                                    Pair<Distributed>({}, channel, seed, leader, faults));
  }
  if (name == "resilient") {
    const PerSide<double> drift{spec.robots[left].clock_drift, spec.robots[right].clock_drift};
    return run_team<Real, Recorder>(
        spec, seed, Peers(Bounds::of(spec).times, drift, channel, seed, leader, faults));
  }
  throw std::invalid_argument("controller: none, centralized, distributed or resilient");
}

bool is_single(const std::string& precision) {
  if (precision == "float") return true;
  if (precision == "double") return false;
  throw std::invalid_argument("precision: double or float");
}

Run run(const Spec& spec, const nb::object& controller, std::uint64_t seed,
        const std::string& precision, bool record) {
  const bool single = is_single(precision);
  if (nb::isinstance<nb::str>(controller)) {
    const auto name = nb::cast<std::string>(controller);
    const nb::gil_scoped_release release;
    if (record) {
      return single ? run_named<float, TraceRecorder>(spec, name, seed)
                    : run_named<double, TraceRecorder>(spec, name, seed);
    }
    return single ? run_named<float, HashRecorder>(spec, name, seed)
                  : run_named<double, HashRecorder>(spec, name, seed);
  }
  const auto pair = nb::cast<std::tuple<nb::object, nb::object>>(controller);
  Pair<PythonController> team(
      {PythonController(std::get<0>(pair)), PythonController(std::get<1>(pair))}, channel_of(spec),
      seed, leader_of(spec), Faults::of(spec, seed));
  return single ? run_team<float, TraceRecorder>(spec, seed, std::move(team))
                : run_team<double, TraceRecorder>(spec, seed, std::move(team));
}

// Columns of the trace: one entry a row, or one for each side.
template <class T, class Get>
nb::object column(const std::vector<Row>& rows, Get get) {
  auto* values = new std::vector<T>();
  values->reserve(rows.size());
  for (const Row& row : rows) values->push_back(get(row));
  return nb::cast(nb::ndarray<nb::numpy, T>(values->data(), {values->size()}, owner_of(values)));
}

template <class T, class Get>
nb::object columns(const std::vector<Row>& rows, Get get) {
  auto* values = new std::vector<T>();
  values->reserve(2 * rows.size());
  for (const Row& row : rows) {
    for (const std::size_t side : {left, right}) values->push_back(static_cast<T>(get(row)[side]));
  }
  return nb::cast(nb::ndarray<nb::numpy, T>(values->data(), {rows.size(), 2}, owner_of(values)));
}

nb::object trace(const Run& run) {
  if (run.rows.empty()) return nb::none();
  const std::vector<Row>& rows = run.rows;
  nb::dict d;
  auto* time = new std::vector<double>();
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) time->push_back(double(k) * run.period);
  time->push_back(run.metrics.time_ticks * run.period);
  d["time_s"] = nb::ndarray<nb::numpy, double>(time->data(), {time->size()}, owner_of(time));
  d["contact_m"] = columns<double>(rows, [](const Row& r) { return r.contact; });
  d["palm_rad"] = columns<double>(rows, [](const Row& r) { return r.palm; });
  d["speed_m_s"] = columns<double>(rows, [](const Row& r) { return r.speed; });
  d["commanded_m_s"] = columns<double>(rows, [](const Row& r) { return r.commanded; });
  d["separation_m"] = column<double>(rows, [](const Row& r) { return r.separation; });
  d["midpoint_m"] = column<double>(rows, [](const Row& r) { return r.midpoint; });
  // For people and pictures only; the hash does not see it, so libm may serve.
  d["object_rad"] = column<double>(rows, [](const Row& r) { return std::asin(r.object); });
  d["sign"] = columns<std::int8_t>(rows, [](const Row& r) { return r.sign; });
  d["case"] = columns<std::uint8_t>(rows, [](const Row& r) { return r.name; });
  d["motion"] = columns<std::int8_t>(rows, [](const Row& r) { return r.motion; });
  return d;
}

nb::list corrections(const Run& run) {
  nb::list list;
  const std::size_t kept =
      run.metrics.corrections < max_corrections ? run.metrics.corrections : max_corrections;
  for (std::size_t i = 0; i < kept; ++i) {
    const Correction& c = run.metrics.rows[i];
    // The last tick may be cut short by the end of the carry.
    const double end =
        double(c.end) < run.metrics.time_ticks ? double(c.end) : run.metrics.time_ticks;
    list.append(nb::make_tuple(static_cast<int>(c.robot), nb::str(&c.name, 1),
                               static_cast<int>(c.assistant), double(c.start) * run.period,
                               end * run.period));
  }
  return list;
}

// For how long each robot has been waiting at the end [s], and for which letter if that is known.
nb::list hanging(const Run& run) {
  nb::list list;
  for (const std::size_t side : {left, right}) {
    const double since = double(run.metrics.waits_since[side]) * run.period;
    const double waits = run.metrics.time_ticks * run.period - since;
    list.append(nb::make_tuple(since, waits > 0 ? waits : 0.0,
                               letter_names[static_cast<int>(run.awaits[side])]));
  }
  return list;
}

// Of each link (sent, lost, duplicated, late, rejected): from the left robot, from the right one, from
// the station to the left and to the right one.
nb::list links(const Run& run) {
  nb::list list;
  for (const LinkCounts& c : run.traffic.links) {
    list.append(nb::make_tuple(c.sent, c.lost, c.duplicated, c.late, c.rejected));
  }
  return list;
}

nb::list letters(const Run& run) {
  nb::list list;
  for (const Posted& p : run.posted) {
    const double received = p.received == 0 ? std::numeric_limits<double>::quiet_NaN()
                                            : double(p.received) * run.period;
    list.append(nb::make_tuple(double(p.sent) * run.period, received, static_cast<int>(p.sender),
                               static_cast<int>(p.receiver),
                               letter_names[static_cast<int>(p.letter)]));
  }
  return list;
}

std::string hex(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = 0; i < 16; ++i) {
    text[15 - i] = "0123456789abcdef"[(value >> (4 * i)) & 15];
  }
  return text;
}

// Many carries with seeds first … first + n − 1: a column of each metric.
nb::dict run_seeds(const Spec& spec, const std::string& name, std::uint64_t first, std::size_t n,
                   const std::string& precision) {
  const bool single = is_single(precision);
  auto* outcome = new std::vector<std::uint8_t>(n);
  auto* time = new std::vector<double>(n);
  auto* rms = new std::vector<double>(2 * n);
  auto* peak = new std::vector<double>(2 * n);
  auto* count = new std::vector<std::uint32_t>(n);
  auto* sent = new std::vector<std::uint32_t>(n);
  auto* lost = new std::vector<std::uint32_t>(n);
  auto* since = new std::vector<double>(2 * n);
  nb::dict d;
  d["outcome"] = nb::ndarray<nb::numpy, std::uint8_t>(outcome->data(), {n}, owner_of(outcome));
  d["time_s"] = nb::ndarray<nb::numpy, double>(time->data(), {n}, owner_of(time));
  d["contact_rms_m"] = nb::ndarray<nb::numpy, double>(rms->data(), {n, 2}, owner_of(rms));
  d["contact_peak_m"] = nb::ndarray<nb::numpy, double>(peak->data(), {n, 2}, owner_of(peak));
  d["corrections"] = nb::ndarray<nb::numpy, std::uint32_t>(count->data(), {n}, owner_of(count));
  d["messages"] = nb::ndarray<nb::numpy, std::uint32_t>(sent->data(), {n}, owner_of(sent));
  d["messages_lost"] = nb::ndarray<nb::numpy, std::uint32_t>(lost->data(), {n}, owner_of(lost));
  d["waits_since_s"] = nb::ndarray<nb::numpy, double>(since->data(), {n, 2}, owner_of(since));
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 64 == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
    const nb::gil_scoped_release release;
    const Run one = single ? run_named<float, NoRecorder>(spec, name, first + i)
                           : run_named<double, NoRecorder>(spec, name, first + i);
    (*outcome)[i] = static_cast<std::uint8_t>(one.metrics.outcome);
    (*time)[i] = one.metrics.time_ticks * one.period;
    for (const std::size_t side : {left, right}) {
      (*rms)[2 * i + side] = one.rms(side);
      (*since)[2 * i + side] = double(one.metrics.waits_since[side]) * one.period;
      (*peak)[2 * i + side] = one.metrics.peak[side];
    }
    (*count)[i] = one.metrics.corrections;
    (*sent)[i] = one.traffic.sent;
    (*lost)[i] = one.traffic.lost;
  }
  return d;
}

}  // namespace

void bind_run(nb::module_& m) {
  nb::class_<Run>(m, "Run", "A finished carry.")
      .def_prop_ro("outcome",
                   [](const Run& r) { return result_names[static_cast<int>(r.metrics.outcome)]; })
      .def_prop_ro("reason",
                   [](const Run& r) -> nb::object {
                     if (r.metrics.end == End::none) return nb::none();
                     return nb::str(end_names[static_cast<int>(r.metrics.end)]);
                   })
      .def_prop_ro("time_s", [](const Run& r) { return r.metrics.time_ticks * r.period; })
      .def_prop_ro("distance_m", [](const Run& r) { return r.distance; })
      .def_prop_ro("contact_rms_m",
                   [](const Run& r) { return std::tuple(r.rms(left), r.rms(right)); })
      .def_prop_ro(
          "contact_peak_m",
          [](const Run& r) { return std::tuple(r.metrics.peak[left], r.metrics.peak[right]); })
      .def_prop_ro("messages", [](const Run& r) { return r.traffic.sent; })
      .def_prop_ro("links", &links)
      .def_prop_ro("rests", [](const Run& r) { return std::tuple(r.rests[left], r.rests[right]); })
      .def_prop_ro("messages_lost", [](const Run& r) { return r.traffic.lost; })
      .def_prop_ro("waiting_s",
                   [](const Run& r) {
                     return std::tuple(r.metrics.waiting_ticks[left] * r.period,
                                       r.metrics.waiting_ticks[right] * r.period);
                   })
      .def_prop_ro("hanging", &hanging)
      .def_prop_ro("limit_cycle",
                   [](const Run& r) {
                     return std::tuple(bool(r.metrics.limit_cycle[left]),
                                       bool(r.metrics.limit_cycle[right]));
                   })
      .def_prop_ro("bumps", [](const Run& r) { return r.metrics.bumps; })
      .def_prop_ro("correction_count", [](const Run& r) { return r.metrics.corrections; })
      .def_prop_ro("corrections", &corrections)
      .def_prop_ro("letters", &letters)
      .def_prop_ro("trace", &trace)
      .def_prop_ro("trace_hash", [](const Run& r) { return hex(r.hash); });

  m.def("run", &run, nb::arg("spec"), nb::arg("controller"), nb::arg("seed"), nb::arg("precision"),
        nb::arg("record"), "One carry. controller: a name, or a pair of Python step functions.");
  m.def("run_seeds", &run_seeds, nb::arg("spec"), nb::arg("controller"), nb::arg("first"),
        nb::arg("n"), nb::arg("precision"),
        "n carries with seeds first, first + 1, ...: their metrics as columns.");
}

}  // namespace palmbots::bindings
