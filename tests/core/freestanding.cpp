// What a robot and a station run, as firmware would call it: functions without a system below.
// Compiled by tests/test_core.py, never run.
#include "palmbots/beacon.hpp"
#include "palmbots/policy.hpp"
#include "palmbots/protocol.hpp"
#include "palmbots/resilient.hpp"

palmbots::Distributed::Output robot_step(palmbots::Distributed& robot,
                                         palmbots::Distributed::Input in);

palmbots::Distributed::Output robot_step(palmbots::Distributed& robot,
                                         palmbots::Distributed::Input in) {
  return robot.step(in);
}

palmbots::Centralized::Output station_step(palmbots::Centralized& station,
                                           const palmbots::Centralized::Report (&reports)[2]);

palmbots::Centralized::Output station_step(palmbots::Centralized& station,
                                           const palmbots::Centralized::Report (&reports)[2]) {
  return station.step(reports);
}

palmbots::Resilient::Output resilient_step(palmbots::Resilient& robot,
                                           const palmbots::Resilient::Input& in);

palmbots::Resilient::Output resilient_step(palmbots::Resilient& robot,
                                           const palmbots::Resilient::Input& in) {
  return robot.step(in);
}

bool hear(palmbots::Ear& ear, const palmbots::Beacon& beacon);

bool hear(palmbots::Ear& ear, const palmbots::Beacon& beacon) { return ear.take(beacon); }
