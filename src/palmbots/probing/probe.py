# SPDX-License-Identifier: Apache-2.0
"""The command ``probe``: find an object's COM and friction by touch, simulated or on robots."""

from __future__ import annotations

import contextlib
import math
import os
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from palmbots._types import SIDES, BySide, Interval, Overrides, Side
from palmbots._util.arguments import ordered_pair, seed_of
from palmbots._util.atomic_files import folder, write_whole
from palmbots._util.command import Option, command, writes
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table, bad, good
from palmbots._util.results import Result
from palmbots._util.text import plural, rounded_down, rounded_up
from palmbots._util.toml_writer import toml_text
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import is_pair_file, load_pair
from palmbots.probing.contact_tracking import PairGeometry
from palmbots.probing.next_probe import Limits
from palmbots.probing.object_set import ObjectSet, Prior
from palmbots.probing.probe_run import Pace, ProbeRun
from palmbots.probing.robot_hands import RobotHands, hands_of_pair
from palmbots.probing.simulated_hands import SimulatedHands, give_of
from palmbots.probing.slip_comparison import UP
from palmbots.scene.command_text import command_text
from palmbots.scene.object_frame import object_frame
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import contact_radii, refuse_low_noses, refuse_pipe, to_spec
from palmbots.simulation.imperfect_robot import zones_of
from palmbots.simulation.probe_stage import palm_errors

_REACH_M = 0.010
_SPEED_M_S = 0.01
_ODOMETRY = 0.01
_MOST_PROBES, _MOST_S = 20, 60.0
_COM_X_M, _COM_Y_M = 0.03, 0.01
_MOST_FRICTION = 0.9
"""Steeper friction cones can wedge a contact on a palm at 45°."""


@dataclass(frozen=True)
class ProbeStroke:
    """One closing or opening."""

    angles_deg: BySide[float]
    motion: Literal["closing", "opening"]
    slid: Side | None
    """The contact that slid; None: both at once, or it is not known."""
    time_s: float
    """Since the start, at its end."""
    volume: float
    """Of the set afterwards, as a fraction of the prior's."""


@dataclass(frozen=True, repr=False)
class Probe(Result):
    """What a run of probes has found out about an object."""

    figure = "probe"

    is_consistent: bool
    """Whether an object of the prior explains all observations, and the switches agree with the
    wheels."""
    stop: str
    """Why the run ended early; empty: it did not."""
    com_x_m: Interval
    """COM from the left contact, along the line of contacts."""
    com_y_m: Interval
    """Height of the COM above that line, as in the prior: observations hardly depend on it."""
    friction: BySide[Interval]
    lever_ratio: Interval
    """Horizontal distance of the COM from the left contact, over that from the right one."""
    friction_angle_difference_deg: Interval
    """That of the right palm minus that of the left one."""
    volume: float
    """Of the set, as a fraction of the prior's."""
    observations: int
    """How many observations cut the set."""
    contradicted: tuple[int, ...]
    """The numbers, from 1, of the observations that do not fit the others. If `dropped` of them are
    dropped, an object of the prior explains the rest. More than `dropped` are listed if several
    choices do so equally well."""
    dropped: int
    """How many observations have to be dropped, at least."""
    time_s: float
    contact_m: float | None
    """The largest distance of a contact from the middle of its palm; robots do not know it: None if
    they are other programs."""
    contains_truth: bool | None
    """Whether the simulated object is in the set; robots do not know this: None if they are other
    programs."""
    strokes: tuple[ProbeStroke, ...]
    scene: Scene
    found: ObjectSet = field(metadata=NOT_IN_JSON)

    def lines(self) -> Iterator[Item]:
        """The verdict, what is identified and what is not."""
        low, high = self.com_x_m
        half = 500 * (high - low)
        where = f"the COM is {1000 * low:.1f} to {1000 * high:.1f} mm from the left contact"
        yield Line(good(where) if self.is_consistent else bad(where), f" (±{half:.1f} mm)")
        prior = self.found.prior
        rows = [
            (
                "  COM along the object",
                _ends(self.com_x_m, 1000, "mm"),
                _ends(prior.com_x, 1000, "mm"),
            ),
            *(
                (f"  friction, {side} palm", _ends(own, 1, ""), _ends(before, 1, ""))
                for (side, own), before in zip(self.friction.items(), prior.friction, strict=True)
            ),
            ("  level of friction", "needs steep palms and an off-centre COM", ""),
            ("  COM height", "as in the prior", _ends(self.com_y_m, 1000, "mm")),
            ("  mass", "no observation depends on it", ""),
        ]
        yield Table(rows, ("", "probed", "prior"))
        yield Table(
            [
                ("  lever ratio x_L / x_R", _ends(self.lever_ratio, 1, "")),
                ("  φ_R − φ_L", _ends(self.friction_angle_difference_deg, 1, "°")),
                ("  remains of the prior", f"{100 * self.volume:.2g} %"),
                ("  observations", f"{self.observations} in {plural(len(self.strokes), 'stroke')}"),
                ("  duration", f"{self.time_s:.1f} s"),
                *self._of_simulation(),
            ]
        )
        if self.contradicted:
            numbers = ", ".join(map(str, self.contradicted))
            yield Line(
                bad(
                    "the observations contradict each other: "
                    f"{plural(self.dropped, 'observation')} dropped, of number {numbers}"
                )
            )
        elif self.is_consistent:
            yield Line("a false observation that another object explains would not be noticed")
        if self.stop:
            yield Line(f"ended early: {self.stop}")

    def _of_simulation(self) -> Iterator[tuple[str, str]]:
        """What only a simulation in this program knows."""
        if self.contact_m is not None:
            yield "  contacts within", f"±{1000 * self.contact_m:.1f} mm"
            where = "is in the set" if self.contains_truth else "is not in the set"
            yield "  the simulated object", where


