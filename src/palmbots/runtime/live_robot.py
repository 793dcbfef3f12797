# SPDX-License-Identifier: Apache-2.0
"""A robot's program in real time: reads its driver, exchanges packets, and writes its driver.

The compiled core makes all decisions (`_core.runtime.Robot`). This loop only moves bytes: once per
control period it passes readings and packets to the core, and carries out the answer.
"""

import contextlib
import math
import queue
import threading
from typing import Any

import palmbots._core as _core
from palmbots._types import Side
from palmbots.control.registry import ControllerEntry, check
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.errors import PalmbotsError
from palmbots.links.udp import UdpLink
from palmbots.runtime.control_clock import ControlClock
from palmbots.runtime.drive_table import drive_table
from palmbots.runtime.greeting import scene_number
from palmbots.runtime.pair_file import Pair
from palmbots.runtime.robot_program import controller_of, robot_program
from palmbots.runtime.stored_state import StoredState, booted, write_state
from palmbots.scene.scene import Scene, load_scene
from palmbots.wire import Role

_RECEIVERS: tuple[Role, ...] = ("left", "right", "station")
_STATE_PERIOD_S = 0.05
_STATUS_PERIOD_S = 0.05
_LEASE_S = 0.5
"""For controllers without a lease of their own: how long the partner's news counts."""
_MOST_OVERRUNS = 50
"""The control loop is too slow if more of the last 100 ticks were missed."""


def run_live_robot(pair: Pair, side: Side, rate: float = 1.0) -> int:
    """Boot the program of one robot, and run it until its driver is gone.

    Args:
        pair: the pair.
        side: which of its robots.
        rate: multiple of real time at which a simulated robot runs.

    Returns:
        How often the robot has booted.

    Raises:
        PalmbotsError: a file is missing or damaged, or an address cannot be used.
    """
    file = pair.state_file(side)
    with booted(file) as state:
        _run(pair, side, state, rate)
        return state.epoch


def _run(pair: Pair, side: Side, state: StoredState, rate: float) -> None:
    file = pair.state_file(side)
    scene = load_scene(pair.scene())
    robot = live_program(pair, side, state, scene)
    period_s = scene.control.period_s
    link = UdpLink(side, pair.settings.link.addresses())
    with contextlib.closing(link), _Storage(file, state) as storage:
        address = pair.settings.driver.address
        number = scene_number(scene)
        driver = SimulatedDriver(address, side, state.epoch, period_s / rate, number)
        with contextlib.closing(driver):
            driver.read()  # waits until the world starts: no tick counts before
            clock = ControlClock(period_s / rate)
            drives = drive_table(scene, side)
            goal_m = scene.task.distance_m
            start_m = 0.0
            stopping = math.ceil(pair.settings.hardware.of(side).stopping_s / period_s)
            while True:
                elapsed = clock.wait()
                seen = driver.read()
                if seen is None:
                    return
                if not robot.wheels:
                    start_m = seen.distance_m
                covered_m = seen.distance_m - start_m
                reading = _core.runtime.Reading(
                    seen.sign,
                    seen.palm_at_target,
                    driver_ok=driver.works,
                    storage_ok=storage.works,
                    covered=covered_m >= goal_m,
                    overruns=min(clock.recent_overruns, 0xFFFF),
                    progress=round(65535 * min(1.0, covered_m / goal_m)),
                    stopping=stopping,
                )
                palm, move, stop, packets, *_, assists = robot.step(
                    min(elapsed, 0xFFFF), reading, link.receive()
                )
                storage.keep(StoredState(state.epoch, assists, *robot.to_store))
                driver.write(drives[palm, move, stop, robot.wheels])
                for receiver, data, _ in packets:
                    # What the partner relies on after a boot is stored before it is said. A robot
                    # that does not carry promises nothing, and must pass on a stop at once.
                    if receiver == 2 or storage.is_done or not robot.wheels:
                        link.send(_RECEIVERS[receiver], data)


def live_program(pair: Pair, side: Side, state: StoredState, scene: Scene) -> Any:
    """The program of one robot of a pair, as it starts after a boot."""
    entry = controller_of(pair)
    if entry.team == "station":
        raise PalmbotsError(
            f"controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    return robot_program(pair, side, state, scene, _settings(pair, scene, entry))


def _settings(pair: Pair, scene: Scene, entry: ControllerEntry) -> Any:
    """The settings of the core."""
    return _core.runtime.RuntimeSettings(**core_settings(pair, scene, entry))


def core_settings(pair: Pair, scene: Scene, entry: ControllerEntry) -> dict[str, Any]:
    """The settings of a robot that carries in real time, in control ticks, as
    `_core.runtime.RuntimeSettings` takes them."""
    limits = pair.settings.limits
    bounds = check(entry, scene)
    lease_s = _LEASE_S if bounds is None else bounds.lease_s
    period_s = scene.control.period_s

    def ticks(seconds: float) -> int:
        return max(1, round(seconds / period_s))

    return {
        "lease": ticks(lease_s),
        "station_limit": ticks(limits.station_limit_s),
        "time_limit": ticks(limits.time_limit_s),
        "travel": 0,  # the driver measures the distance
        "watchdog": ticks(scene.control.watchdog_s),
        "most_overruns": _MOST_OVERRUNS,
        "has_radio": entry.uses_radio,
        "rejoins": limits.after_reboot == "rejoin",
        "stops_without_station": limits.station_lost == "stop",
        "stops_without_partner": limits.partner_lost == "stop",
        "state_period": ticks(_STATE_PERIOD_S),
        "status_period": ticks(_STATUS_PERIOD_S),
        "number": pair.fingerprint(scene),
    }


class _Storage:
    """Writes the state of a robot off the control thread: a memory card may take 0.1 s."""

    def __init__(self, file: Any, state: StoredState) -> None:
        self._file = file
        self._wanted = self._stored = state
        self._queue: queue.Queue[StoredState | None] = queue.Queue()
        self._thread = threading.Thread(target=self._write, daemon=True)
        self.works = True
        """Everything could be written so far."""

    @property
    def is_done(self) -> bool:
        """The newest state is on the disk."""
        return self._stored == self._wanted

    def keep(self, state: StoredState) -> None:
        """Write the state, if it has changed; returns at once."""
        if state != self._wanted:
            self._wanted = state
            self._queue.put(state)

    def _write(self) -> None:
        while (state := self._queue.get()) is not None:
            try:
                write_state(self._file, state)
            except PalmbotsError:
                self.works = False
            else:
                self._stored = state

    def __enter__(self) -> "_Storage":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._queue.put(None)
        self._thread.join()
