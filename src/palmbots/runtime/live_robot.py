# SPDX-License-Identifier: Apache-2.0
"""A robot's program in real time: reads its driver, exchanges packets, and writes its driver.

The compiled core makes all decisions (`_core.runtime.Robot`). This loop only moves bytes: once per
control period it passes readings and packets to the core, and carries out the answer.
"""

import contextlib
import gc
import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util.end_signal import ended_by_signal
from palmbots.control.registry import ControllerEntry, check
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.errors import PalmbotsError
from palmbots.links.udp import UdpLink
from palmbots.runtime.control_clock import control_clock, jitter_table
from palmbots.runtime.drive_table import drive_table
from palmbots.runtime.greeting import scene_number
from palmbots.runtime.odometry import Odometry
from palmbots.runtime.pair_file import Pair
from palmbots.runtime.robot_program import controller_of, robot_program
from palmbots.runtime.state_keeper import StateKeeper
from palmbots.runtime.stored_state import StoredState, booted
from palmbots.scene.scene import Scene, load_scene
from palmbots.wire import Role

_RECEIVERS: tuple[Role, ...] = ("left", "right", "station")
_STATE_PERIOD_S = 0.05
_STATUS_PERIOD_S = 0.05
_LEASE_S = 0.5
"""For controllers without a lease of their own: how long the partner's news counts."""
_MOST_OVERRUNS = 50
"""The control loop is too slow if more of the last 100 ticks were missed."""


@dataclass(frozen=True)
class RobotEnd:
    """How the program of a robot has run."""

    side: Side
    boots: int
    """How often the robot has booted in its life."""
    mode: str
    """Its last mode."""
    fault: str
    ticks: int
    """Ticks of the control loop."""
    overruns: int
    """Ticks that were missed."""
    jitter: dict[str, int]
    """How many ticks began late by how much."""

    def summary(self) -> dict[str, Any]:
        """The same as a table."""
        return asdict(self)


def run_live_robot(
    pair: Pair, side: Side, rate: float = 1.0, on_line: Callable[[str], None] = print
) -> RobotEnd:
    """Boot the program of one robot, and run it until its driver ends it, or SIGTERM arrives.

    Args:
        pair: the pair.
        side: which of its robots.
        rate: multiple of real time at which a simulated robot runs.
        on_line: called with a line when the program has been held up and starts again.

    Raises:
        PalmbotsError: a file is missing or damaged, an address cannot be used, or the driver is
            lost.
    """
    file = pair.state_file(side)
    with booted(file) as state:
        scene = load_scene(pair.scene())
        period_s = scene.control.period_s / rate
        robot = live_program(pair, side, state, scene, rate)
        link = UdpLink(side, pair.settings.link.addresses())
        with contextlib.closing(link), StateKeeper(file, state) as keeper:
            address = pair.settings.driver.address
            number = scene_number(scene)
            driver = SimulatedDriver(address, side, state.epoch, period_s, number)
            with contextlib.closing(driver):
                clock = control_clock(side, period_s)
                driver.read()  # waits until the world starts: no tick counts before
                loop = _Loop(pair, side, rate, scene, robot, driver, clock.link(link), keeper)
                loop.clock, loop.on_line = clock, on_line
                return loop.run(state)


