// SPDX-License-Identifier: Apache-2.0
// Apart from core.cpp, because jobs on the floor take the general step of the world and are compiled to
// be small.
#include "palmbots/sim/no_controller.hpp"
#include "recorded_carry.hpp"

namespace palmbots::page {

namespace {

// Runs a job with the table of its phases, and then calls `then` with it. Where one palm at a time
// holds the object, controllers do nothing.
template <class Then>
void run_job(const Spec& spec, std::uint64_t seed, PageTeam team, bool records, Then&& then) {
  const auto run = [&]<class Table>(Table, PageTeam controllers) {
    PageJob<Table> job(spec, seed, std::move(controllers), records);
    job.run();
    then(job);
  };
  if (is_alone(spec)) return run(Lone{}, PageTeam(NoController{}));
  if (hands_over(spec)) return run(HandOver{}, PageTeam(NoController{}));
  run(Lifting{}, std::move(team));
}

}  // namespace

RecordedCarry record_job(const Spec& spec, std::uint64_t seed, PageTeam team,
                         bool stops_in_silence) {
  RecordedCarry kept;
  run_job(spec, seed, std::move(team), true, [&]<class Table>(PageJob<Table>& job) {
    kept = kept_of(spec, detail::end_of(job), job.midpoint(), stops_in_silence, job.recorder(),
                   job.take_heights());
    kept.metrics.back() = job.moved() * spec.direction;
    for (const LiftPhase& phase : job.phases()) {
      const int number = phase_number<Table>(static_cast<typename Table::State>(phase.state));
      kept.phases.insert(kept.phases.end(),
                         {double(phase.side), double(number), double(phase.start) * spec.period});
    }
  });
  return kept;
}

void Tally::add_job(const Spec& spec, std::uint64_t seed, PageTeam team) {
  run_job(spec, seed, std::move(team), false, [&](const auto& job) {
    add(spec, job.metrics(), job.team().link_totals, job.midpoint());
  });
}

}  // namespace palmbots::page
