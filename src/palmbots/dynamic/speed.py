"""When quasistatic ends: how hard the pair may accelerate, and how fast it may go.

Two questions. *Acceleration*: the pair accelerates while its palms, the left one shallow, are
driven together or apart; up to which acceleration is the object held and slides the same contact as
at rest? In closed form (an acceleration a is a sideways specific force a / g, docs/mechanics.md),
and in the dynamic world. *Speed*: whole carries at higher speeds in both worlds, with correction
speed, speed limit and noise scaled alike, but not the accelerations. SI units.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from palmbots import _core
from palmbots.carry import carry
from palmbots.dynamic import trials
from palmbots.dynamic.settings import DEFAULT
from palmbots.dynamic.trials import Slides, State
from palmbots.dynamic.world import MujocoWorld, refuse_unknown
from palmbots.errors import PalmbotsError, show
from palmbots.scene import Scene, load_scene
from palmbots.stability.analysis import analyze

__all__ = ["Limit", "Pace", "SpeedLimits", "speed_limits"]

FRICTIONS = (0.15, 0.2, 0.3, 0.4, 0.5, 0.65)
FACTORS = (1.0, 2.0, 4.0, 8.0)
MOST = 4.0  # m/s², of the search
_G = 9.80665
_RAMP_S, _EASE_S, _LOOK_S, _RATE = 0.2, 0.05, 0.15, 0.02
_GRIP = 5.0  # friction of the floor in these trials: what is asked is about the object, not wheels


@dataclass(frozen=True, slots=True)
class Limit:
    """Up to which acceleration the same contact slides as at rest [m/s²]; None: up to 4."""

    friction: float
    closing: bool
    forward: bool
    """Towards +x, away from the shallow palm's robot; otherwise the other way."""
    slides: Slides
    known: float | None
    """In closed form."""
    seen: float | None
    """In the dynamic world."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Carries at one speed: quasistatic first."""

    speed_m_s: float
    n: int
    delivered: tuple[int, int]
    rms_m: tuple[float, float]
    """Of both contacts, mean over carries."""
    peak_m: tuple[float, float]
    """The largest of all."""


@dataclass(frozen=True)
class SpeedLimits:
    """All of it."""

    scene: Scene
    limits: tuple[Limit, ...]
    paces: tuple[Pace, ...]
    analyzed: float | None
    """Up to which acceleration both properties hold in the whole region (`palmbots analyze`)."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots speed --json`` prints."""
        return {
            "limits": [asdict(limit) for limit in self.limits],
            "paces": [asdict(pace) for pace in self.paces],
            "max_acceleration_m_s2": self.analyzed,
            "scene": self.scene.model_dump(),
        }


def speed_limits(
    scene: Any = "paper",
    *,
    seeds: int = 4,
    progress: Callable[[float], None] | None = None,
) -> SpeedLimits:
    """Find both limits.

    Args:
        scene: as in `palmbots.carry`; friction and contacts are those of the trials.
        seeds: carries at each speed, from seed 0.
        progress: called with the fraction that is done.

    Raises:
        SceneError: the scene makes no sense, or the dynamic world cannot obey it.
        PalmbotsError: MuJoCo is not installed, or a count is not as above.
    """
    base = load_scene(scene)
    refuse_unknown(base)
    if not 1 <= seeds <= 1000:
        raise PalmbotsError(f"seeds: value is {show(seeds)}; allowed: 1 to 1000")
    cells = [(f, c, w) for f in FRICTIONS for c in (True, False) for w in (True, False)]
    limits, paces = [], []
    work = len(cells) + 2.0 * seeds * len(FACTORS)
    for cell in cells:
        limits.append(_limit(base, *cell))
        if progress is not None:
            progress(len(limits) / work)
    for factor in FACTORS:
        paces.append(_pace(base, factor, seeds))
        if progress is not None:
            progress((len(limits) + 2.0 * seeds * len(paces)) / work)
    found = analyze(base)
    return SpeedLimits(base, tuple(limits), tuple(paces), found.max_acceleration_m_s2)


def _limit(base: Scene, friction: float, closing: bool, forward: bool) -> Limit:
    width = trials.spec_of(base).width
    palm = base.palm_of("left")
    state = State(friction, width / 2, (palm.shallow_deg, palm.steep_deg), (0.0, 0.0))
    scene = load_scene(trials.scene_of(base, state), {"dynamic.floor_friction": _GRIP})
    spec = trials.spec_of(scene)
    sense = 1.0 if forward else -1.0
    nominal = slides_under(spec, closing, 0.0)
    assert nominal is not None
    return Limit(
        friction,
        closing,
        forward,
        nominal,
        _edge(lambda a: slides_under(spec, closing, sense * a) == nominal, 0.01, 20),
        _edge(lambda a: accelerated(scene, closing, sense * a) == nominal, 0.4, 5),
    )


def _edge(same: Callable[[float], bool], step: float, halvings: int) -> float | None:
    """The first acceleration at which it is another: looked for in steps, then by bisection."""
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
    """Which contact slides while the pair accelerates [m/s², towards +x]; None: not held."""
    before = spec.slope
    spec.slope = before + acceleration / _G
    found = trials.expected(spec, closing)
    spec.slope = before
    return found


def accelerated(scene: Scene, closing: bool, acceleration: float) -> Slides:
    """The same in the dynamic world: under steady acceleration, palms driven at 2 cm/s."""
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
    return trials.named((after[0] - before[0], after[1] - before[1]))


def _pace(base: Scene, factor: float, seeds: int) -> Pace:
    """Carries with speed, correction, noise and limits of all robots times `factor`."""
    changes: dict[str, Any] = {}
    for side in ("left", "right"):
        robot = base.robot_of(side)
        for key in ("speed_m_s", "correction_m_s", "max_speed_m_s", "noise_m_s"):
            most = 1.0 if key == "noise_m_s" else 10.0
            changes[f"robot.{side}.{key}"] = min(most, factor * getattr(robot, key))
    scene = load_scene(base, changes)
    runs = [
        [carry(scene, world=world, seed=seed, record=False) for seed in range(seeds)]
        for world in ("quasistatic", "mujoco")
    ]
    delivered, rms, peak = [], [], []
    for some in runs:
        delivered.append(sum(one.outcome == "delivered" for one in some))
        squares = [sum(x * x for x in one.contact_rms_m.values()) / 2 for one in some]
        rms.append(math.sqrt(sum(squares) / seeds))
        peak.append(max(max(one.contact_peak_m.values()) for one in some))
    return Pace(
        scene.robot_of("left").speed_m_s, seeds, (delivered[0], delivered[1]),
        (rms[0], rms[1]), (peak[0], peak[1]),
    )  # fmt: skip
