# SPDX-License-Identifier: Apache-2.0
"""What is checked before a carry besides the radio: clocks, drivers, key, battery.

A `Check` is one line: what was found, and, if something is wrong, what to do.
"""

import contextlib
import hashlib
import math
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from palmbots._types import SIDES, Side
from palmbots.clocks.control_clock import JITTER_LIMITS_MS, ControlClock
from palmbots.drivers.driver import Drive, Driver, RawAccess, Reading
from palmbots.drivers.hardware import HardwareParameters
from palmbots.errors import PalmbotsError
from palmbots.pair.fault_words import FAULT_WORDS
from palmbots.pair.link_check import LinkFigures
from palmbots.pair.pair_file import Pair
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.scene.scene import Scene

_STATUS_S = 0.05  # between two status packets of a robot, about
_MOST_LATE = 0.1  # share of ticks that a control loop may miss
_MOST_PPM = 1000.0  # a quartz is off by 100 at most; the system may correct by 500
_NOT_MEASURED = 0xFFFF
_PALM_SLACK_S = 2.0
_POLL_S = 0.01
_WELL_SHARE = 0.5  # of a control period that a driver may take; the rest is for radio and log
_NOTICED_S = 0.3  # within which a palm that has been commanded no longer counts as at its target


@dataclass(frozen=True)
class Check:
    """One thing that was looked at."""

    about: str
    """``clock``, ``key``, ``driver``, ``palm``, ``contact``, ``battery`` or ``stopping``."""
    robot: str
    """``left``, ``right``, or empty: this computer."""
    is_well: bool
    text: str
    """What was found."""
    remedy: str = ""
    """What to do, if something is wrong."""
    is_sure: bool = True
    """False: nothing is known to be wrong, but not all could be checked; `text` says what."""


def checks_of_status(
    pair: Pair, scene: Scene, figures: Mapping[Side, LinkFigures], verdicts: Mapping[Any, int]
) -> list[Check]:
    """What the status packets of both robots say."""
    checks = [_key_check(pair, figures, verdicts)]
    for side in SIDES:
        one = figures[side]
        if one.status is None:
            continue
        words = FAULT_WORDS.get(one.fault)
        if words is not None:
            checks.append(Check(words.about, side, False, words.meaning, words.remedy))
        elif one.mode != "stopped":
            checks.append(Check("driver", side, True, "answers"))
        if one.mode == "stopped":
            text = "a stop is in force"
            checks.append(Check("mode", side, False, text, "release it at the station"))
        checks += _battery_check(side, one, pair.settings.hardware.of(side))
        checks.append(_robot_clock(side, one, scene))
    return checks


def _key_check(
    pair: Pair, figures: Mapping[Side, LinkFigures], verdicts: Mapping[Any, int]
) -> Check:
    print_of_key = hashlib.sha256(pair.key).hexdigest()[:4]
    silent = [side for side in SIDES if not figures[side].received]
    wrong = verdicts.get("bad_tag", 0)
    if silent and wrong:
        names = " and ".join(silent)
        return Check(
            "key", "", False,
            f"{wrong} packets have a wrong tag, and {names} is not heard: another key",
            f"copy {pair.settings.pair.key_file} to both robots and the station (mode 600)",
        )  # fmt: skip
    if verdicts.get("wrong_pair", 0) and silent:
        text = "packets of another pair arrive"
        return Check("key", "", False, text, "give both ends the same pair.number")
    same = "" if silent else "; both robots have the same"
    return Check("key", "", True, f"mode 600, fingerprint {print_of_key}{same}")


def _battery_check(side: Side, one: LinkFigures, hardware: HardwareParameters) -> list[Check]:
    value = one.items.get("battery")
    if value is None:
        return []
    if value == _NOT_MEASURED:
        is_needed = hardware.battery_low_v > 0
        remedy = (
            "set hardware.battery_low_v to 0, or use a driver that measures" if is_needed else ""
        )
        return [Check("battery", side, not is_needed, "is not measured", remedy)]
    return [battery_check(side, value / 1000, hardware)]


def battery_check(side: Side, voltage_v: float, hardware: HardwareParameters) -> Check:
    """Whether the voltage suffices."""
    low = hardware.battery_low_v
    if voltage_v < low:
        return Check("battery", side, False, f"{voltage_v:.2f} V, less than {low:g} V", "charge it")
    return Check("battery", side, True, f"{voltage_v:.2f} V")


