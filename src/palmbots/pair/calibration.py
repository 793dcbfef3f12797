# SPDX-License-Identifier: Apache-2.0
"""The steps of a calibration: what a person is asked to do, and what is computed from the answers.

Every step returns findings, whose values go into ``[hardware.SIDE]`` of the ``pair.toml``. Each
step uses what the earlier ones have found.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, TypedDict

from palmbots.drivers.hardware import HardwareParameters, servo_angle
from palmbots.errors import PalmbotsError
from palmbots.pair.calibration_bench import Finding, Machine, Person, Task, finding, rounded
from palmbots.pair.calibration_wheels import dead_zone, stopping, wheels
from palmbots.pair.estimates import PROTRACTOR, TAPE_M, Estimate, line_estimates
from palmbots.scene.robot_section import Zone

_PALM_ANGLES = 7
_PALM_MARGINS_DEG = (-10.0, 20.0)  # beyond the palm angles of the scene
_SERVO_SETTLE_S = 0.5
_ARM_SHARES = (0.25, 0.4, 0.55, 0.7, 0.85)  # of the way of the arm; lower, the nose may touch
_OVERSHOOT_M = 0.001  # a hand that moves a rod slowly stops within this; assumed


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
    return [finding("servo_zero_deg", in_degrees), finding("servo_scale", scale)]


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
            finding(key, Estimate(*(math.degrees(v) for v in (at.value, at.low, at.high))))
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
        zones.append(Zone(sign=zone.sign, from_m=rounded(low), to_m=rounded(high)))
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
