// SPDX-License-Identifier: Apache-2.0
// Whole carries: one with everything that was seen, or many with their metrics.
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <optional>
#include <span>

#include "given_team.hpp"
#include "palmbots/optimum/linear_team.hpp"
#include "palmbots/optimum/optimal_team.hpp"
#include "palmbots/optimum/standing_team.hpp"

namespace palmbots::bindings {

namespace {

using Forks = std::vector<Fork>;

template <class Real, class Team>
Run run_team(const Spec& spec, std::uint64_t seed, bool record, Team team,
             const Forks& forks = {}) {
  Carry<Real, Team, TraceRecorder> carry(spec, seed, std::move(team), TraceRecorder(record));
  carry.run(forks);
  Run run = run_of(carry);
  run.ambiguous = carry.world().ambiguous_events();
  run.hash = carry.recorder().hash();
  run.rows = carry.recorder().take_rows();
  run.sent_messages = carry.recorder().take_sent_messages();
  run.choices = carry.recorder().take_choices();
  return run;
}

template <class Table, class Team>
Run run_lift(const Spec& spec, std::uint64_t seed, bool record, Team team) {
  LiftCarry<Team, TraceRecorder, Table> carry(spec, seed, std::move(team), record);
  carry.run();
  Run run = run_of_lift(carry);
  run.ambiguous = carry.world().ambiguous_events();
  run.falls = carry.falls();
  return run;
}

bool is_single(const std::string& precision) {
  if (precision == "float") return true;
  if (precision == "double") return false;
  throw std::invalid_argument("precision: double or float");
}

Run run(const Spec& spec, const nb::object& controller, std::uint64_t seed,
        const std::string& precision, bool record,
        const std::vector<std::pair<double, std::uint64_t>>& forks) {
  Forks at_ticks;
  for (const auto& [seconds, fork_seed] : forks) {
    at_ticks.push_back({static_cast<std::uint32_t>(seconds / spec.period + 0.5), fork_seed});
  }
  const bool single = is_single(precision);
  const auto row_team = [&] {
    const RowPolicy& policy = nb::cast<const RowPolicy&>(controller);
    return RowPolicyTeam(channel_of(spec), seed, leader_of(spec), Faults::of(spec, seed), policy);
  };
  if (uses_floor(spec)) {
    if (single || !forks.empty())
      throw std::invalid_argument("a job on the floor is in double precision, without forks");
    const auto lift_with = [&]<class Team>(Team team) {
      std::optional<nb::gil_scoped_release> release;
      if constexpr (!calls_python<Team>) release.emplace();
      return with_job_table(spec, [&]<class Table>(Table) {
        return run_lift<Table>(spec, seed, record, team_of_job(std::move(team)));
      });
    };
    if (on_one_palm(spec) && !nb::isinstance<RemoteControllers>(controller))
      return lift_with(NoController{});
    if (nb::isinstance<RowPolicy>(controller)) return lift_with(row_team());
    return with_given_team(controller, spec, seed, lift_with);
  }
  const auto run_with = [&]<class Team>(Team team) {
    std::optional<nb::gil_scoped_release> release;
    if constexpr (!calls_python<Team>) release.emplace();
    if (!single) return run_team<double>(spec, seed, record, std::move(team), at_ticks);
    if constexpr (requires(World<float>& world, Robots<float>& robots) {
                    team.look(world, robots);
                  }) {
      return run_team<float>(spec, seed, record, std::move(team), at_ticks);
    } else {
      return run_team<float>(spec, seed, record, AnyTeam(std::move(team)), at_ticks);
    }
  };
  if (nb::isinstance<RowPolicy>(controller)) return run_with(row_team());
  if (nb::isinstance<OptimalController>(controller)) {
    const auto& optimal = nb::cast<const OptimalController&>(controller);
    return run_with(OptimalTeam(optimal.policy, spec, optimal.may_stop));
  }
  if (nb::isinstance<LinearFeedback>(controller)) {
    return run_with(LinearTeam(nb::cast<const LinearFeedback&>(controller), spec));
  }
  if (nb::isinstance<StandingFeedback>(controller)) {
    return run_with(StandingTeam(nb::cast<const StandingFeedback&>(controller), spec));
  }
  return with_given_team(controller, spec, seed, run_with);
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

// Of a job on the floor: the height of each pivot in each row of the trace.
nb::object pivot_heights(const Run& run) {
  auto* heights = new std::vector<double>();
  for (const PerSide<double>& height : run.pivot_heights)
    heights->insert(heights->end(), {height[left], height[right]});
  return nb::cast(nb::ndarray<nb::numpy, double>(heights->data(), {run.pivot_heights.size(), 2},
                                                 owner_of(heights)));
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
  d["vertex_height_m"] = columns<double>(rows, [](const Row& r) { return r.lift; });
  d["palm_rad"] = columns<double>(rows, [](const Row& r) { return r.palm; });
  d["speed_m_s"] = columns<double>(rows, [](const Row& r) { return r.speed; });
  d["commanded_m_s"] = columns<double>(rows, [](const Row& r) { return r.commanded; });
  d["separation_m"] = column<double>(rows, [](const Row& r) { return r.separation; });
  d["midpoint_m"] = column<double>(rows, [](const Row& r) { return r.midpoint; });
  d["object_rad"] = column<double>(rows, [](const Row& r) { return r.object; });
  d["sign"] = columns<std::int8_t>(rows, [](const Row& r) { return r.sign; });
  d["case"] = columns<std::uint8_t>(rows, [](const Row& r) { return r.name; });
  d["motion"] = columns<std::int8_t>(rows, [](const Row& r) { return r.motion; });
  return d;
}

nb::list phases(const Run& run) {
  nb::list list;
  for (const LiftPhase& phase : run.phases) {
    list.append(nb::make_tuple(phase.side, phase.name, phase.start * run.period, phase.moved));
  }
  return list;
}

nb::list falls(const Run& run) {
  nb::list list;
  for (const LiftFall& fall : run.falls)
    list.append(nb::make_tuple(fall.tick * run.period, fall.fall.height, fall.fall.com));
  return list;
}

nb::dict carry_phases_of() {
  nb::dict phases;
  for (const auto& [name, meaning] : carry_phase_words) phases[name] = meaning;
  return phases;
}

// For each event: its meaning, its meaning in MuJoCo and, by phase, what follows and the reason of a
// carry that ends.
nb::dict carry_ends_of() {
  nb::dict ends;
  for (const EndRow& end : std::span(carry_ends).subspan(1)) {
    nb::dict by_phase;
    for (std::size_t k = 0; k < carry_phases; ++k) {
      const Consequence& then = end.by_phase[k];
      by_phase[carry_phase_words[k][0]] = nb::make_tuple(name_of(then.then), name_of(then.reason));
    }
    ends[end.name] =
        nb::make_tuple(end.meaning, end.in_mujoco ? end.in_mujoco : end.meaning, by_phase);
  }
  return ends;
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

nb::list contact_events(const Run& run) {
  nb::list list;
  const std::size_t kept = run.metrics.contact_events < max_contact_events
                               ? run.metrics.contact_events
                               : max_contact_events;
  for (std::size_t i = 0; i < kept; ++i) {
    const ContactEventRow& t = run.metrics.contact_event_rows[i];
    list.append(nb::make_tuple(t.side, name_of(t.kind), t.start * run.period, t.end * run.period));
  }
  return list;
}

// (time [s], contacts that persist as (carrier, motion)) of each choice after an ambiguous event.
nb::list choices(const Run& run) {
  nb::list list;
  for (const ChoiceRow& choice : run.choices) {
    nb::list contacts;
    for (const ChoiceRow::Contact& c : choice.contacts)
      contacts.append(nb::make_tuple(static_cast<int>(c.carrier), static_cast<int>(c.motion)));
    list.append(nb::make_tuple(choice.when * run.period, contacts));
  }
  return list;
}

// Of each link (sent, lost, duplicated, late, rejected): from the left robot, from the right one,
// from the station to the left and to the right one.
nb::list links(const Run& run) {
  nb::list list;
  for (const LinkCounts& c : run.link_totals.links) {
    list.append(nb::make_tuple(c.sent, c.lost, c.duplicated, c.late, c.rejected));
  }
  return list;
}

nb::list messages(const Run& run) {
  nb::list list;
  for (const SentMessage& p : run.sent_messages) {
    const double received = p.received == 0 ? std::numeric_limits<double>::quiet_NaN()
                                            : double(p.received) * run.period;
    list.append(nb::make_tuple(double(p.sent) * run.period, received, static_cast<int>(p.sender),
                               static_cast<int>(p.receiver), name_of(p)));
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

}  // namespace

void bind_carry(nb::module_& m) {
  m.attr("carry_outcomes") = names_to(Outcome::stalled);
  m.attr("drop_reasons") = names_to(DropReason::toppled);
  m.attr("carry_phases") = carry_phases_of();
  m.attr("carry_ends") = carry_ends_of();
  nb::dict states;
  nb::list lift_messages;
  for (int kind = message_kinds; kind < all_message_kinds; ++kind)
    lift_messages.append(name_of(static_cast<MessageKind>(kind)));
  m.attr("lift_messages") = lift_messages;
  nb::dict phases_of_states;
  nb::dict numbers;
  const auto add = [&]<class Table>(Table) {
    for (int i = 0; i < Table::states; ++i) {
      const auto state = static_cast<typename Table::State>(i);
      numbers[nb::int_(phase_number<Table>(state))] = Table::meanings[i].name;
      const bool low = Table::on_one_palm || Table::role(state).arm == ArmMove::follow ||
                       Table::on_trial.has(state);
      const CarryPhase phase = low ? CarryPhase::low : CarryPhase::carried;
      states[Table::meanings[i].name] = Table::meanings[i].meaning;
      phases_of_states[Table::meanings[i].name] =
          carry_phase_words[static_cast<std::size_t>(phase)][0];
    }
  };
  add(Lifting{});
  add(Lone{});
  add(HandOver{});
  m.attr("lift_states") = states;
  m.attr("phases_of_lift_states") = phases_of_states;
  m.attr("lift_state_numbers") = numbers;
  nb::class_<Run>(m, "Run", "A finished carry.")
      .def_prop_ro("outcome", [](const Run& r) { return name_of(r.metrics.outcome); })
      .def_prop_ro("reason",
                   [](const Run& r) -> nb::object {
                     if (r.metrics.reason == DropReason::none) return nb::none();
                     return nb::str(name_of(r.metrics.reason));
                   })
      .def_prop_ro("time_s", [](const Run& r) { return r.metrics.time_ticks * r.period; })
      .def_prop_ro("distance_m", [](const Run& r) { return r.distance; })
      .def_prop_ro(
          "contact_rms_m",
          [](const Run& r) { return std::tuple(r.metrics.rms(left), r.metrics.rms(right)); })
      .def_prop_ro(
          "contact_peak_m",
          [](const Run& r) { return std::tuple(r.metrics.peak[left], r.metrics.peak[right]); })
      .def_prop_ro("messages", [](const Run& r) { return r.link_totals.sent; })
      .def_prop_ro("links", &links)
      .def_prop_ro("messages_lost", [](const Run& r) { return r.link_totals.lost; })
      .def_prop_ro("waiting_s",
                   [](const Run& r) {
                     return std::tuple(r.metrics.waiting_ticks[left] * r.period,
                                       r.metrics.waiting_ticks[right] * r.period);
                   })
      .def_prop_ro("waits_since_s",
                   [](const Run& r) {
                     return std::tuple(r.metrics.waits_since[left] * r.period,
                                       r.metrics.waits_since[right] * r.period);
                   })
      .def(
          "warnings",
          [](const Run& r, const Spec& spec, bool stops_in_silence) {
            return warnings_after(spec, {r.metrics, r.link_totals, r.awaits, r.stopped},
                                  stops_in_silence);
          },
          nb::arg("spec"), nb::arg("stops_in_silence"),
          "One sentence for each thing that went wrong unnoticed. stops_in_silence: of the "
          "controller.")
      .def_prop_ro("phases", &phases,
                   "Of a job on the floor: (side, state, start [s], displacement of the COM [m]), "
                   "in the order of their starts.")
      .def_prop_ro("falls", &falls,
                   "Of a job on the floor: (time [s], how far a contact vertex fell, and the COM "
                   "[m]) of each small fall.")
      .def_prop_ro("pivot_heights_m", &pivot_heights)
      .def_prop_ro("moved_m", [](const Run& r) { return r.moved; })
      .def_prop_ro("stalled_s",
                   [](const Run& r) {
                     return std::tuple(r.metrics.stalled_ticks[left] * r.period,
                                       r.metrics.stalled_ticks[right] * r.period);
                   })
      .def_prop_ro("ambiguous_events", [](const Run& r) { return r.ambiguous; })
      .def_prop_ro("choices", &choices)
      .def_prop_ro("bumps", [](const Run& r) { return r.metrics.bumps; })
      .def_prop_ro("correction_count", [](const Run& r) { return r.metrics.corrections; })
      .def_prop_ro("corrections", &corrections)
      .def_prop_ro("contact_events", &contact_events)
      .def_prop_ro("message_log", &messages)
      .def_prop_ro("trace", &trace)
      .def_prop_ro("trace_hash", [](const Run& r) { return hex(r.hash); });

  m.def("run", &run, nb::arg("spec"), nb::arg("controller"), nb::arg("seed"), nb::arg("precision"),
        nb::arg("record"), nb::arg("forks") = std::vector<std::pair<double, std::uint64_t>>{},
        "One carry. controller: a name, Machines, a RowPolicy, an OptimalController, "
        "LinearFeedback, RemoteControllers, or a pair of Python step functions. forks: times [s] "
        "in their order, from which on the carry continues with the random numbers of another "
        "seed.");
}

}  // namespace palmbots::bindings