def _robot_clock(side: Side, one: LinkFigures, scene: Scene) -> Check:
    """The rate of a robot's clock relative to the one of this computer."""
    late = one.items.get("overruns", 0)
    if late > 100 * _MOST_LATE:
        text = f"misses {late} of 100 ticks of its control loop"
        return Check("clock", side, False, text, "end other programs on its computer")
    rate = clock_rate(one.arrivals, scene.control.period_s)
    if rate is None or late > 0:
        why = "some ticks come late" if late else "too few packets"
        return Check("clock", side, True, f"rate not measurable ({why})")
    ppm, error = rate
    text = f"rate {ppm:+.0f} ± {error:.0f} ppm relative to this computer"
    stated = scene.robot_of(side).clock_ppm
    if abs(ppm - stated) > error + _MOST_PPM:
        remedy = f"set robot.{side}.clock_ppm in the scene, or repair the clock"
        return Check("clock", side, False, f"{text}; the scene has {stated:+.0f}", remedy)
    return Check("clock", side, True, text)


def clock_rate(
    arrivals: Sequence[tuple[float, int]], period_s: float
) -> tuple[float, float] | None:
    """How fast the sender's clock runs, and how far that may be off [ppm]; None: not measurable.

    The sender numbers its packets, one each `_STATUS_S` of its clock. Packets may be delayed, but
    never come early: the packets with the least delay in the first and in the last third of the
    time give the rate.
    """
    between_s = max(1, round(_STATUS_S / period_s)) * period_s
    if len(arrivals) < 30:
        return None
    start_s, first = arrivals[0]
    lags = [(now_s - start_s - (n - first) * between_s, now_s) for now_s, n in arrivals]
    third = len(lags) // 3
    (lag, early_s), (other_lag, later_s) = min(lags[:third]), min(lags[-third:])
    span_s = later_s - early_s
    if span_s <= 0:
        return None
    # The least delay of a third is taken to be within the second least one of it.
    errors = [sorted(part)[1][0] - min(part)[0] for part in (lags[:third], lags[-third:])]
    ppm = -1e6 * (other_lag - lag) / span_s
    return ppm, 1e6 * (sum(errors) + 2e-3) / span_s


def check_own_clock(
    period_s: float,
    seconds: float,
    clock: Callable[[], float] = time.monotonic,
    report: Callable[[float], None] = lambda fraction: None,
) -> Check:
    """Whether this computer can run a control loop: its jitter, and the rate of its clock."""
    loop = ControlClock(period_s)
    begin, raw = clock(), time.clock_gettime(time.CLOCK_MONOTONIC_RAW)
    ticks = 0
    while clock() - begin < seconds:
        report((clock() - begin) / seconds)
        loop.wait()
        ticks += 1
    elapsed = clock() - begin
    real = time.clock_gettime(time.CLOCK_MONOTONIC_RAW) - raw
    ppm = 1e6 * (elapsed / real - 1)
    share = loop.overruns / max(1, ticks + loop.overruns)
    limits = JITTER_LIMITS_MS
    worst = max(k for k, count in enumerate(loop.jitter) if count)
    late = f"less than {limits[worst]:g} ms" if worst < len(limits) else "more than 10 ms"
    text = (
        f"{ticks} ticks of {1000 * period_s:g} ms, {100 * share:.1f} % missed, late by {late}; "
        f"rate corrected by {ppm:+.0f} ppm"
    )
    if share > _MOST_LATE:
        return Check("clock", "", False, text, "end other programs, or use a faster computer")
    if abs(ppm) > _MOST_PPM:
        return Check("clock", "", False, text, "let the time service of this computer settle")
    return Check("clock", "", True, text)


def check_driver(
    driver: Driver,
    side: Side,
    scene: Scene,
    hardware: HardwareParameters,
    wait: Callable[[], None] = lambda: time.sleep(_POLL_S),
    clock: Callable[[], float] = time.monotonic,
    silent: str = "start its hardware",
) -> list[Check]:
    """Look at the hardware of a robot: does it answer in time, does the palm move, is a contact
    sensed?

    The wheels do not turn. The palm turns to both of its angles.

    Args:
        driver: of the robot.
        side: of the robot.
        scene: of the pair.
        hardware: of the robot.
        wait: waits between two commands.
        clock: the time [s].
        silent: what to do if the hardware has no reading.
    """
    try:
        return _checked_driver(driver, side, scene, hardware, wait, clock, silent)
    except PalmbotsError as error:
        remedy = "check the power and the cable of the motor board, and [driver]"
        return [Check("driver", side, False, str(error), remedy)]


