# SPDX-License-Identifier: Apache-2.0
"""Forecasts the lateral drift of the object on a curved path, before the carry.

The quasistatic world simulates the unrolled path for several seeds: which contact slides how far,
when and at which palm angles. The lateral slip of a sliding contact follows from statics
(`slip_statics`), at the yaw misalignment β of the palms at that point of the path. Both together
give the drift of each contact, up to one calibrated factor: in MuJoCo, corrections slide contacts
`_CALIBRATION` times as far as in the quasistatic world (benchmarks/bench_curves.py).

The budget is half of a palm's width; at that drift the object tips over the side of the palm. Lips
stop the drift instead. The object stands at the angle β between them, so over half of a palm's
length l it needs l tan β more clearance, of both sides together, or it jams.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.control.registry import ControllerLike, resolve
from palmbots.errors import SceneError
from palmbots.mujoco.curved_world import Line, held, line_of, world_of
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.slip_statics import Pair, slip
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

SEEDS = 16
_CALIBRATION = (
    1.25  # measured: 1.09, 1.26, 1.26 and 1.20 on circles of 4, 2, 1 and 0.7 m, 12 seeds each
)
_COVERED = 1.001  # of a misalignment, times another one that covers it
_BETAS = np.linspace(0.0, 1.0, 5)  # fractions of the largest misalignment of the path
_OFFSETS = np.linspace(-1.0, 1.0, 5)  # fractions of half the palm's width


def lip_clearance(scene: Scene, line: Line | None = None) -> float:
    """The smallest clearance [m] of lips on the path: a quarter of a palm's length × tan β."""
    beta = _max_misalignment(line or line_of(scene))
    return max(scene.palm_of(side).length_m for side in SIDES) / 4 * math.tan(beta)


def _max_misalignment(line: Line) -> float:
    """The largest β of a path [rad]."""
    step = line.curve.step
    reach = max(1, round(line.spread / step))
    straight = np.full(reach, line.curve.heading[0])
    after = np.full(reach, line.curve.heading[-1])
    heading = np.concatenate((straight, line.curve.heading, after))
    return float(np.abs(heading[reach:] - heading[:-reach]).max() / 2)


def contact_compliance(scene: Scene) -> float:
    """Compression of a contact in MuJoCo under its share of the weight [m].

    It depends on the masses of object and palms, so it is measured at rest, with the object level
    on all its contacts.
    """
    return max(1e-6, -0.5 * sum(world_of(held(scene), measures=False).lifts))


class Forecast:
    """Forecasts the drift of the carries of one scene.

    Raises:
        SceneError: lips would jam, or the path is not possible for this pair.
    """

    def __init__(
        self,
        scene: Scene,
        controller: ControllerLike = "distributed",
        rates: SlipRates | None = None,
    ) -> None:
        """`rates`: those of the same pair; used if they cover the misalignment on this path."""
        self.scene, self.controller = scene, resolve(controller)
        self.line = line_of(scene)
        self.askew = _max_misalignment(self.line)
        if rates is not None and self.askew <= _COVERED * rates.askew:
            self.rates = rates
        self._spec = to_spec(scene, unrolled=True)
        palms = [scene.palm_of(side) for side in SIDES]
        self.lips = all(palm.lip_height_m > 0 for palm in palms)
        self.lip_room = lip_clearance(scene, self.line)
        for side, palm in zip(SIDES, palms, strict=True):
            if palm.lip_height_m > 0 and palm.lip_clearance_m < self.lip_room:
                words = self.controller.spelled
                command = command_text("curve", scene.spelled, controller=words)
                raise SceneError(
                    f"palm.lip_clearance_m: {palm.lip_clearance_m:g} ({side}) is too tight: the "
                    f"object stands askew by {math.degrees(self.askew):.1f} degrees and would jam; "
                    f"allowed: at least {math.ceil(1e4 * self.lip_room) / 1e4:g} on this path; to "
                    f"carry with lips that fit, run: {command}"
                )
        self.half = min(palm.width_m for palm in palms) / 2
        self.budget = min(palm.lip_clearance_m for palm in palms) if self.lips else self.half

    def seed(self, seed: int) -> NDArray[np.float64]:
        """The drift (ticks, sides) [m] of the carry of one seed, to the left seen towards +x."""
        run: Any = _core.run(self._spec, self.controller.for_core(self._spec), seed, "double", True)
        return self.drift(run.trace)

    def drift(
        self, trace: Mapping[str, NDArray[np.float64]], start: tuple[float, float] = (0.0, 0.0)
    ) -> NDArray[np.float64]:
        """The same for a carry with this trace, whose contacts are at these places across their
        palms when it starts [m]."""
        slides = np.diff(trace["contact_m"], axis=0)
        angles = trace["palm_rad"][:-1]
        misalignment = self._misalignment_at(trace["midpoint_m"][:-1])
        rates = self.rates
        shallow = np.array([palm.shallow for palm in self._spec.palms])
        steep = np.array([palm.steep for palm in self._spec.palms])
        up = np.clip((angles - shallow) / (steep - shallow), 0, 1)
        drift = np.zeros_like(trace["contact_m"])
        at = [*start]
        drift[:] = at
        sliding = np.flatnonzero((np.abs(slides).max(axis=1) > 0) & (misalignment != 0)).tolist()
        for tick, following in pairwise([*sliding, len(slides)]):
            beta = float(misalignment[tick])
            sense = 1.0 if beta >= 0 else -1.0
            for k in (0, 1):
                step = float(slides[tick, k])
                if step == 0.0:
                    continue
                offset = sense * 0.5 * (at[0] + at[1])
                rate = rates.at(up[tick].tolist(), step > 0, abs(beta), offset)
                at[k] += _CALIBRATION * sense * rate * abs(step)
            drift[tick + 1 : following + 1] = at
        return drift

    def _misalignment_at(self, distances: NDArray[np.float64]) -> NDArray[np.float64]:
        """β at these positions of the middle of the pair; > 0: the centre of the curve is at +y."""
        curve, half = self.line.curve, self.line.spread / 2
        s = self.line.start + self.line.sense * distances
        grid = curve.step * np.arange(len(curve.heading))
        ahead, behind = (np.interp(s + out * half, grid, curve.heading) for out in (1, -1))
        return self.line.sense * (ahead - behind) / 2

    @cached_property
    def rates(self) -> SlipRates:
        """The lateral slip of this pair up to the largest misalignment on its path."""
        spec = self._spec
        whole = spec.com_left + spec.com_right
        pair = Pair(
            friction=(spec.palms[0].friction, spec.palms[1].friction),
            load=(spec.com_right / whole, spec.com_left / whole),
            apart=spec.width,
            half=min(0.98 * self.half, 0.49 * self.scene.object.depth_m),
            com_height=spec.com_height,
            give=contact_compliance(self.scene),
        )
        return SlipRates(pair, [(p.shallow, p.steep) for p in spec.palms], self.askew)


