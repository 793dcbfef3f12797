// SPDX-License-Identifier: Apache-2.0
// Apart from core.cpp, because jobs on the floor take the general step of the world and are compiled to
// be small.
#include "recorded_carry.hpp"

namespace palmbots::page {

RecordedCarry record_job(const Spec& spec, std::uint64_t seed, PageTeam team,
                         bool stops_in_silence) {
  PageJob job(spec, seed, std::move(team), true);
  job.run();
  RecordedCarry kept = kept_of(spec, detail::end_of(job), job.midpoint(), stops_in_silence,
                               job.recorder(), job.take_heights());
  kept.metrics.back() = job.moved() * spec.direction;
  for (const LiftPhase& phase : job.phases()) {
    kept.phases.insert(kept.phases.end(), {double(phase.side), double(phase.state),
                                           double(phase.start) * spec.period});
  }
  return kept;
}

void Tally::add_job(const Spec& spec, std::uint64_t seed, PageTeam team) {
  PageJob job(spec, seed, std::move(team), false);
  job.run();
  add(spec, job.metrics(), job.team().link_totals, job.midpoint());
}

}  // namespace palmbots::page