class _Loop:
    """The control loop of one robot."""

    clock: Any
    on_line: Callable[[str], None]

    def __init__(
        self,
        pair: Pair,
        side: Side,
        rate: float,
        scene: Scene,
        robot: Any,
        driver: SimulatedDriver,
        link: Any,
        keeper: StateKeeper,
    ) -> None:
        self._pair, self._rate, self._scene = pair, rate, scene
        self._side: Side = side
        self._robot, self._driver, self._link, self._keeper = robot, driver, link, keeper
        self._drives = drive_table(scene, side)
        self._period_s = scene.control.period_s
        self._watchdog = ticks_in(scene.control.watchdog_s, self._period_s)
        self._stopping = ticks_in(pair.settings.limits.stopping_s, self._period_s)
        self._rejoins = pair.settings.limits.after_reboot == "rejoin"
        self._ticks = 0

    def run(self, state: StoredState) -> RobotEnd:
        """Tick until the driver or a signal ends it."""
        odometry = Odometry(self._scene.task.distance_m, state.covered_m)
        carries = state.carries and self._rejoins
        with ended_by_signal() as ended, _little_garbage():
            while not ended.is_set():
                elapsed = self.clock.wait()
                if self._robot.wheels and elapsed > self._watchdog:
                    state, carries, elapsed = self._boot(elapsed)
                seen = self._read(state.epoch)
                if seen is None:
                    break
                odometry.take(seen.distance_m, carries)
                reading = self._reading(seen, odometry)
                answer = self._robot.step(min(elapsed, 0xFFFF), reading, self._link.receive())
                self._obey(state.epoch, answer, odometry)
                carries = self._robot.wheels
                self._ticks += 1
        self._driver.stop()
        robot, clock = self._robot, self.clock
        jitter = jitter_table(clock.jitter)
        return RobotEnd(
            self._side, state.epoch, robot.mode, robot.fault, self._ticks, clock.overruns, jitter
        )

    def _boot(self, elapsed: int) -> tuple[StoredState, bool, int]:
        """Start again: in a carry, a program that was held up for longer than the watchdog's time
        may not go on with what it knew (docs/theory/protocols.md)."""
        held_up_s = elapsed * self._period_s
        self.on_line(
            f"{self._side}: was held up for {held_up_s:.2f} s, longer than control.watchdog_s; "
            "starts again"
        )
        state = self._keeper.boot()
        self._robot = live_program(self._pair, self._side, state, self._scene, self._rate)
        self.clock.forget()
        return state, state.carries and self._rejoins, 1

    def _read(self, epoch: int) -> Any:
        """What the driver reads; None: it has ended the carry.

        Raises:
            PalmbotsError: the driver is lost. The others have heard of it.
        """
        try:
            return self._driver.read()
        except PalmbotsError:
            for _ in range(ticks_in(_STATUS_PERIOD_S * self._rate, self._period_s)):
                lost = _core.runtime.Reading(0, False, driver_ok=False)
                for receiver, data, _ in self._robot.step(1, lost, [])[3]:
                    self._link.send(_RECEIVERS[receiver], data)
            self._keeper.keep(StoredState(epoch, False, *self._robot.to_store))
            raise

    def _reading(self, seen: Any, odometry: Odometry) -> Any:
        return _core.runtime.Reading(
            seen.sign,
            seen.palm_at_target,
            driver_ok=self._driver.works,
            storage_ok=self._keeper.works,
            covered=odometry.is_covered,
            overruns=min(self.clock.recent_overruns, 0xFFFF),
            progress=round(65535 * odometry.share),
            stopping=self._stopping,
        )

    def _obey(self, epoch: int, answer: Any, odometry: Odometry) -> None:
        """Store, drive and send what the core has decided."""
        palm, move, stop, packets, *_, assists = answer
        carries, is_stopped = self._robot.to_store
        covered_m = odometry.to_store_m if carries else 0.0
        self._keeper.keep(StoredState(epoch, assists, carries, is_stopped, covered_m))
        self._driver.write(self._drives[palm, move, stop, self._robot.wheels])
        if self.clock.is_stepped:
            self._keeper.settle()
        for receiver, data, _ in packets:
            # What the partner relies on after a boot is stored before it is said. A robot that
            # does not carry promises nothing, and must pass on a stop at once.
            if receiver == 2 or self._keeper.is_done or not self._robot.wheels:
                self._link.send(_RECEIVERS[receiver], data)


@contextlib.contextmanager
def _little_garbage() -> Iterator[None]:
    """What is there stays: to search it for garbage would hold up the loop."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def ticks_in(seconds: float, period_s: float) -> int:
    """The ticks that a time takes, at least 1; rounded up."""
    return max(1, math.ceil(seconds / period_s - 1e-9))


def stopping_limit_s(scene: Scene) -> float:
    """The time in which a robot of the scene brakes from its nominal speed [s]. The time bounds of
    the controllers assume that no robot takes longer."""
    robots = [scene.robot_of(side) for side in SIDES]
    return max(robot.speed_m_s / robot.acceleration_m_s2 for robot in robots)


def live_program(
    pair: Pair, side: Side, state: StoredState, scene: Scene, rate: float = 1.0
) -> Any:
    """The program of one robot of a pair, as it starts after a boot."""
    entry = controller_of(pair)
    if entry.team == "station":
        raise PalmbotsError(
            f"controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    return robot_program(pair, side, state, scene, _settings(pair, scene, entry, rate))


def _settings(pair: Pair, scene: Scene, entry: ControllerEntry, rate: float) -> Any:
    """The settings of the core, in control ticks. The station lives in real time."""
    limits = pair.settings.limits
    bounds = check(entry, scene)
    lease_s = _LEASE_S if bounds is None else bounds.lease_s
    period_s = scene.control.period_s

    def ticks(seconds: float) -> int:
        return ticks_in(seconds, period_s)

    return _core.runtime.RuntimeSettings(
        lease=round(lease_s / period_s),
        station_limit=ticks(limits.station_limit_s * rate),
        time_limit=ticks(limits.time_limit_s),
        travel=0,  # the driver measures the distance
        stopping_limit=ticks(stopping_limit_s(scene)),
        most_overruns=_MOST_OVERRUNS,
        has_radio=entry.uses_radio,
        rejoins=limits.after_reboot == "rejoin",
        stops_without_station=limits.station_lost == "stop",
        stops_without_partner=limits.partner_lost == "stop",
        state_period=ticks(_STATE_PERIOD_S),
        status_period=min(0xFFFF, ticks(_STATUS_PERIOD_S * rate)),
        number=pair.fingerprint(scene),
    )