def _checked_driver(
    driver: Driver,
    side: Side,
    scene: Scene,
    hardware: HardwareParameters,
    wait: Callable[[], None],
    clock: Callable[[], float],
    silent: str,
) -> list[Check]:
    first = driver.read()
    if first is None:
        return [Check("driver", side, False, "gives no reading (None)", silent)]
    palm = scene.palm_of(side)
    angles = [math.radians(angle) for angle in (palm.steep_deg, palm.shallow_deg)]
    # A servo that does not report its angle may begin at any angle.
    whole_turn_s = (hardware.servo_max_deg - hardware.servo_min_deg) / hardware.servo_rate_deg_s
    seen: Reading = first
    stuck = ""
    moved = False
    calls_s: list[tuple[float, float]] = []  # of a read and a write
    for which in (0, 1, 0):
        drive = Drive(which, 0, True, False, angles[which], 0.0)
        begin = clock()
        give_up = begin + whole_turn_s + _PALM_SLACK_S
        while True:
            start = clock()
            driver.write(drive)
            write_s = clock() - start
            wait()
            start = clock()
            newest = driver.read()
            # A guard process takes the time, and the calls here only pass on.
            calls_s.append(getattr(driver, "call_s", None) or (clock() - start, write_s))
            if newest is None or not getattr(driver, "works", True):
                remedy = "check the power and the cable of the motor board"
                loss = getattr(driver, "loss", "")
                if loss:
                    remedy += ", and the driver"
                return [Check("driver", side, False, loss or "ceases to answer", remedy)]
            seen = newest
            moved = moved or not seen.palm_at_target
            if seen.palm_at_target and clock() - begin > _NOTICED_S:
                break
            if clock() > give_up:
                stuck = ("steep", "shallow")[which]
                break
        if stuck:
            break
    driver.stop()
    checks = [_time_check(side, calls_s, scene.control.period_s)]
    if _is_unmeasured(driver):
        text = "not checked: the servo reports no angle; look whether it turns to both angles"
        checks.append(Check("palm", side, True, text, is_sure=False))
    elif stuck:
        text = f"the palm does not reach its {stuck} angle"
        checks.append(Check("palm", side, False, text, "free the palm, or calibrate the servo"))
    elif not moved:
        text = "the palm is always at its target: it does not report that it moves"
        checks.append(Check("palm", side, False, text, "check the servo and its cable"))
    else:
        checks.append(Check("palm", side, True, "moves to both angles, as far as it reports"))
    if seen.has_contact:
        checks.append(
            Check("contact", side, True, f"sensed, sign {seen.sign:+d}".replace("+0", "0"))
        )
    else:
        remedy = "press the palm in the middle while this runs; then check the switches"
        checks.append(Check("contact", side, False, "not sensed", remedy))
    if seen.battery_v is not None:
        checks.append(battery_check(side, seen.battery_v, hardware))
    limit_s = stopping_limit_s(scene)
    if hardware.stopping_s > limit_s + 1e-9:
        text = f"{hardware.stopping_s:g} s, longer than the {limit_s:g} s of the scene's robots"
        remedy = "palmbots calibrate --only stopping, or lower robot.acceleration_m_s2"
        checks.append(Check("stopping", side, False, text, remedy))
    return checks


def _time_check(side: Side, calls_s: Sequence[tuple[float, float]], period_s: float) -> Check:
    """Whether a driver is fast enough: the control loop reads and writes in every tick."""
    read_s, write_s = (statistics.median(times) for times in zip(*calls_s, strict=True))
    text = (
        f"answers; a read takes {1e3 * read_s:.1f} ms and a write {1e3 * write_s:.1f} ms (medians)"
    )
    if read_s + write_s <= _WELL_SHARE * period_s:
        return Check("driver", side, True, text)
    text += f"; allowed: {1e3 * _WELL_SHARE * period_s:g} ms together, half of control.period_s"
    if read_s + write_s > period_s:
        remedy = "let its methods return at once, or raise control.period_s of the scene"
        return Check("driver", side, False, text, remedy)
    return Check("driver", side, True, f"{text}: ticks may be missed", is_sure=False)


def _is_unmeasured(driver: Driver) -> bool:
    """The driver states that its servo reports no angle."""
    if not isinstance(driver, RawAccess):
        return False
    with contextlib.suppress(PalmbotsError):  # a simulated robot without hardware
        raw = driver.read_raw()
        return raw is not None and raw.servo_rad is None
    return False
