// SPDX-License-Identifier: Apache-2.0
// Warnings at the end of a carry, from what it measured.
#include "palmbots/sim/carry_warnings.hpp"

#include "support/check.hpp"

using namespace palmbots;

namespace {

using Lines = std::vector<std::string>;

// The end of a carry in which all went well, and whose left robot waits for an Ack from 1 s on.
struct Example {
  Spec spec;
  Metrics metrics;
  LinkTotals links;
  PerSide<MessageKind> awaits{MessageKind::ack, MessageKind::none};
  PerSide<bool> stopped{};
  bool stops_in_silence = false;

  explicit Example(double waits = 0, double latency = 0.05) {
    spec.period = 0.01;
    spec.latency = latency;
    spec.jitter = 0.1;
    metrics.outcome = Outcome::delivered;
    metrics.time_ticks = 100 + 100 * waits;
    metrics.waits_since = {100, static_cast<std::uint32_t>(metrics.time_ticks)};
  }
  Lines warnings() const {
    return warnings_after(spec, {metrics, links, awaits, stopped}, stops_in_silence);
  }
};

const Lines waits_for_ack{
    "the left robot has waited since 1.0 s for an Ack that does not arrive (a message was lost)"};

void test_no_warning_without_cause() {
  Example example;
  CHECK(example.warnings().empty());
  example.stops_in_silence = true;
  CHECK(example.warnings().empty());
}

void test_truncated_lists() {
  Example example;
  example.metrics.corrections = max_corrections + 1;
  example.metrics.contact_events = max_contact_events + 2;
  CHECK(example.warnings() ==
        (Lines{std::to_string(max_corrections + 1) + " corrections; only the first are listed",
               std::to_string(max_contact_events + 2) +
                   " contact events; only the first are listed"}));
}

void test_limit_cycle_names_the_side() {
  Example example;
  example.metrics.limit_cycle = {false, true};
  CHECK(example.warnings() == Lines{"limit cycle: the right robot's corrections follow each other "
                                    "with alternating sign"});
  example.metrics.limit_cycle[left] = true;
  CHECK(example.warnings().size() == 2);
}

// Two seconds, and the longest radio delay in both directions, jitter included.
void test_waiting() {
  struct Case {
    double waits;
    double latency;
    bool warned;
  };
  for (const auto& [waits, latency, warned] : {Case{2.1, 0.05, false},
                                               {2.31, 0.05, true},
                                               {2.31, 0.1, false},
                                               {2.9, 0.4, false},
                                               {3.1, 0.4, true}}) {
    Example example(waits, latency);
    CHECK(example.warnings().empty());
    example.links.lost = 1;
    CHECK(example.warnings() == (warned ? waits_for_ack : Lines{}));
  }
}

// A rejected message counts only if it was no mere copy.
void test_reasons() {
  Example example(3);
  example.awaits[left] = MessageKind::tilt_down;
  example.links.links[1].rejected = 1;
  CHECK(example.warnings().empty());
  example.spec.fault_count = 1;
  example.spec.faults[0].kind = FaultKind::stuck;
  CHECK(example.warnings().empty());
  example.spec.faults[0].kind = FaultKind::reboot;
  CHECK(example.warnings().at(0).ends_with(
      "for a TiltDown that does not arrive (a message had no session after a reboot)"));
  example.spec.corruption = 0.1;
  CHECK(example.warnings().at(0).ends_with("(a message arrived damaged)"));
}

// Only where robots stop in silence, and only if the carry timed out.
void test_standing_robots() {
  Example example;
  example.stopped[left] = true;
  example.stops_in_silence = true;
  CHECK(example.warnings().empty());
  example.metrics.outcome = Outcome::stalled;
  CHECK(example.warnings() ==
        Lines{"the left robot stands: it hears nothing fresh from its partner, or waits for p = "
              "0"});
  example.stops_in_silence = false;
  CHECK(example.warnings().empty());
}

}  // namespace

int main() {
  test_no_warning_without_cause();
  test_truncated_lists();
  test_limit_cycle_names_the_side();
  test_waiting();
  test_reasons();
  test_standing_robots();
}
