# SPDX-License-Identifier: Apache-2.0
"""A robot's program in real time: reads its driver, exchanges packets, and writes its driver.

The compiled core makes all decisions (`_core.runtime.Robot`). This loop only moves bytes: once per
control period it passes readings and packets to the core, and carries out the answer.
"""

import contextlib
import gc
import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any, get_args

import palmbots._core as _core
from palmbots._types import Side
from palmbots._util import process_clock
from palmbots._util.end_signal import ended_by_signal
from palmbots.clocks.control_clock import control_clock, jitter_table
from palmbots.control.registry import ControllerEntry, check
from palmbots.drivers.driver import Drive, Driver, Reading, works
from palmbots.errors import PalmbotsError
from palmbots.pair.drive_table import drive_table
from palmbots.pair.live_ends import open_pair_driver, open_pair_link
from palmbots.pair.pair_file import Pair
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.pair.stored_state import StoredState, booted
from palmbots.robot.logged_robot import LoggedRobot
from palmbots.robot.observation import Observation, Observer, observation_socket
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.robot.robot_program import controller_of, robot_program
from palmbots.robot.state_keeper import StateKeeper
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
    link: dict[str, Any]
    """What was exchanged with each other end (`palmbots.links.link_meter`)."""
    verdicts: dict[str, int]
    """Received packets by verdict."""

    def summary(self) -> dict[str, Any]:
        """The same as a table."""
        return asdict(self)


def run_live_robot(
    pair: Pair, side: Side, rate: float = 1.0, on_line: Callable[[str], None] = print
) -> RobotEnd:
    """Boot the program of one robot, and run it until its driver ends it, or SIGTERM or Ctrl-C.

    Args:
        pair: the pair.
        side: which of its robots.
        rate: multiple of real time at which a simulated robot runs.
        on_line: called with a line when the program has been held up and starts again, or cannot
            log.

    Raises:
        PalmbotsError: a file is missing or damaged, an address cannot be used, or the driver is
            lost.
    """
    file = pair.state_file(side)
    with booted(file) as state, contextlib.ExitStack() as stack:
        scene = load_scene(pair.scene())
        live_program(pair, side, state, scene, rate)  # refuses before anything is opened
        link = stack.enter_context(contextlib.closing(open_pair_link(pair, side)))
        observer = stack.enter_context(contextlib.closing(Observer(observation_socket(file))))
        keeper = stack.enter_context(StateKeeper(file, state))
        driver = open_pair_driver(pair, side, scene, epoch=state.epoch, rate=rate)
        stack.enter_context(contextlib.closing(driver))
        clock = control_clock(side, scene.control.period_s / rate, scene.stride_of(side))
        first = driver.read()  # waits until the hardware or the world starts: no tick counts before
        clock.run_at(getattr(driver, "clock_rate", 1.0))
        gauge = ReadingGauge(pair, side, scene, first, state.covered_m)
        loop = _Loop(pair, side, rate, scene, driver, keeper, gauge)
        loop.link, loop.clock, loop.observer = clock.link(link), clock, observer
        loop.on_line = on_line
        # Until the log is closed: a signal that comes while the program ends must not cut it off.
        ended = stack.enter_context(ended_by_signal())
        loop.start(state)
        stack.callback(loop.close)
        loop.run(ended)
        return loop.end(link.summary())


