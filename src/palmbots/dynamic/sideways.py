"""The sideways budget of a curved path: how far the object will slip across its palms.

Told before driving. Which contact slides how far, when and at which palm angles is what the
quasistatic world tells of the path unrolled, seed by seed: it is exact and takes milliseconds. How
far a contact that slides slips across its palm follows from statics (`askew`), at the askewness
that the path has there. Both together, tick by tick, give the drift of each contact, but for one
number that is calibrated: in the dynamic world corrections slide contacts more than in the
quasistatic one, `_MORE` times (benchmarks/curves.py).

The budget is what may be used up: half of a palm's width, where the object tips over its side.
Lips stop the drift instead. The object stands askew between them, so that over half of a palm's
length l it needs l tan β more room, of both sides together, or it jams.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots import _core
from palmbots.controllers import adapted_pair
from palmbots.dynamic.askew import Pair, slip
from palmbots.dynamic.curved import Line, line_of, world_of
from palmbots.errors import SceneError
from palmbots.geometry import SIDES
from palmbots.lowering import lower
from palmbots.scene import Scene

__all__ = ["SEEDS", "Budget", "Forecast", "forecast", "give_of", "lip_room"]

SEEDS = 16
_MORE = 1.25  # calibrated: 1.09, 1.26, 1.26 and 1.20 on circles of 4, 2, 1 and 0.7 m, 12 seeds each
_NEAR = 0.8  # of the budget, from where on a path is warned of
_BETAS = np.linspace(0.0, 1.0, 5)  # of the path's largest askewness
_ASIDES = np.linspace(-1.0, 1.0, 5)  # of the palm's half


@dataclass(frozen=True)
class Budget:
    """How far an object may slip sideways on a path, and how far it is expected to [m]."""

    budget_m: float
    """Half of the narrower palm's width: there it tips. With lips, their clearance."""
    mean_m: float
    """The largest drift of a carry, either way, in the mean over seeds."""
    most_m: float
    """The same of the worst seed."""
    seeds: int
    askew_deg: float
    """The largest β of the path."""
    lips: bool
    lip_room_m: float
    """The least clearance of lips that do not jam."""

    @property
    def verdict(self) -> str:
        """``kept`` with room to spare, ``near`` its end for some seeds, or ``beyond`` it."""
        if self.lips:
            return "kept"
        if self.mean_m > self.budget_m:
            return "beyond"
        return "near" if self.most_m > _NEAR * self.budget_m else "kept"

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints of it."""
        return asdict(self) | {"verdict": self.verdict}

    def told(self) -> str:
        """The same in one line."""
        what = "lips leave" if self.lips else "the object tips at"
        return (
            f"sideways, predicted over {self.seeds} seeds: {_mm(self.mean_m)} in the mean, "
            f"{_mm(self.most_m)} at most; {what} {_mm(self.budget_m)} (palms askew by up to "
            f"{self.askew_deg:.1f}°)"
        )

    def refusal(self) -> str:
        """What is said of a path beyond the budget."""
        return (
            f"task.path: the object would slip {_mm(self.mean_m)} sideways and tip at "
            f"{_mm(self.budget_m)}; allowed: larger radii, a shorter way, wider palms, lips "
            f"(palm.lip_height_m=0.03 palm.lip_clearance_m={self._clearance():g}), or "
            "--beyond-budget"
        )

    def _clearance(self) -> float:
        """A clearance for lips, with some room to spare."""
        return math.ceil(1e3 * (1.25 * self.lip_room_m + 2e-3)) / 1e3


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.1f} mm"


def lip_room(scene: Scene, line: Line | None = None) -> float:
    """The least clearance [m] of lips on the scene's path: a quarter of a palm's length × tan β."""
    beta = _askewness(line or line_of(scene))
    return max(scene.palm_of(side).length_m for side in SIDES) / 4 * math.tan(beta)


def _askewness(line: Line) -> float:
    """The largest β of a path [rad]."""
    step = line.curve.step
    reach = max(1, round(line.spread / step))
    straight = np.full(reach, line.curve.heading[0])
    after = np.full(reach, line.curve.heading[-1])
    heading = np.concatenate((straight, line.curve.heading, after))
    return float(np.abs(heading[reach:] - heading[:-reach]).max() / 2)


def give_of(scene: Scene) -> float:
    """How far a contact of the dynamic world gives way under its share of the weight [m].

    Measured at rest, where the object stands level on all its contacts: masses of object and palms
    decide it, so it is no constant.
    """
    return max(1e-6, -0.5 * sum(world_of(scene, measures=False).lifts))


class Forecast:
    """Predicts the drift of carries of one scene; raises `SceneError` where lips would jam."""

    def __init__(self, scene: Scene, controller: Any = "distributed") -> None:
        self.scene, self.controller = scene, controller
        self.line = line_of(scene)
        self.askew = _askewness(self.line)
        self._spec = lower(scene, unrolled=True)
        palms = [scene.palm_of(side) for side in SIDES]
        self.lips = all(palm.lip_height_m > 0 for palm in palms)
        self.lip_room = lip_room(scene, self.line)
        for side, palm in zip(SIDES, palms, strict=True):
            if palm.lip_height_m > 0 and palm.lip_clearance_m < self.lip_room:
                raise SceneError(
                    f"palm.lip_clearance_m: {palm.lip_clearance_m:g} ({side}) is too tight: the "
                    f"object stands askew by {math.degrees(self.askew):.1f} degrees and would jam; "
                    f"allowed: at least {math.ceil(1e4 * self.lip_room) / 1e4:g} on this path"
                )
        self.half = min(palm.width_m for palm in palms) / 2
        self.budget = min(palm.lip_clearance_m for palm in palms) if self.lips else self.half

    def seed(self, seed: int) -> NDArray[np.float64]:
        """The drift (ticks, sides) [m] of the carry of one seed, to the left seen towards +x."""
        controller = self.controller
        core = controller if isinstance(controller, str) else adapted_pair(controller)
        run: Any = _core.run(self._spec, core, seed, "double", True)
        trace = run.trace
        slid = np.diff(trace["contact_m"], axis=0)
        angles = trace["palm_rad"][:-1]
        ways = trace["midpoint_m"][:-1]
        askew = self._askew_at(ways)
        rates = self._rates
        shallow = np.array([palm.shallow for palm in self._spec.palms])
        steep = np.array([palm.steep for palm in self._spec.palms])
        up = np.clip((angles - shallow) / (steep - shallow), 0, 1)
        drift = np.zeros_like(trace["contact_m"])
        at = [0.0, 0.0]
        for tick in np.flatnonzero(np.abs(slid).max(axis=1) > 0).tolist():
            beta = float(askew[tick])
            sense = 1.0 if beta >= 0 else -1.0
            for k in (0, 1):
                step = float(slid[tick, k])
                if step == 0.0:
                    continue
                aside = sense * 0.5 * (at[0] + at[1])
                rate = rates.at(up[tick].tolist(), step > 0, abs(beta), aside)
                at[k] += _MORE * sense * rate * abs(step)
            drift[tick + 1 :] = at
        return drift

    def _askew_at(self, ways: NDArray[np.float64]) -> NDArray[np.float64]:
        """β of the pair at ways of its middle, > 0 where the centre of the curve is at +y."""
        curve, half = self.line.curve, self.line.spread / 2
        s = self.line.start + self.line.sense * ways
        grid = curve.step * np.arange(len(curve.heading))
        ahead, behind = (np.interp(s + out * half, grid, curve.heading) for out in (1, -1))
        return self.line.sense * (ahead - behind) / 2

    @cached_property
    def _rates(self) -> "_Rates":
        spec = self._spec
        whole = spec.com_left + spec.com_right
        pair = Pair(
            friction=(spec.palms[0].friction, spec.palms[1].friction),
            load=(spec.com_right / whole, spec.com_left / whole),
            apart=spec.width,
            half=min(0.98 * self.half, 0.49 * self.scene.object.depth_m),
            com_height=spec.com_height,
            give=give_of(self.scene),
        )
        return _Rates(pair, [(p.shallow, p.steep) for p in spec.palms], self.askew)


class _Rates:
    """Slip across for each metre of sliding, between a few states that are worked out."""

    def __init__(self, pair: Pair, angles: Sequence[tuple[float, float]], askew: float) -> None:
        self._askew, self._half = max(askew, 1e-6), pair.half
        left, right, closing, betas, asides = np.meshgrid(
            *angles, [False, True], self._askew * _BETAS, pair.half * _ASIDES, indexing="ij"
        )
        self._table = slip(pair, (left, right), betas, closing, asides).rate
        self._table[:, :, :, 0] = 0.0  # on a straight path nothing drives the object to one side

    def at(self, up: Sequence[float], closing: bool, beta: float, aside: float) -> float:
        """The rate, towards the centre; `up`: shares from shallow (0) to steep (1)."""
        table = self._table
        b = min(beta / self._askew, 1.0) * (len(_BETAS) - 1)
        a = (min(max(aside / self._half, -1.0), 1.0) + 1) / 2 * (len(_ASIDES) - 1)
        i, j = min(int(b), len(_BETAS) - 2), min(int(a), len(_ASIDES) - 2)
        fb, fa = b - i, a - j
        rate = 0.0
        for left, right in product((0, 1), repeat=2):
            share = (up[0] if left else 1 - up[0]) * (up[1] if right else 1 - up[1])
            if share == 0.0:
                continue
            t = table[left, right, int(closing)]
            rate += share * (
                (1 - fb) * ((1 - fa) * t[i, j] + fa * t[i, j + 1])
                + fb * ((1 - fa) * t[i + 1, j] + fa * t[i + 1, j + 1])
            )
        return float(rate)


def forecast(
    scene: Scene,
    controller: Any = "distributed",
    seeds: int = SEEDS,
    progress: Callable[[float], None] | None = None,
) -> Budget:
    """The budget of a scene's path over the seeds 0, 1, …

    Raises `SceneError` where lips would jam or the path is none for this pair.
    """
    known = Forecast(scene, controller)
    most: list[float] = []
    for seed in range(seeds):
        most.append(float(np.abs(known.seed(seed)).max()))
        if progress is not None:
            progress((seed + 1) / seeds)
    return Budget(
        budget_m=known.budget,
        mean_m=float(np.mean(most)),
        most_m=max(most),
        seeds=seeds,
        askew_deg=math.degrees(known.askew),
        lips=known.lips,
        lip_room_m=known.lip_room,
    )
