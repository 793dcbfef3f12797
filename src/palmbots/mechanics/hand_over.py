# SPDX-License-Identifier: Apache-2.0
"""Can one robot hand a small object to the other one by way of the floor: by what margin, and what
limits?

Each robot picks the object up against the steep palm of the other one, carries it and puts it down.
`lone` has the closed forms for one palm. Source: docs/theory/lifting.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from palmbots._types import SIDES
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, bold, verdict
from palmbots.mechanics.lone import LoneLift, check_standing, lift_with
from palmbots.mechanics.lone_refusals import refusals_of_palm, refusals_of_task, warnings_of
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec


@dataclass(frozen=True)
class HandOver:
    """Two robots that carry the object one after the other: margins and what limits."""

    giver: LoneLift
    """The robot that follows. It carries the object first."""
    taker: LoneLift
    """The robot that leads."""
    refusals: tuple[str, ...]
    """Why the job cannot begin."""
    warnings: tuple[str, ...]
    """What may end it."""

    @derived
    def works(self) -> bool:
        """Whether the job can begin."""
        return not self.refusals

    def verdict_lines(self) -> Iterator[Item]:
        """Whether the job can begin, and why not."""
        what = f"  the {self.giver.robot} robot hands the object to the {self.taker.robot} one"
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(what))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    @property
    def tightest(self) -> tuple[float, str]:
        """As of `LoneLift`, of the robot whose margin is tighter."""
        robots = (self.giver, self.taker)
        times, text, name = min((*robot.tightest, robot.robot) for robot in robots)
        return times, f"{name} robot: {text}"

    def lines(self) -> Iterator[Item]:
        """The margins of both robots, and what limits."""
        for robot in (self.giver, self.taker):
            yield bold(f"The {robot.robot} robot")
            yield from robot.lines()


def _may_be(scene: Scene, sides: tuple[str, ...], angle: float) -> bool:
    """The job can begin with the steep palms of these robots at this angle."""
    changed = hand_over(load_scene(scene, {f"palm.{side}.steep_deg": angle for side in sides}))
    return changed is not None and changed.works


def hand_over(scene: Scene) -> HandOver | None:
    """The analysis of a scene; None: its robots do not hand the object over.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    if scene.task.dock != "hand-over" or not (spec := to_spec(scene)).uses_floor:
        return None
    check_standing(spec)
    leads = 1 if spec.direction > 0 else 0
    giver, taker = (lift_with(scene, spec, side) for side in (1 - leads, leads))
    refusals = [*refusals_of_task(scene, spec)]
    warnings: list[str] = []
    for robot in (giver, taker):
        sides = SIDES if giver.steep_deg == taker.steep_deg else (robot.robot,)
        key = "palm.steep_deg" if sides == SIDES else f"palm.{robot.robot}.steep_deg"
        refusals += refusals_of_palm(scene, robot)
        warnings += warnings_of(robot, key, partial(_may_be, scene, sides))
    return HandOver(
        giver=giver,
        taker=taker,
        refusals=tuple(dict.fromkeys(refusals)),
        warnings=tuple(dict.fromkeys(warnings)),
    )