class _Loop:
    """The control loop of one robot."""

    link: Any
    clock: Any
    observer: Observer
    on_line: Callable[[str], None]

    def __init__(
        self,
        pair: Pair,
        side: Side,
        rate: float,
        scene: Scene,
        driver: Driver,
        keeper: StateKeeper,
        gauge: ReadingGauge,
    ) -> None:
        self._pair, self._rate, self._scene = pair, rate, scene
        self._side: Side = side
        self._driver, self._keeper, self._gauge = driver, keeper, gauge
        self._drives = drive_table(scene, side)
        self._period_s = scene.control.period_s
        self._watchdog = ticks_in(scene.control.watchdog_s, self._period_s)
        self._rejoins = pair.settings.limits.after_reboot == "rejoin"
        self._ticks = 0
        self._robot: LoggedRobot | None = None

    def start(self, state: StoredState) -> None:
        """Start the program, with a log of its own."""
        self._epoch = state.epoch
        self._carries = state.carries and self._rejoins
        self.close()
        self._robot = logged_program(
            self._pair,
            self._side,
            state,
            self._scene,
            self._rate,
            self.on_line,
            has_encoders=self._gauge.has_encoders,
        )

    def close(self) -> None:
        """Write what is left of the log."""
        if self._robot is not None:
            self._robot.close()

    @property
    def robot(self) -> LoggedRobot:
        """The program."""
        assert self._robot is not None
        return self._robot

    def run(self, ended: threading.Event) -> None:
        """Tick until the driver ends it, or the event is set."""
        with _little_garbage():
            while not ended.is_set():
                elapsed = self.clock.wait()
                if self.robot.wheels and elapsed > self._watchdog:
                    elapsed = self._boot(elapsed)
                seen = self._read()
                if seen is None:
                    break
                values = self._gauge.take(
                    seen,
                    carries=self._carries,
                    driver_ok=works(self._driver),
                    storage_ok=self._keeper.works,
                    overruns=min(self.clock.recent_overruns, 0xFFFF),
                )
                reading = self.robot.reading(**values)
                answer = self.robot.step(min(elapsed, 0xFFFF), reading, self.link.receive())
                drive = self._obey(answer)
                self._carries = self.robot.wheels
                self._ticks += 1
                if self.observer.is_watched:
                    self.observer.send(self._observation(seen, drive))
        self._driver.stop()

    def end(self, link: dict[str, Any]) -> RobotEnd:
        """How it has run."""
        robot, clock = self.robot, self.clock
        return RobotEnd(
            self._side,
            self._epoch,
            robot.mode,
            robot.fault,
            self._ticks,
            clock.overruns,
            jitter_table(clock.jitter),
            link,
            self._verdicts(),
        )

    def _boot(self, elapsed: int) -> int:
        """Start again: in a carry, a program that was held up for longer than the watchdog's time
        may not go on with what it knew (docs/theory/protocols.md)."""
        held_up_s = elapsed * self._period_s
        self.on_line(
            f"{self._side}: was held up for {held_up_s:.2f} s, longer than control.watchdog_s; "
            "starts again"
        )
        self.start(self._keeper.boot())
        self.clock.forget()
        return 1

    def _read(self) -> Reading | None:
        """What the driver reads; None: it has ended the carry.

        Raises:
            PalmbotsError: the driver is lost. The others have heard of it.
        """
        try:
            return self._driver.read()
        except PalmbotsError:
            for _ in range(ticks_in(_STATUS_PERIOD_S * self._rate, self._period_s)):
                lost = self.robot.reading(0, False, driver_ok=False)
                for receiver, data, _ in self.robot.step(1, lost, [])[3]:
                    self.link.send(_RECEIVERS[receiver], data)
            self._keeper.keep(StoredState(self._epoch, False, *self.robot.to_store))
            raise

    def _obey(self, answer: Any) -> Drive:
        """Store, drive and send what the core has decided."""
        palm, move, stop, packets, *_, assists = answer
        carries, is_stopped = self.robot.to_store
        covered_m = self._gauge.to_store_m if carries else 0.0
        self._keeper.keep(StoredState(self._epoch, assists, carries, is_stopped, covered_m))
        drive = self._drives[palm, move, stop, self.robot.wheels]
        self._driver.write(drive)
        if self.clock.is_stepped:
            self._keeper.settle()
        for receiver, data, _ in packets:
            # What the partner relies on after a boot is stored before it is said. A robot that
            # does not carry promises nothing, and must pass on a stop at once.
            if receiver == 2 or self._keeper.is_done or not self.robot.wheels:
                self.link.send(_RECEIVERS[receiver], data)
            else:
                self.robot.withhold(receiver)
        return drive

    def _verdicts(self) -> dict[str, int]:
        return {name: self.robot.count(number) for number, name in enumerate(get_args(Verdict))}

    def _observation(self, seen: Reading, drive: Drive) -> Observation:
        return Observation(
            time_s=process_clock.monotonic(),
            mode=self.robot.mode,
            fault=self.robot.fault,
            sign=seen.sign,
            has_contact=seen.has_contact,
            palm_at_target=seen.palm_at_target,
            palm_rad=drive.palm_rad,
            speed_m_s=drive.speed_m_s,
            distance_m=None if math.isnan(seen.distance_m) else seen.distance_m,
            battery_v=seen.battery_v,
            overruns=self.clock.recent_overruns,
            received=self._verdicts(),
        )


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


