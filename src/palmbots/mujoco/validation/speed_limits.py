# SPDX-License-Identifier: Apache-2.0
"""The limits of the quasistatic model: acceleration and speed.

*Acceleration*: the pair accelerates while its palms, the left one shallow, are driven together or
apart. The limit is the acceleration up to which the object is held and the same contact slides as
at rest. It is computed in closed form (an acceleration a acts as a horizontal specific force a / g,
docs/theory/mechanics.md) and measured in MuJoCo. *Speed*: whole carries at higher speeds in both
worlds. Correction speed, speed limit and noise are scaled with the speed, but not the
accelerations. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.command import Option, command
from palmbots._util.report import Item, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.errors import SceneError
from palmbots.mujoco.carry_runner import WORLD
from palmbots.mujoco.engine_settings import DEFAULT
from palmbots.mujoco.validation import trials
from palmbots.mujoco.validation.trials import Slides, State
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.prepare import check_scene
from palmbots.simulation.single import carry
from palmbots.stability.analysis import analyze

FRICTIONS = (0.15, 0.2, 0.3, 0.4, 0.5, 0.65)
FACTORS = (1.0, 2.0, 4.0, 8.0)
MOST = 4.0  # m/s², end of the search
_RAMP_S, _EASE_S, _LOOK_S, _RATE = 0.2, 0.05, 0.15, 0.02
_GRIP = 5.0  # friction of the floor in these trials, so that wheels do not slip


@dataclass(frozen=True, slots=True)
class Limit:
    """The acceleration up to which the same contact slides as at constant speed [m/s²].

    None: 4 or more.
    """

    friction: float
    closing: bool
    forward: bool
    """Acceleration towards +x, away from the robot with the shallow palm."""
    slides: Slides
    known: float | None
    """In closed form."""
    seen: float | None
    """In MuJoCo."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Carries at one speed; pairs are (quasistatic, MuJoCo)."""

    speed_m_s: float
    n: int
    delivered: tuple[int, int]
    rms_m: tuple[float, float]
    """Over both contacts and all carries."""
    peak_m: tuple[float, float]
    """The largest of all carries."""

    def row(self) -> tuple[str, ...]:
        """Speed, deliveries and contacts, for people."""
        return (
            f"{self.speed_m_s:g} m/s",
            f"{self.delivered[0]}, {self.delivered[1]} of {self.n}",
            ", ".join(f"{1e3 * rms:.1f}" for rms in self.rms_m),
            ", ".join(f"{1e3 * peak:.1f}" for peak in self.peak_m),
        )


@dataclass(frozen=True, repr=False)
class SpeedLimits(Result):
    """The limits of acceleration and speed."""

    figure = "speed_limits"

    scene: Scene
    limits: tuple[Limit, ...]
    paces: tuple[Pace, ...]
    max_acceleration_m_s2: float | None
    """Acceleration up to which both properties hold in the whole region (`palmbots analyze`)."""

    def lines(self) -> Iterator[Item]:
        """The largest acceleration, and carries at several speeds."""
        yield bold(
            "Largest acceleration at which the same contact slides as at constant speed, at "
            "p = 0 [m/s²]"
        )
        rows = []
        for limit in self.limits:
            motion = "closing" if limit.closing else "opening"
            phase = "accelerating" if limit.forward else "braking"
            ends = ("4 or more" if x is None else f"{x:.2f}" for x in (limit.known, limit.seen))
            rows.append((f"{motion}, {phase}", f"{limit.friction:g}", *ends))
        heads = ("friction", "closed form", "mujoco")
        yield Table(rows, ("", *heads), right=heads)
        if self.max_acceleration_m_s2 is not None:
            yield (
                f"both properties hold on the whole palms up to {self.max_acceleration_m_s2:.2f} "
                "m/s² (palmbots analyze)"
            )
        heads = ("delivered", "contact rms [mm]", "contact peak [mm]")
        yield Table([pace.row() for pace in self.paces], ("speed", *heads), right=heads)
        yield quiet("pairs of numbers: quasistatic, mujoco")


