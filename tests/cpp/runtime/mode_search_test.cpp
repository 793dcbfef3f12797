// SPDX-License-Identifier: Apache-2.0
// The mode machines of two robots: all states of both are searched (support/mode_search.hpp).
//
// mode_search_test [MUCH]   0: robots without radio, and defects; 1: all robots, which `make test` searches
//                           without sanitizers; 2: also a longer lease, and two packets under way to each
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "support/check.hpp"
#include "support/mode_search.hpp"

using namespace palmbots::runtime;
using namespace palmbots::test;

namespace {

ModeWorld world_of(AfterReboot after_reboot, StationLost station_lost, PartnerLost partner_lost) {
  ModeWorld world;
  world.settings.after_reboot = after_reboot;
  world.settings.station_lost = station_lost;
  world.settings.partner_lost = partner_lost;
  world.settings.lease = 1;
  world.settings.station_limit = 0;
  world.settings.time_limit = 1000;
  world.settings.stopping_limit = 0;
  world.settings.most_overruns = 0;
  return world;
}
// What `palmbots init` chooses, and what `palmbots up` chooses, but without a limit of the station's
// silence.
ModeWorld careful() { return world_of(AfterReboot::disarm, StationLost::stop, PartnerLost::stop); }
ModeWorld persistent() {
  return world_of(AfterReboot::rejoin, StationLost::carry_on, PartnerLost::controller);
}

// The number of states is pinned: a change of the table or of the model shows.
void holds_everywhere(const char* name, const ModeWorld& world, std::size_t states) {
  ModeSearch search(world);
  const char* violated = search.run();
  std::printf("%-18s %7zu states, %9zu transitions, %d turns to end: %s\n", name, search.states(),
              search.transitions(), search.longest(), violated != nullptr ? violated : "holds");
  if (violated != nullptr) search.print_trail();
  CHECK(violated == nullptr);
  CHECK(search.states() == states);
}

// A defect in a copy of the table is found, as a violation of this property.
template <class Change>
void finds(const char* property, ModeWorld world, Change&& change) {
  ModeTable table = mode_table;
  change(table);
  world.table = &table;
  const char* violated = ModeSearch(world).run();
  std::printf("defect against %s: %s\n", property, violated != nullptr ? violated : "not found");
  CHECK(violated != nullptr && std::strcmp(violated, property) == 0);
}

ModeRow& row_for(ModeTable& table, ModeEvent event) {
  for (ModeRow& row : table.rows) {
    if (row.when == event) return row;
  }
  CHECK(false);
  return table.rows[0];
}

void each_property_can_fail() {
  const auto without = [](ModeEvent event) {
    return [event](ModeTable& table) { row_for(table, event).from = {}; };
  };
  finds("M1", careful(), [](ModeTable& table) {
    table.outputs[static_cast<std::size_t>(RobotMode::done)].runs = true;
  });
  finds("M2", careful(),
        [](ModeTable& table) { row_for(table, ModeEvent::partner_starts).when = ModeEvent::any; });
  finds("M3", careful(), without(ModeEvent::partner_stop));
  finds("M3", careful(), without(ModeEvent::stop_stored));
  finds("M3", careful(), [](ModeTable& table) {
    row_for(table, ModeEvent::arm).from = {RobotMode::disarmed, RobotMode::done, RobotMode::fault,
                                           RobotMode::stopped};
  });
  finds("M4", careful(), without(ModeEvent::partner_done));
  finds("M4", persistent(), without(ModeEvent::partner_ended));
  finds("M4", careful(), without(ModeEvent::partner_lost));
  ModeWorld steady = careful();
  steady.reboots = 0;
  finds("M5", steady, without(ModeEvent::release));
  finds("M5", steady, [](ModeTable& table) {  // released robots stop each other again
    row_for(table, ModeEvent::partner_stop).from = ModeSet::all() - ModeSet{RobotMode::stopped};
  });
  finds("M6", careful(),
        [](ModeTable& table) { row_for(table, ModeEvent::carry_stored).when = ModeEvent::any; });
  finds("M6", persistent(),
        [](ModeTable& table) { row_for(table, ModeEvent::any).next = RobotMode::ready; });
}

}  // namespace

int main(int argc, char** argv) {
  const int much = argc > 1 ? std::atoi(argv[1]) : 0;
  if (much > 0) each_property_can_fail();
  ModeWorld silent = careful();
  silent.settings.has_radio = false;
  holds_everywhere("silent", silent, 801);
  if (much < 1) return 0;
  ModeWorld steady = careful();
  steady.reboots = 0;
  holds_everywhere("careful, no reboot", steady, 44411);
  holds_everywhere("persistent", persistent(), 258020);
  if (much < 2) return 0;
  holds_everywhere("careful", careful(), 134460);
  ModeWorld patient = persistent();
  patient.settings.lease = 2;
  holds_everywhere("longer lease", patient, 1084270);
  ModeWorld crowded = careful();
  crowded.room = 2;
  holds_everywhere("overtaking", crowded, 1227422);
}
