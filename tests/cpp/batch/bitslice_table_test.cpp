// SPDX-License-Identifier: Apache-2.0
// Every table, 64 pairs at once, does what each pair does on its own: the shipped tables and one
// that is new. A new controller needs nothing but its table.
//
// bitslice_table_test [TICKS]   TICKS: of sixty-four teams with each table; 12000 if not given
#include "palmbots/batch/bitslice_table_team.hpp"

#include <bit>
#include <cstdlib>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "support/bitslice_alone.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"
#include "support/robot_teams.hpp"
#include "support/third_table.hpp"

using namespace palmbots;

namespace {

// Times of every length; leases that beacons keep, and shorter ones.
template <class Table>
TableTeam<Table> team_over(const Channel& channel, const Faults& faults, std::uint32_t chance) {
  const auto of = [&](int bit, std::uint32_t most) {
    return static_cast<std::uint16_t>(1 + (std::rotr(chance, bit) & 0xFF) * most / 256);
  };
  TableTimes<Table> times{of(1, 12), of(9, 254), {}};
  const std::uint32_t longest = (chance >> 8 & 1) != 0 ? 4095 : 500;
  for (std::size_t k = 0; k < Table::limits; ++k) {
    times.limits[k] = of(13 + 4 * static_cast<int>(k), k == 0 ? longest : 40);
  }
  const bool by_touch = (chance >> 7 & 1) != 0;
  const std::size_t leader = chance % 2;
  return {table_robots<Table>(times, leader, (chance >> 5 & 3) != 0, by_touch),
          {},
          channel,
          0,
          leader,
          faults};
}

template <class Table>
Seen test_goes_as_it_does_alone(std::uint64_t ticks) {
  std::array<std::uint32_t, Table::states> states{};
  std::uint32_t stopped = 0;
  std::uint32_t silent = 0;
  const Seen seen = test_every_team_goes_as_it_does_alone<TableTeam<Table>>(
      true, ticks, team_over<Table>,
      [&](const TableTeam<Table>& team, const PerSide<Command>& commands) {
        ++states[static_cast<std::size_t>(team.robot(left).state())];
        stopped += commands[left].stop ? 1 : 0;
        silent += team.robot(left).silence() ? 1 : 0;
      });
  for (const std::uint32_t times : states) CHECK(times > 30);
  CHECK(seen.boots > 500 && seen.most_corrections > 256 && stopped > 1000 && silent > 1000);
  CHECK((seen.most_lost > 100 && seen.most_late > 100) == (Table::mail == Mail::beacons));
  return seen;
}

// Clocks, channels, faults and times with which a table can run bit-sliced.
template <class Table>
void test_supported_teams() {
  using Team = TableTeam<Table>;
  TableTimes<Table> times{5, 50, {}};
  times.limits.fill(4095);
  const auto goes = [&](const auto& t, double drift, const Channel& channel, const Faults& faults) {
    return BitslicedTeam<Team>::supports(
        Team(table_robots<Table>(t, left, true), {drift, 0}, channel, 0, left, faults));
  };
  const Channel steady = Channel::of(0.05, 0, 0.2, 0.01);
  CHECK(goes(times, 0, steady, {}));
  CHECK(!goes(times, 1e-6, steady, {}));
  CHECK(goes(times, 0, Channel::of(0.05, 0.02, 0, 0.01), {}) == (Table::mail == Mail::none));
  CHECK(goes(times, 0, Channel::of(0.64, 0, 0, 0.01), {}) == (Table::mail == Mail::none));
  for (const FaultKind kind : {FaultKind::reboot, FaultKind::freeze, FaultKind::stuck}) {
    Spec failing = paper_spec();
    failing.faults[0] = {kind, 0, 1.0, 0.5};
    failing.fault_count = 1;
    CHECK(goes(times, 0, steady, Faults::of(failing, 0)) == (kind == FaultKind::reboot));
  }
  auto longer = times;
  longer.limits[0] = 4096;
  CHECK(!goes(longer, 0, steady, {}));
  longer = times;
  longer.lease = 255;
  CHECK(goes(longer, 0, steady, {}) == (Table::mail == Mail::none));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t ticks = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 12000;
  test_goes_as_it_does_alone<ThirdTable>(ticks);
  test_goes_as_it_does_alone<Silent>(ticks);
  test_goes_as_it_does_alone<SharedSign>(ticks);
  test_supported_teams<Silent>();
  test_supported_teams<SharedSign>();
}