@command(
    "speed-limits",
    order=100,
    example="palmbots speed-limits --carries 2 --out out",
    progress="accelerating",
    figure="speed.png",
    carries=Option(least=1, most=1000),
)
def find_speed_limits(
    scene: SceneLike = "paper",
    *,
    carries: int = 4,
    on_progress: Callable[[float], None] | None = None,
) -> SpeedLimits:
    """Find the limits of quasistatic mechanics.

    The report states the largest acceleration at which the same contact slides as at constant
    speed, and compares both worlds at several speeds.

    Args:
        scene: the trials set its friction and contacts.
        carries: carries at each speed. They have the seeds 0, 1, …
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene is invalid, or MuJoCo refuses it.
        PalmbotsError: MuJoCo is not installed, or `carries` is not allowed.
    """
    base = load_scene(scene)
    check_scene(WORLD, base)
    cells = [(f, c, w) for f in FRICTIONS for c in (True, False) for w in (True, False)]
    limits, paces = [], []
    total = len(cells) + 2.0 * carries * len(FACTORS)
    for cell in cells:
        limits.append(_limit(base, *cell))
        if on_progress is not None:
            on_progress(len(limits) / total)
    for factor in FACTORS:
        paces.append(_pace(base, factor, carries))
        if on_progress is not None:
            on_progress((len(limits) + 2.0 * carries * len(paces)) / total)
    analysis = analyze(base)
    return SpeedLimits(base, tuple(limits), tuple(paces), analysis.max_acceleration_m_s2)


def _limit(base: Scene, friction: float, closing: bool, forward: bool) -> Limit:
    width = trials.spec_of(base).width
    palm = base.palm_of("left")
    state = State(friction, width / 2, (palm.shallow_deg, palm.steep_deg), (0.0, 0.0))
    scene = load_scene(trials.scene_of(base, state), {"mujoco.floor_friction": _GRIP})
    spec = trials.spec_of(scene)
    sense = 1.0 if forward else -1.0
    nominal = slides_under(spec, closing, 0.0)
    if nominal is None:
        raise SceneError(
            f"with friction {friction:g} and the contacts at the pivots, the palms do not hold the "
            "object; expected a scene in which they do"
        )
    return Limit(
        friction,
        closing,
        forward,
        nominal,
        _edge(lambda a: slides_under(spec, closing, sense * a) == nominal, 0.01, 20),
        _edge(lambda a: accelerated(scene, closing, sense * a) == nominal, 0.4, 5),
    )


def _edge(same: Callable[[float], bool], step: float, halvings: int) -> float | None:
    """The acceleration at which the sliding contact changes: found in steps, then by bisection."""
    high = step
    while same(high):
        high += step
        if high > MOST:
            return None
    low = high - step
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        if same(middle):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def slides_under(spec: _core.Spec, closing: bool, acceleration: float) -> Slides | None:
    """The contact that slides while the pair accelerates [m/s², towards +x]; None: not held."""
    before = spec.slope
    spec.slope = before + acceleration / _core.standard_gravity
    slides = trials.expected(spec, closing)
    spec.slope = before
    return slides


def accelerated(scene: Scene, closing: bool, acceleration: float) -> Slides:
    """The same in MuJoCo: under constant acceleration, with the palms driven at 2 cm/s."""
    world = MujocoWorld(scene, DEFAULT)
    angles, period = world.wrists_set, scene.control.period_s
    sense = 1.0 if closing else -1.0
    speed = 0.0
    before = world.contacts
    ticks = [round(s / period) for s in (_RAMP_S, _EASE_S, _LOOK_S)]
    for tick in range(sum(ticks)):
        speed += acceleration * period * min(1.0, (tick + 1) / ticks[0])
        drive = min(1.0, max(0.0, (tick + 1 - ticks[0]) / ticks[1]))
        half = 0.5 * _RATE * sense * drive
        world.move((speed + half, speed - half), angles)
        if tick + 1 == ticks[0] + ticks[1]:
            before = world.contacts
    after = world.contacts
    return trials.slide_name((after[0] - before[0], after[1] - before[1]))


def _pace(base: Scene, factor: float, carries: int) -> Pace:
    """Carries with speed, correction speed, noise and speed limit multiplied by `factor`."""
    changes: dict[str, Any] = {}
    for side in SIDES:
        robot = base.robot_of(side)
        for key in ("speed_m_s", "correction_m_s", "max_speed_m_s", "noise_m_s"):
            most = 1.0 if key == "noise_m_s" else 10.0
            changes[f"robot.{side}.{key}"] = min(most, factor * getattr(robot, key))
    scene = load_scene(base, changes)
    runs = [
        [carry(scene, world=world, seed=seed, record=False) for seed in range(carries)]
        for world in ("quasistatic", "mujoco")
    ]
    delivered, rms, peak = [], [], []
    for some in runs:
        delivered.append(sum(one.outcome == "delivered" for one in some))
        squares = [sum(x * x for x in one.contact_rms_m.values()) / 2 for one in some]
        rms.append(math.sqrt(sum(squares) / carries))
        peak.append(max(max(one.contact_peak_m.values()) for one in some))
    return Pace(
        scene.robot_of("left").speed_m_s, carries, (delivered[0], delivered[1]),
        (rms[0], rms[1]), (peak[0], peak[1]),
    )  # fmt: skip