def logged_program(
    pair: Pair,
    side: Side,
    state: StoredState,
    scene: Scene,
    rate: float,
    on_warning: Callable[[str], None],
    *,
    has_encoders: bool = True,
) -> LoggedRobot:
    """The same program as `live_program`, with a log."""
    program = live_program(pair, side, state, scene, rate, has_encoders=has_encoders)
    travel_s = _travel_s(pair, side, scene, has_encoders)
    settings = core_settings(pair, scene, controller_of(pair), travel_s, rate)
    return LoggedRobot(program, pair, side, state, scene, settings, on_warning)


def live_program(
    pair: Pair,
    side: Side,
    state: StoredState,
    scene: Scene,
    rate: float = 1.0,
    *,
    has_encoders: bool = True,
) -> Any:
    """The program of one robot of a pair, as it starts after a boot.

    Without encoders the distance is covered after the time that it takes at nominal speed.
    """
    entry = controller_of(pair)
    if entry.team == "station":
        raise PalmbotsError(
            f"controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    travel_s = _travel_s(pair, side, scene, has_encoders)
    settings = _core.runtime.RuntimeSettings(**core_settings(pair, scene, entry, travel_s, rate))
    return robot_program(pair, side, state, scene, settings)


def _travel_s(pair: Pair, side: Side, scene: Scene, has_encoders: bool) -> float:
    """The time in place of the distance; 0: the driver measures the distance."""
    if has_encoders:
        return 0.0
    speed_m_s = scene.robot_of(side).speed_m_s
    limit_s = pair.settings.limits.time_limit_s
    return scene.task.distance_m / speed_m_s if speed_m_s > 0 else limit_s


def core_settings(
    pair: Pair, scene: Scene, entry: ControllerEntry, travel_s: float, rate: float = 1.0
) -> dict[str, Any]:
    """The arguments of the core's `RuntimeSettings`, in control ticks. The station lives in real
    time."""
    limits = pair.settings.limits
    bounds = check(entry, scene)
    lease_s = _LEASE_S if bounds is None else bounds.lease_s
    period_s = scene.control.period_s

    def ticks(seconds: float) -> int:
        return ticks_in(seconds, period_s)

    return {
        "lease": round(lease_s / period_s),
        "station_limit": ticks(limits.station_limit_s * rate),
        "time_limit": ticks(limits.time_limit_s),
        "travel": ticks(travel_s) if travel_s > 0 else 0,  # 0: the driver measures the distance
        "stopping_limit": ticks(stopping_limit_s(scene)),
        "most_overruns": _MOST_OVERRUNS,
        "has_radio": entry.uses_radio,
        "rejoins": limits.after_reboot == "rejoin",
        "stops_without_station": limits.station_lost == "stop",
        "stops_without_partner": limits.partner_lost == "stop",
        "state_period": ticks(_STATE_PERIOD_S),
        "status_period": min(0xFFFF, ticks(_STATUS_PERIOD_S * rate)),
        "number": pair.fingerprint(scene),
    }
