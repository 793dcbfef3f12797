# SPDX-License-Identifier: Apache-2.0
"""The steps of a calibration: what a person is asked to do, and what is computed from the answers.

Every step returns findings, whose values go into ``[hardware.SIDE]`` of the ``pair.toml``. Each
step uses what the earlier ones have found.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

from palmbots.drivers.arm import ArmShape
from palmbots.drivers.hardware import HardwareParameters, servo_angle
from palmbots.errors import PalmbotsError
from palmbots.pair.calibration_bench import Machine, Person
from palmbots.pair.estimates import (
    PROTRACTOR,
    TAPE_M,
    Drive,
    Estimate,
    line_estimates,
    wheel_estimates,
)
from palmbots.scene.robot_section import Zone

_RAMP_M_S = 0.001  # step of the commanded speed in the search for the dead zone
_HOLD_S = (0.3, 3.0)  # shortest and longest time for which a command is held
_STAYS_M_S = 0.006  # the command goes on by this much after the wheels have stopped
_SETTLE_S = 0.1  # at the start of a hold, until the wheels follow
_FASTEST_M_S = 0.2
_DRIVE_M_S = 0.08
_STOPS = 5
_MOST_STOPS = 10
_STILL_S = 0.5
_PALM_ANGLES = 7
_PALM_MARGINS_DEG = (-10.0, 20.0)  # beyond the palm angles of the scene
_SERVO_SETTLE_S = 0.5
_ARM_SHARES = (0.25, 0.4, 0.55, 0.7, 0.85)  # of the way of the arm; lower, the nose may touch
_OVERSHOOT_M = 0.001  # a hand that moves a rod slowly stops within this; assumed
_DIGITS = 6


@dataclass(frozen=True)
class Task:
    """What the robot is calibrated for."""

    length_m: float
    """Length of the drive along the tape."""
    speed_m_s: float
    """Nominal speed, from which the robot has to stop."""
    palm_deg: tuple[float, float]
    """Shallow and steep angle of the palm."""
    palm_half_m: float
    """Half the length of the palm."""
    arm: ArmShape | None = None
    """What the job of the scene asks of the arm; None: it is not on the floor."""


@dataclass(frozen=True)
class Finding:
    """One value of the hardware."""

    key: str
    """In ``[hardware]``."""
    value: Any
    """As it is written; None: it is a part of another one."""
    estimate: Estimate | None
    """In the unit of the key; None: it has no interval."""
    note: str = ""
    """What else the user has to know."""


def calibrate(
    machine: Machine, person: Person, task: Task, steps: Iterable[str] = ()
) -> list[Finding]:
    """Run the steps of these names, or all; returns what they have found.

    Raises:
        PalmbotsError: the hardware does not do what it is commanded, or answers contradict each
            other.
    """
    found: list[Finding] = []
    chosen = [*steps] or [*STEPS]
    for name, step in STEPS.items():
        if name not in chosen:
            continue
        new = step(machine, person, task)
        found += new
        machine.hardware = HardwareParameters.model_validate(
            machine.hardware.model_dump() | values_of(new)
        )
    return found


class ZoneTable(TypedDict):
    """A switch as in the file."""

    sign: Literal["-", "0", "+"]
    from_m: float
    to_m: float


def values_of(findings: Iterable[Finding]) -> dict[str, float | list[ZoneTable]]:
    """What is to be written, by key, as plain values."""
    written = {one.key: one.value for one in findings if one.value is not None}
    return {
        key: [zone.model_dump() for zone in value] if isinstance(value, tuple) else value
        for key, value in written.items()
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _finding(key: str, estimate: Estimate, value: float | None = None, note: str = "") -> Finding:
    return Finding(key, _rounded(estimate.value if value is None else value), estimate, note)


# --- dead zone and stiction ----------------------------------------------------------------------


def dead_zone(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """The commands at which the wheels begin to turn and stop turning, from the encoders."""
    person.ready(
        "Put the robot on the floor with half a metre of free floor before it. It moves slowly."
    )
    radius = machine.hardware.wheel_radius_m
    count_m = machine.count_rad * radius
    hold_s = min(max(count_m / _RAMP_M_S, _HOLD_S[0]), _HOLD_S[1])

    def held(speed_m_s: float) -> tuple[bool, bool]:
        """Whether each wheel turns while a command is held."""
        before = None
        counted = [False, False]
        for tick in range(math.ceil(hold_s / machine.period_s)):
            counts = machine.counts(machine.step(speed_m_s / radius, speed_m_s / radius))
            if before is not None and tick * machine.period_s > _SETTLE_S:
                for wheel in (0, 1):
                    counted[wheel] = counted[wheel] or counts[wheel] != before[wheel]
            before = counts
        return counted[0], counted[1]

    # A wheel that has begun to turn is faster by one step of the command in each hold. It counts at
    # the latest when it has turned by one count.
    late = 0
    while _RAMP_M_S * hold_s * late * (late + 1) / 2 < count_m:
        late += 1
    starts: dict[int, float] = {}
    command = 0.0
    while len(starts) < 2:
        command += _RAMP_M_S
        if command > _FASTEST_M_S:
            machine.stop()
            raise PalmbotsError(
                f"wheels: they do not turn up to a command of {_FASTEST_M_S:g} m/s; allowed: a "
                "motor board that has power"
            )
        for wheel, turns in enumerate(held(command)):
            if turns:
                starts.setdefault(wheel, command)
    stiction = Estimate(
        max(starts.values()),
        max(0.0, min(starts.values()) - (late + 1) * _RAMP_M_S),
        max(starts.values()),
    )
    command += 10 * _RAMP_M_S
    held(command)
    # The first command after the last one at which each wheel has counted. A wheel whose speed
    # happens to be 0 for a moment counts again; one that has stopped does not.
    stops = {0: command, 1: command}
    while command > 0 and min(stops.values()) - command < _STAYS_M_S:
        command = max(0.0, command - _RAMP_M_S)
        for wheel, turns in enumerate(held(command)):
            if turns:
                stops[wheel] = max(0.0, command - _RAMP_M_S)
    machine.rest(_STILL_S)
    unseen_m_s = count_m / (hold_s - _SETTLE_S)
    low = max(0.0, min(stops.values()) - unseen_m_s)
    high = max(stops.values()) + _RAMP_M_S
    dead = Estimate((low + high) / 2, low, high)
    value = 0.0 if low == 0 and high <= 2 * _RAMP_M_S else dead.value
    # A wheel has to start for certain, so the end of the interval is written.
    start = max(stiction.high, value) if stiction.high > 2 * _RAMP_M_S else value
    return [_finding("dead_zone_m_s", dead, value), _finding("stiction_m_s", stiction, start)]


# --- wheels and trim -----------------------------------------------------------------------------


def wheels(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """`wheel_scale` and `trim`, from a drive along a tape."""
    length = task.length_m
    machine.counts(machine.read())
    person.ready(
        f"Lay out a tape of at least {length + 0.3:g} m. Put the robot at its start: the mark "
        "halfway between the two wheels at 0 mm, on the edge of the tape, and the robot looking "
        "along it."
    )
    turn = length / 2 / machine.hardware.wheel_radius_m
    one = machine.drive(_DRIVE_M_S, turn)
    limit_mm = 500.0 * length
    half = person.number(
        "The robot is halfway. How far is its mark to the left of the edge? (right: negative)",
        "mm", -limit_mm, limit_mm,
    )  # fmt: skip
    two = machine.drive(_DRIVE_M_S, turn)
    along = person.number("How far has it come along the tape?", "mm", 500 * length, 2000 * length)
    offset = person.number(
        "How far is its mark to the left of the edge? (right: negative)", "mm", -limit_mm, limit_mm
    )
    rad = machine.count_rad
    measured = Drive(
        half / 1000, along / 1000, offset / 1000,
        (one[0] * rad, one[1] * rad),
        ((one[0] + two[0]) * rad, (one[1] + two[1]) * rad), rad,
    )  # fmt: skip
    hardware = machine.hardware
    scale, trim = wheel_estimates(measured, hardware.wheel_radius_m, hardware.wheel_separation_m)
    return [_finding("wheel_scale", scale), _finding("trim", trim)]


# --- stopping time -------------------------------------------------------------------------------


def stopping(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """The time in which the wheels come to rest, from the encoders."""
    speed = task.speed_m_s
    machine.counts(machine.read())
    person.ready(
        f"Put the robot where it has {2 * _MOST_STOPS * speed:.1f} m of free floor before it. It "
        f"stops {_STOPS} times, or up to {_MOST_STOPS} times on a busy computer."
    )
    times: list[Estimate] = []
    for tries in range(_MOST_STOPS):
        missed = machine.missed
        one = _one_stop(machine, speed)
        # A late tick of this program makes a stop look longer. Such stops only fill up the number.
        if machine.missed == missed or _MOST_STOPS - tries <= _STOPS - len(times):
            times.append(one)
        if len(times) == _STOPS:
            break
    low, high = min(one.low for one in times), max(one.high for one in times)
    middle = sum(one.value for one in times) / len(times)
    # A longer time is the safe one: the end of the interval is written.
    return [_finding("stopping_s", Estimate(middle, low, high), max(0.01, high))]


def _one_stop(machine: Machine, speed_m_s: float) -> Estimate:
    hardware, period_s = machine.hardware, machine.period_s
    dead, start = hardware.dead_zone_m_s, hardware.stiction_m_s
    counts = machine.counts(machine.read())
    for tick in range(math.ceil(1.0 / period_s)):
        command = speed_m_s + dead if tick * period_s > _STILL_S else max(speed_m_s + dead, start)
        rate = command / hardware.wheel_radius_m
        counts = machine.counts(machine.step(rate, rate))
    last = ticks = 0
    while (ticks - last) * period_s < _STILL_S:
        ticks += 1
        now = machine.counts(machine.step(0.0, 0.0))
        if now != counts:
            last, counts = ticks, now
    counted_s = last * period_s
    # After the last count a wheel moves by less than one further count, while it brakes evenly: for
    # the whole time T, T − counted ≤ √(2 count T / speed).
    share = math.sqrt(2 * machine.count_rad * hardware.wheel_radius_m / speed_m_s)
    longest_s = ((share + math.sqrt(share**2 + 4 * counted_s)) / 2) ** 2
    low, high = max(0.0, counted_s - 2 * period_s), longest_s + period_s
    return Estimate((low + high) / 2, low, high)


# --- palm ----------------------------------------------------------------------------------------


def palm(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """`servo_zero_deg` and `servo_scale`, from angles that a person reads off a protractor."""
    hardware = machine.hardware
    person.ready(
        "Take everything off the palm, and put the robot on a level floor. Hold a protractor "
        "against the palm. The palm moves."
    )
    first, last = (d + m for d, m in zip(task.palm_deg, _PALM_MARGINS_DEG, strict=True))
    wanted = [first + k * (last - first) / (_PALM_ANGLES - 1) for k in range(_PALM_ANGLES)]
    servos = sorted({servo_angle(hardware, math.radians(angle)) for angle in wanted})
    if len(servos) < 3:
        raise PalmbotsError(
            "hardware.servo_min_deg, servo_max_deg: the range of the servo holds fewer than three "
            "angles of the palm"
        )
    whole = math.radians(hardware.servo_max_deg - hardware.servo_min_deg)
    turning_s = whole / math.radians(hardware.servo_rate_deg_s)
    angles = []
    for servo in servos:
        machine.turn_servo(servo, turning_s + _SERVO_SETTLE_S)
        angles.append(
            person.number(
                "What is the angle of the palm? (rising outward, away from the partner: positive)",
                "°",
                -90,
                90,
            )
        )
    zero, scale = line_estimates(servos, [math.radians(a) for a in angles], PROTRACTOR)
    in_degrees = Estimate(*(math.degrees(v) for v in (zero.value, zero.low, zero.high)))
    return [_finding("servo_zero_deg", in_degrees), _finding("servo_scale", scale)]


# --- arm -----------------------------------------------------------------------------------------


def arm(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """`arm_floor_deg` and `arm_top_deg`, from heights of the pivot that a person reads off a
    ruler."""
    hardware, shape = machine.hardware, task.arm
    if shape is None:
        return []
    low, high = math.radians(hardware.arm_floor_deg), math.radians(hardware.arm_top_deg)
    if low == high:
        raise PalmbotsError(
            "hardware.arm_floor_deg, arm_top_deg: are equal; allowed: rough values, so that the "
            "arm can be moved"
        )
    person.ready(
        "Put the robot on a level floor with nothing on its palm. Stand a ruler beside the pivot "
        "of the palm. The arm moves."
    )
    moving_s = (shape.top_m - shape.floors_m[0]) / shape.rate_m_s
    servos, heights = [], []
    for share in _ARM_SHARES:
        servos.append(low + share * (high - low))
        machine.move_arm(servos[-1], moving_s, _SERVO_SETTLE_S)
        heights.append(
            person.number("How high is the pivot of the palm above the floor?", "mm", 0, 10_000)
            / 1000
        )
    found = []
    for key, height in (("arm_floor_deg", shape.floors_m[0]), ("arm_top_deg", shape.top_m)):
        at, _ = line_estimates(servos, [one - height for one in heights], TAPE_M)
        found.append(
            _finding(key, Estimate(*(math.degrees(v) for v in (at.value, at.low, at.high))))
        )
    return found


# --- switches ------------------------------------------------------------------------------------


def switches(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """The edges of the switches, from a rod that a person moves over the palm."""
    listed = machine.hardware.switches
    half_mm = 1000 * task.palm_half_m
    if len(machine.read().closed) != len(listed):
        raise PalmbotsError(
            f"hardware.switches: lists {len(listed)} switches, but the driver reads "
            f"{len(machine.read().closed)}"
        )
    person.ready(
        "Lay a thin rod across the palm at its inner end, towards the partner, and press it "
        "lightly. Positions are counted from above the pivot, outward positive."
    )
    edges: list[list[Estimate | None]] = [[None, None] for _ in listed]
    closed = first = machine.rest(0.2).closed
    while person.watch(
        "Move the rod outward slowly, and stop at once when a switch changes.",
        lambda before=closed: machine.rest(machine.period_s).closed != before,
    ):
        now = machine.rest(machine.period_s).closed
        at = person.number("Where is the rod?", "mm", -half_mm - 5, half_mm + 5) / 1000
        edge = Estimate(at - _OVERSHOOT_M / 2, at - _OVERSHOOT_M - TAPE_M, at + TAPE_M)
        for k, (was, is_now) in enumerate(zip(closed, now, strict=True)):
            if was != is_now:
                edges[k][0 if is_now else 1] = edge
        closed = now
    return _zones(listed, edges, first, closed, task.palm_half_m)


def _zones(
    listed: Sequence[Zone],
    edges: list[list[Estimate | None]],
    first: Sequence[bool],
    last: Sequence[bool],
    half_m: float,
) -> list[Finding]:
    """The switches with their measured edges. What is closed at an end of the palm reaches it."""
    zones, notes = [], []
    estimates: list[tuple[str, Estimate]] = []
    for k, (zone, (start, end)) in enumerate(zip(listed, edges, strict=True)):
        name = f"switches[{k}]"
        if (start is None and not first[k]) or (end is None and not last[k]):
            raise PalmbotsError(
                f"hardware.{name}: never closed while the rod was moved over the palm; allowed: a "
                "switch that is wired to its input, and a rod that presses it"
            )
        low = -half_m if start is None else start.value
        high = half_m if end is None else end.value
        if high <= low:
            raise PalmbotsError(
                f"hardware.{name}: opened at {1000 * high:g} mm, before it closed at "
                f"{1000 * low:g} mm; allowed: a rod that is moved outward only"
            )
        estimates += [(f"{name}.from_m", e) for e in (start,) if e is not None]
        estimates += [(f"{name}.to_m", e) for e in (end,) if e is not None]
        seen = "-" if high <= 0 else "+" if low >= 0 else zone.sign
        if seen != zone.sign and zone.sign != "0":
            notes.append(f"{name} is listed as {zone.sign}, but lies on the side of {seen}")
        zones.append(Zone(sign=zone.sign, from_m=_rounded(low), to_m=_rounded(high)))
    found = [Finding("switches", tuple(zones), None, "; ".join(notes))]
    return found + [Finding(name, None, estimate) for name, estimate in estimates]


Step = Callable[[Machine, Person, Task], list[Finding]]
STEPS: dict[str, Step] = {
    "dead-zone": dead_zone,
    "wheels": wheels,
    "stopping": stopping,
    "palm": palm,
    "arm": arm,
    "switches": switches,
}
"""All steps, in the order in which they are run."""
