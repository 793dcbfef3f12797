# SPDX-License-Identifier: Apache-2.0
"""A robot's program in real time: reads its driver, exchanges packets, and writes its driver.

The compiled core makes all decisions (`_core.runtime.Robot`). This loop only moves bytes: once per
control period it passes readings and packets to the core, and carries out the answer.
"""

import contextlib
import math
import queue
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args

import palmbots._core as _core
from palmbots._types import Side
from palmbots.control.registry import ControllerEntry, check
from palmbots.drivers.driver import Drive, Reading, works
from palmbots.errors import PalmbotsError
from palmbots.runtime.control_clock import ControlClock
from palmbots.runtime.drive_table import drive_table
from palmbots.runtime.live_ends import open_pair_driver, open_pair_link
from palmbots.runtime.observation import Observation, Observer, observation_socket
from palmbots.runtime.pair_file import Pair
from palmbots.runtime.reading_gauge import ReadingGauge
from palmbots.runtime.robot_program import controller_of, robot_program
from palmbots.runtime.stored_state import StoredState, booted, write_state
from palmbots.scene.scene import Scene, load_scene
from palmbots.wire import Role, Verdict

_RECEIVERS: tuple[Role, ...] = ("left", "right", "station")
_STATE_PERIOD_S = 0.05
_STATUS_PERIOD_S = 0.05
_LEASE_S = 0.5
"""For controllers without a lease of their own: how long the partner's news counts."""
_MOST_OVERRUNS = 50
"""The control loop is too slow if more of the last 100 ticks were missed."""


@dataclass(frozen=True)
class RobotRun:
    """What the program of a robot has done, from its boot to its end."""

    boots: int
    """How often the robot has booted."""
    link: dict[str, Any]
    """What was exchanged with each other end (`palmbots.links.link_meter`)."""
    verdicts: dict[str, int]
    """Received packets by verdict."""


def run_live_robot(pair: Pair, side: Side, rate: float = 1.0) -> RobotRun:
    """Boot the program of one robot, and run it until its driver is gone, or it is ended.

    Ctrl-C and SIGTERM end it: the wheels stop, and the palm keeps its angle.

    Args:
        pair: the pair.
        side: which of its robots.
        rate: multiple of real time at which a simulated robot runs.

    Raises:
        PalmbotsError: a file is missing or damaged, or an address cannot be used.
    """
    with booted(pair.state_file(side)) as state:
        return _run(pair, side, state, rate)


def _run(pair: Pair, side: Side, state: StoredState, rate: float) -> RobotRun:
    file = pair.state_file(side)
    scene = load_scene(pair.scene())
    live_program(pair, side, state, scene)  # refuses before anything is opened
    period_s = scene.control.period_s
    with contextlib.ExitStack() as stack:
        link = stack.enter_context(contextlib.closing(open_pair_link(pair, side)))
        observer = Observer(observation_socket(file))
        stack.enter_context(contextlib.closing(observer))
        storage = stack.enter_context(_Storage(file, state))
        driver = open_pair_driver(pair, side, scene, epoch=state.epoch, rate=rate)
        stack.enter_context(contextlib.closing(driver))
        first = driver.read()  # waits until the world starts: no tick counts before
        gauge = ReadingGauge(pair, side, scene, first)
        robot = live_program(pair, side, state, scene, has_encoders=gauge.has_encoders)
        ends = stack.enter_context(_ended_by_signals())
        clock = ControlClock(period_s / rate)
        drives = drive_table(scene, side)
        while not ends.is_set():
            elapsed = clock.wait()
            seen = driver.read()
            if seen is None:
                break
            reading = gauge.reading(
                seen,
                rests=not robot.wheels,
                driver_ok=works(driver),
                storage_ok=storage.works,
                overruns=min(clock.recent_overruns, 0xFFFF),
            )
            palm, move, stop, packets, *_, assists = robot.step(
                min(elapsed, 0xFFFF), reading, link.receive()
            )
            storage.keep(StoredState(state.epoch, assists, *robot.to_store))
            drive = drives[palm, move, stop, robot.wheels]
            driver.write(drive)
            for receiver, data, _ in packets:
                # What the partner relies on after a boot is stored before it is said. A robot
                # that does not carry promises nothing, and must pass on a stop at once.
                if receiver == 2 or storage.is_done or not robot.wheels:
                    link.send(_RECEIVERS[receiver], data)
            if observer.is_watched:
                observer.send(_observation(robot, seen, drive, clock.recent_overruns))
        return RobotRun(state.epoch, link.summary(), _verdicts(robot))


def _verdicts(robot: Any) -> dict[str, int]:
    """How many received packets had each verdict."""
    return {name: robot.count(number) for number, name in enumerate(get_args(Verdict))}


def _observation(robot: Any, seen: Reading, drive: Drive, overruns: int) -> Observation:
    return Observation(
        time_s=time.monotonic(),
        mode=robot.mode,
        fault=robot.fault,
        sign=seen.sign,
        has_contact=seen.has_contact,
        palm_at_target=seen.palm_at_target,
        palm_rad=drive.palm_rad,
        speed_m_s=drive.speed_m_s,
        distance_m=None if math.isnan(seen.distance_m) else seen.distance_m,
        battery_v=seen.battery_v,
        overruns=overruns,
        received=_verdicts(robot),
    )


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[threading.Event]:
    """An event that Ctrl-C and SIGTERM set; a second one of them ends the process at once."""
    ends = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield ends
        return
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.getsignal(number) for number in numbers}

    def end(*_: object) -> None:
        ends.set()
        for number, handler in before.items():
            signal.signal(number, handler)

    for number in numbers:
        signal.signal(number, end)
    try:
        yield ends
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def live_program(
    pair: Pair, side: Side, state: StoredState, scene: Scene, *, has_encoders: bool = True
) -> Any:
    """The program of one robot of a pair, as it starts after a boot.

    Without encoders the distance is covered after the time that it takes at nominal speed.
    """
    entry = controller_of(pair)
    if entry.team == "station":
        raise PalmbotsError(
            f"controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    speed_m_s = scene.robot_of(side).speed_m_s
    travel_s = 0.0
    if not has_encoders:
        limit_s = pair.settings.limits.time_limit_s
        travel_s = scene.task.distance_m / speed_m_s if speed_m_s > 0 else limit_s
    return robot_program(pair, side, state, scene, _settings(pair, scene, entry, travel_s))


def _settings(pair: Pair, scene: Scene, entry: ControllerEntry, travel_s: float) -> Any:
    """The settings of the core, in control ticks."""
    limits = pair.settings.limits
    bounds = check(entry, scene)
    lease_s = _LEASE_S if bounds is None else bounds.lease_s
    period_s = scene.control.period_s

    def ticks(seconds: float) -> int:
        return max(1, round(seconds / period_s))

    return _core.runtime.RuntimeSettings(
        lease=ticks(lease_s),
        station_limit=ticks(limits.station_limit_s),
        time_limit=ticks(limits.time_limit_s),
        travel=ticks(travel_s) if travel_s > 0 else 0,  # 0: the driver measures the distance
        watchdog=ticks(scene.control.watchdog_s),
        most_overruns=_MOST_OVERRUNS,
        has_radio=entry.uses_radio,
        rejoins=limits.after_reboot == "rejoin",
        stops_without_station=limits.station_lost == "stop",
        stops_without_partner=limits.partner_lost == "stop",
        state_period=ticks(_STATE_PERIOD_S),
        status_period=ticks(_STATUS_PERIOD_S),
        number=pair.fingerprint(scene),
    )


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