def _ends(ends: Interval, factor: float, unit: str) -> str:
    gap = " " if unit and unit != "°" else ""
    return f"{factor * ends[0]:.3g} to {factor * ends[1]:.3g}{gap}{unit}"


@command(
    order=128,
    example="palmbots probe --set object.com_m=[0.11,0.04] --out box",
    progress="probing",
    failure=("is_consistent", "the observations contradict each other"),
    takes_pairs=True,
    com_x_m=Option(),
    com_y_m=Option(),
    friction=Option(),
    angle_error_deg=Option(least=0.0, most=2.0),
    angle_range_deg=Option(),
)
def probe(
    scene: SceneLike = "paper",
    *,
    world: str = "quasistatic",
    com_x_m: Interval | None = None,
    com_y_m: Interval | None = None,
    friction: Interval = (0.15, 0.6),
    angle_error_deg: float = 0.25,
    angle_range_deg: Interval = (5.0, 45.0),
    seed: int = 0,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> Probe:
    """Find out an object's COM and friction by touch.

    Simulated robots with the object on their palms close and open a little at chosen palm angles.
    They observe only which tactile switches change. The scene is the object as it really is. The
    robots know its outline and a prior: intervals that contain the COM and both friction
    coefficients. With a pair file, the robots are other programs in lockstep with a world.

    Args:
        scene: as in `palmbots.carry`, or the path of a pair file.
        world: ``quasistatic`` or ``mujoco``. With a pair file, whose departures are assumed.
        com_x_m: prior of the COM along the line of contacts, from the left contact; None: the
            middle ± 3 cm.
        com_y_m: prior of the COM's height above that line; None: as in the scene ± 1 cm.
        friction: prior of both coefficients.
        angle_error_deg: largest error of each palm's angle.
        angle_range_deg: limits of the palm angles.
        seed: random seed of the errors of the palm angles.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene cannot be read or is invalid, or the world refuses it.
        PalmbotsError: no probe runs in this world, an interval is out of range, the object is a
            pipe or its contact vertices are rounded, no probe is safe for every object of the
            prior, or the program of a robot does not run or is lost.
    """
    pair = None
    if isinstance(scene, str | os.PathLike) and is_pair_file(scene):
        pair = load_pair(scene, with_key=False)
        if overrides or seed_of(seed):
            raise PalmbotsError(
                f"{pair.file}: is a pair file, with which --set and --seed have no effect; "
                "allowed: to set keys in its scene, and palmbots world --seed"
            )
    chosen = load_scene(scene, overrides) if pair is None else pair.checked_scene()
    refuse_pipe(chosen)
    refuse_low_noses(chosen)
    spec = to_spec(chosen)
    if any(contact_radii(spec)):
        raise PalmbotsError(
            "object.edge_radius_m: a contact vertex is rounded; allowed: sharp ones"
        )
    body = chosen.object
    frame = object_frame(body.vertices_m, body.contacts, body.com_m)
    middle, height = 0.5 * frame.width, frame.com.height
    degrees = ordered_pair("angle_range_deg", angle_range_deg, -45, 45)
    coefficients = ordered_pair("friction", friction, 0.01, _MOST_FRICTION)
    prior = Prior(
        frame.width,
        _given("com_x_m", com_x_m, middle, _COM_X_M, 0, frame.width),
        _given("com_y_m", com_y_m, height, _COM_Y_M, -10, 10),
        (coefficients, coefficients),
        (spec.slope, spec.slope),
    )
    give = give_of(world)
    palms = [chosen.palm_of(side) for side in SIDES]
    zones = [zones_of(chosen, side) for side in SIDES]
    limits = Limits(
        (math.radians(degrees[0]), math.radians(degrees[1])),
        min(_REACH_M, *(palm.reach_m for palm in palms)),
        tuple((c.from_left, c.from_right, c.height) for c in frame.outline),
    )
    rate = math.radians(min(palm.rate_deg_s for palm in palms))
    found = ObjectSet(prior)
    pace = Pace(rate, _SPEED_M_S, _MOST_PROBES, _MOST_S)
    truth: tuple[float, tuple[float, float]] | None = None
    with contextlib.ExitStack() as stack:
        hands: RobotHands
        if pair is None:
            hands = SimulatedHands(chosen, palm_errors(seed, angle_error_deg), world)
            truth = frame.com.from_left, (palms[0].friction, palms[1].friction)
        else:
            hands = stack.enter_context(hands_of_pair(pair, chosen))
        if hands.end:
            raise PalmbotsError(f"probe: the object is not held at the start: {hands.end}")
        if not hands.is_in_lockstep:
            give = give.in_real_time()
        geometry = PairGeometry(
            frame.width,
            (palms[0].pivot_offset_m, palms[1].pivot_offset_m),
            (zones[0], zones[1]),
            math.radians(angle_error_deg) + give.angle,
            _ODOMETRY,
            give,
        )
        run = ProbeRun(hands, geometry, found, limits, pace)
        run.run(on_progress or (lambda part: None))
    found.sharpen()
    found.narrow_ends()
    if not run.strokes:
        raise PalmbotsError(f"probe: {run.stop}; allowed: a narrower prior")
    return _result(run, chosen, truth)


def _given(
    name: str, value: Interval | None, middle: float, error: float, least: float, most: float
) -> Interval:
    ends = (middle - error, middle + error) if value is None else value
    return ordered_pair(name, ends, least, most)


def _result(run: ProbeRun, scene: Scene, truth: tuple[float, tuple[float, float]] | None) -> Probe:
    hands = run.hands
    found = run.found
    hull = found.hull()
    com, left, right = ((float(low), float(high)) for low, high in hull)
    boxes = found.boxes
    apart = (boxes[:, 2, 0] - boxes[:, 1, 1]).min(), (boxes[:, 2, 1] - boxes[:, 1, 0]).max()
    width = found.prior.width
    return Probe(
        is_consistent=run.is_possible and not found.misfits,
        stop=run.stop,
        com_x_m=com,
        com_y_m=found.prior.com_y,
        friction=BySide(_tangents(left), _tangents(right)),
        lever_ratio=(_ratio(com[0], width), _ratio(com[1], width)),
        friction_angle_difference_deg=(math.degrees(apart[0]), math.degrees(apart[1])),
        volume=found.volume(),
        observations=len(found.observations),
        contradicted=tuple(sorted(number + 1 for number in found.contradicted)),
        dropped=found.misfits,
        time_s=run.time_s,
        contact_m=hands.stage.farthest_m if isinstance(hands, SimulatedHands) else None,
        contains_truth=None if truth is None else found.contains(*truth),
        strokes=tuple(
            ProbeStroke(
                BySide(math.degrees(one.angles[0]), math.degrees(one.angles[1])),
                "closing" if one.way == UP else "opening",
                None if one.side is None else SIDES[one.side],
                one.time_s,
                one.volume,
            )
            for one in run.strokes
        ),
        scene=scene,
        found=found,
    )


def _tangents(ends: Interval) -> Interval:
    return math.tan(ends[0]), math.tan(ends[1])


def _ratio(com_x: float, width: float) -> float:
    return com_x / (width - com_x) if com_x < width else math.inf


@writes("probe", path=Option("--out -o", metavar="DIR"))
def write_probe(result: Probe, path: str | os.PathLike[str]) -> list[Path | Item]:
    """Write the intervals that contain the object, and a figure.

    Args:
        result: the probe.
        path: write probe.toml and probe.png to this folder.

    Raises:
        PalmbotsError: a file cannot be written.
    """
    place = folder(Path(path))
    named = {
        "com_x_m": result.com_x_m,
        "com_y_m": result.com_y_m,
        "friction_left": result.friction.left,
        "friction_right": result.friction.right,
    }
    outward = {
        key: [rounded_down(low, 6), rounded_up(high, 6)] for key, (low, high) in named.items()
    }
    files: list[Path | Item] = [place / "probe.toml", place / "probe.png"]
    head = "# The intervals that contain the object; palmbots probe wrote them.\n"
    if not result.is_consistent:
        head = (
            "# The observations contradict each other, so the object may be outside these intervals"
            ".\n# Palmbots probe wrote them.\n"
        )
    write_whole(place / "probe.toml", head + toml_text({"probed": outward}))
    result.save_figure(place / "probe.png")
    if result.is_consistent:
        left, right = result.friction.left, result.friction.right
        may_be_equal = max(left[0], right[0]) <= min(left[1], right[1])
        probed: dict[str, Any] = {"from": shlex.quote(str(place / "probe.toml"))}
        command = command_text(
            "certify", result.scene.spelled, **probed, common_friction=may_be_equal
        )
        condition = ", if both palms have the same friction" if may_be_equal else ""
        files.append(Line(f"certify it{condition}: {command}", is_whole=True))
    return files
