# SPDX-License-Identifier: Apache-2.0
"""A robot's program in real time: its driver, its link, and the core's program with its settings.

The loop is that of every robot (`palmbots.robot.robot_loop`).
"""

import contextlib
import math
from collections.abc import Callable
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util import process_clock
from palmbots._util.end_signal import ended_by_signal
from palmbots.clocks.control_clock import control_clock
from palmbots.control.dead_band import warnings_before
from palmbots.control.registry import ControllerEntry
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import PalmbotsError
from palmbots.pair.link_check import NEWS_LEASE_S
from palmbots.pair.live_ends import check_pair_arms, open_pair_driver, open_pair_link
from palmbots.pair.pair_file import Pair
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.pair.stored_state import StoredState, booted
from palmbots.robot.core_program import check_works, controller_of, robot_program
from palmbots.robot.logged_steps import RobotLog
from palmbots.robot.mode_lines import ModeLines
from palmbots.robot.observation import Observation, Observer, observation_socket
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.robot.robot_loop import RobotEnd, RobotLoop, Step
from palmbots.robot.storage_thread import StateWriter
from palmbots.robot.waiting_notices import (
    PATIENCE_S,
    Silence,
    Waiting,
    hardware_text,
    partner_of,
    reading_text,
)
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.wire import Role

_STATE_PERIOD_S = 0.05
_STATUS_PERIOD_S = 0.05
_MOST_OVERRUNS = 50
"""The control loop is too slow if more of the last 100 ticks were missed."""


def run_live_robot(
    pair: Pair, side: Side, rate: float = 1.0, on_line: Callable[[str], None] = print
) -> RobotEnd:
    """Boot the program of one robot, and run it until its driver ends it, or SIGTERM or Ctrl-C.

    Args:
        pair: the pair.
        side: which of its robots.
        rate: multiple of real time at which a simulated robot runs.
        on_line: called with a line when the program has been held up and starts again, or cannot
            log; on a real robot also when its mode or fault changes.

    Raises:
        PalmbotsError: a file is missing or damaged, an address cannot be used, or the driver is
            lost.
    """
    file = pair.state_file(side)
    scene = pair.checked_scene()
    check_works(scene, side)
    check_pair_arms(pair, scene)
    with booted(file) as state, contextlib.ExitStack() as stack:
        live_program(pair, side, state, scene, rate)  # refuses before anything is opened
        # World and station of simulated robots print what these would.
        is_real = pair.settings.driver.kind != "simulated"
        if is_real:
            for text in warnings_before(scene, controller_of(pair)):
                on_line(f"warning: {text}")
        link = stack.enter_context(contextlib.closing(open_pair_link(pair, side)))
        observer = stack.enter_context(contextlib.closing(Observer(observation_socket(file))))
        keeper = stack.enter_context(StateWriter(file, state))
        waits = Waiting(on_line)
        stack.callback(waits.end)
        waits.begin(hardware_text(pair, side))
        driver = open_pair_driver(
            pair, side, scene, epoch=state.epoch, rate=rate, stored_arm=state.arm
        )
        stack.enter_context(contextlib.closing(driver))
        stride = to_spec(scene).robots[SIDES.index(side)].stride
        clock = control_clock(side, scene.control.period_s / rate, stride)
        waits.begin(reading_text(pair, side))
        first = driver.read()  # waits until the hardware or the world starts: no tick counts before
        waits.end()
        clock.run_at(getattr(driver, "clock_rate", 1.0))
        gauge = ReadingGauge(pair, side, scene, first, state)

        def start(state: StoredState) -> tuple[Any, RobotLog]:
            has_encoders = gauge.has_encoders
            return logged_program(
                pair, side, state, scene, rate, on_line, has_encoders=has_encoders
            )

        period_s = scene.control.period_s
        modes = ModeLines(side, on_line)
        silence = _silence(pair, side, scene, ticks_in(PATIENCE_S * rate, period_s), on_line)

        def watch(loop: RobotLoop, step: Step) -> None:
            silence.step(loop.heard)
            if is_real:
                modes.take(loop.robot)
            _observe(observer, loop, step)

        loop = RobotLoop(
            side, scene, start, driver, clock.link(link), clock, keeper, gauge,
            watchdog=ticks_in(scene.control.watchdog_s, period_s),
            last_ticks=ticks_in(_STATUS_PERIOD_S * rate, period_s),
            watch=watch, on_line=on_line,
        )  # fmt: skip
        # Until the log is closed: a signal that comes while the program ends must not cut it off.
        ended = stack.enter_context(ended_by_signal())
        loop.start(state, may_resume=pair.settings.limits.after_reboot == "rejoin")
        stack.callback(loop.close)
        loop.run(ended)
        return loop.end(getattr(link, "details", {}))


def _observe(observer: Observer, loop: RobotLoop, step: Step) -> None:
    """Show a step to a program that watches, if there is one."""
    if not observer.is_watched:
        return
    seen, drive, robot = step.seen, step.drive, loop.robot
    observation = Observation(
        time_s=process_clock.monotonic(),
        mode=robot.mode,
        fault=robot.fault,
        sign=seen.sign,
        has_contact=seen.has_contact,
        palm_at_target=seen.palm_at_target,
        palm_rad=drive.palm_rad,
        speed_m_s=drive.speed_m_s,
        distance_m=None if math.isnan(seen.distance_m) else seen.distance_m,
        battery_v=seen.battery_v,
        overruns=loop.clock.recent_overruns,
        received=loop.verdicts(),
    )
    observer.send(observation)


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
) -> tuple[Any, RobotLog]:
    """The same program as `live_program`, and a log of its own."""
    program = live_program(pair, side, state, scene, rate, has_encoders=has_encoders)
    travel_s = _travel_s(pair, side, scene, has_encoders)
    settings = core_settings(pair, scene, controller_of(pair), travel_s, rate)
    return program, RobotLog(pair, side, state, scene, settings, on_warning)


def _silence(
    pair: Pair, side: Side, scene: Scene, patience: int, on_line: Callable[[str], None]
) -> Silence:
    """A watch on which ends a robot hears; the partner only if both work and use the radio."""
    ends: dict[Role, str] = pair.settings.link.addresses()
    del ends[side]
    if not controller_of(pair).uses_radio or partner_of(side) not in scene.working_sides:
        del ends[partner_of(side)]
    return Silence(side, ends, patience, on_line)


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
    lease_s = bounds_of(scene).lease_s if entry.has_time_bounds else NEWS_LEASE_S
    period_s = scene.control.period_s
    is_alone = len(scene.working_sides) == 1  # there is no partner

    def ticks(seconds: float) -> int:
        return ticks_in(seconds, period_s)

    return {
        "lease": round(lease_s / period_s),
        "station_limit": ticks(limits.station_limit_s * rate),
        "time_limit": ticks(limits.time_limit_s),
        "travel": ticks(travel_s) if travel_s > 0 else 0,  # 0: the driver measures the distance
        "stopping_limit": ticks(stopping_limit_s(scene)),
        "most_overruns": _MOST_OVERRUNS,
        "has_radio": not is_alone and (entry.uses_radio or to_spec(scene).uses_floor),
        "rejoins": limits.after_reboot == "rejoin",
        "stops_without_station": limits.station_lost == "stop",
        "stops_without_partner": limits.partner_lost == "stop",
        "state_period": 0 if is_alone else ticks(_STATE_PERIOD_S),
        "status_period": min(0xFFFF, ticks(_STATUS_PERIOD_S * rate)),
        "number": 0 if is_alone else pair.fingerprint(scene),
        "order_age": ticks(limits.order_age_s * rate),
    }
