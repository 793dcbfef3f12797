# SPDX-License-Identifier: Apache-2.0
"""A calibration of one robot of a pair, from its ``pair.toml`` and back into it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from palmbots._types import Interval, Side
from palmbots._util.arguments import show
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots.clocks.control_clock import ControlClock
from palmbots.drivers.arm import arm_shape
from palmbots.drivers.driver import RawAccess
from palmbots.errors import PalmbotsError
from palmbots.pair.calibration import STEPS, ZoneTable, calibrate, values_of
from palmbots.pair.calibration_bench import Finding, Machine, Person, Task
from palmbots.pair.pair_edit import write_hardware
from palmbots.pair.pair_file import Pair
from palmbots.pair.robot_driver import opened_driver
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec


@dataclass(frozen=True, repr=False)
class CalibrationRun(Result):
    """What a calibration has done."""

    side: Side
    file: Path
    """The ``pair.toml``."""
    findings: list[Finding] = field(metadata=NOT_IN_JSON)
    backup: Path
    """The ``pair.toml`` as it was before."""
    warnings: list[str]
    """What the values mean for the scene."""

    @derived
    def hardware(self) -> dict[str, float | list[ZoneTable]]:
        """What was written, by key."""
        return values_of(self.findings)

    @derived
    def intervals(self) -> dict[str, Interval]:
        """The intervals of the values that have one, by key."""
        estimates = ((one.key, one.estimate) for one in self.findings)
        return {key: (one.low, one.high) for key, one in estimates if one is not None}

    def lines(self) -> Iterator[Item]:
        """Each value with its interval, and where it was written."""
        rows = []
        for one in self.findings:
            if one.estimate is not None:
                value = one.estimate.value if one.value is None else one.value
                numbers = (value, one.estimate.low, one.estimate.high)
                key = f"hardware.{self.side}.{one.key}"
                rows.append((key, *(f"{number:.5g}" for number in numbers)))
        yield Table(rows, ("key", "value", "from", "to"), ("value", "from", "to"))
        yield f"Written to {self.file}; as it was before: {self.backup}"


def steps_of(text: str) -> tuple[str, ...]:
    """The steps of ``--only``, in the order in which they are run; empty: all.

    Raises:
        PalmbotsError: there is no such step.
    """
    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in STEPS:
            raise PalmbotsError(f"--only: value is {show(name)}; allowed: {', '.join(STEPS)}")
    return tuple(name for name in STEPS if name in names)


def task_of(scene: Scene, side: Side, length_m: float) -> Task:
    """What a robot of a scene is calibrated for."""
    robot, palm = scene.robot_of(side), scene.palm_of(side)
    arm = arm_shape(scene, side) if to_spec(scene, unrolled=True).uses_floor else None
    angles = (palm.shallow_deg, palm.steep_deg)
    return Task(length_m, robot.speed_m_s, angles, palm.length_m / 2, arm)


def run_calibration(
    pair: Pair,
    side: Side,
    person: Person,
    *,
    steps: Sequence[str] = (),
    length_m: float = 1.5,
    rate: float = 1.0,
) -> CalibrationRun:
    """Calibrate one robot, and write what was found into the ``pair.toml``.

    Nothing is written before the last step is done.

    Args:
        pair: the pair.
        side: which of its robots.
        person: who does what the steps ask for.
        steps: names of the steps; none: all.
        length_m: of the drive along the tape.
        rate: multiple of real time at which a simulated robot runs.

    Raises:
        PalmbotsError: the robot's program runs, its driver gives no access to its hardware, a step
            fails, or a file cannot be written.
    """
    require("tomlkit", "calibrate")  # found missing before, and not after, all the work
    scene = load_scene(pair.scene())
    period_s = scene.control.period_s
    task = task_of(scene, side, length_m)
    if "arm" in steps and task.arm is None:
        raise PalmbotsError(
            f"--only: arm: the job of {pair.scene()} is not on the floor (task.from, task.to), so "
            "the arm does not move; allowed: the other steps"
        )
    with opened_driver(pair, side, scene) as driver:
        has_raw = isinstance(driver, RawAccess) and getattr(driver, "has_raw", True)
        if not has_raw:
            kind = show(pair.settings.driver.kind)
            raise PalmbotsError(
                f"driver.kind: {kind} gives no access to motors and encoders, which calibrate "
                "needs; allowed: a driver with read_raw and write_raw"
            )
        clock = ControlClock(period_s / rate)
        machine = Machine(driver, pair.settings.hardware.of(side), clock.wait, period_s)
        machine.rest(5 * period_s)
        findings = calibrate(machine, person, task, steps)
    backup = write_hardware(pair.file, side, values_of(findings))
    return CalibrationRun(side, pair.file, findings, backup, warnings_of(findings, scene))


def warnings_of(findings: Sequence[Finding], scene: Scene) -> list[str]:
    """What the values mean for the scene."""
    found = {one.key: one for one in findings}
    warnings = [one.note for one in findings if one.note]
    limit_s = stopping_limit_s(scene)
    if "stopping_s" in found and found["stopping_s"].value > limit_s + 1e-9:
        slower = scene.robot.acceleration_m_s2 * limit_s / found["stopping_s"].value
        warnings.append(
            f"the wheels need up to {found['stopping_s'].value:.3f} s to stop, longer than the "
            f"{limit_s:g} s of the scene (robot.speed_m_s / robot.acceleration_m_s2): the robot "
            f"cannot be armed. Make the motors brake harder, or set robot.acceleration_m_s2 = "
            f"{math.floor(1000 * slower) / 1000:g} in the scene"
        )
    if "switches" in found:
        middle = scene.tactile.zero_half_width_m
        for zone in found["switches"].value:
            if zone.sign != "0" or scene.tactile.zones is not None:
                continue
            if max(abs(zone.from_m + middle), abs(zone.to_m - middle)) > _ZONE_SLACK_M:
                warnings.append(
                    f"the middle switch reaches from {1000 * zone.from_m:.1f} to "
                    f"{1000 * zone.to_m:.1f} mm, not ±{1000 * middle:g} mm as the scene assumes "
                    "(tactile.zero_half_width_m): measure again with --only switches, or set "
                    "tactile.zones to what was measured"
                )
    return warnings


_ZONE_SLACK_M = 0.002