class SlipRates:
    """Lateral slip for each metre of sliding, interpolated between computed states."""

    def __init__(self, pair: Pair, angles: Sequence[tuple[float, float]], askew: float) -> None:
        self.askew, self._half = max(askew, 1e-6), pair.half
        left, right, closing, betas, offsets = np.meshgrid(
            *angles, [False, True], self.askew * _BETAS, pair.half * _OFFSETS, indexing="ij"
        )
        rates = slip(pair, (left, right), betas, closing, offsets).rate
        rates[:, :, :, 0] = 0.0  # on a straight path nothing pushes the object to one side
        self._table = rates.tolist()  # numbers of Python are faster to read one by one

    def at(self, up: Sequence[float], closing: bool, beta: float, offset: float) -> float:
        """The rate, towards the centre; `up`: palm angles from shallow (0) to steep (1)."""
        table = self._table
        b = min(beta / self.askew, 1.0) * (len(_BETAS) - 1)
        a = (min(max(offset / self._half, -1.0), 1.0) + 1) / 2 * (len(_OFFSETS) - 1)
        i, j = min(int(b), len(_BETAS) - 2), min(int(a), len(_OFFSETS) - 2)
        fb, fa = b - i, a - j
        rate = 0.0
        for left, right in product((0, 1), repeat=2):
            share = (up[0] if left else 1 - up[0]) * (up[1] if right else 1 - up[1])
            if share == 0.0:
                continue
            near, far = table[left][right][int(closing)][i : i + 2]
            rate += share * (
                (1 - fb) * ((1 - fa) * near[j] + fa * near[j + 1])
                + fb * ((1 - fa) * far[j] + fa * far[j + 1])
            )
        return rate


def forecast_drift(
    scene: Scene,
    controller: ControllerLike = "distributed",
    *,
    seeds: int = SEEDS,
    on_progress: Callable[[float], None] | None = None,
) -> DriftBudget:
    """Forecast the drift on the path of a scene, over the seeds 0, 1, …

    Raises:
        SceneError: lips would jam, or the path is not possible for this pair.
    """
    known = Forecast(scene, controller)
    most: list[float] = []
    for seed in range(seeds):
        most.append(float(np.abs(known.seed(seed)).max()))
        if on_progress is not None:
            on_progress((seed + 1) / seeds)
    return DriftBudget(
        budget_m=known.budget,
        mean_m=float(np.mean(most)),
        most_m=max(most),
        seeds=seeds,
        tips=0 if known.lips else sum(one > known.budget for one in most),
        askew_deg=math.degrees(known.askew),
        lips=known.lips,
    )
