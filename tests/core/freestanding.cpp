// What a robot and a station run, as firmware would call it: two functions without a system below.
// Compiled by tests/test_core.py, never run.
#include "palmbots/policy.hpp"
#include "palmbots/protocol.hpp"

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
