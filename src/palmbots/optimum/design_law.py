# SPDX-License-Identifier: Apache-2.0
"""The design law σ* ≈ √(u L / 11 τ) beside the optimum, over scenes that differ in one key."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import palmbots.optimum.drop_bound as drop_bound
from palmbots._util.report import Item, Table, bold
from palmbots._util.results import Result
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.sides import multiplied

KEYS: Mapping[str, str] = MappingProxyType(
    {
        "palm.length_m": "palm length",
        "robot.correction_m_s": "correction speed",
        "robot.noise_tau_s": "correlation time of the noise",
        "robot.acceleration_m_s2": "acceleration",
    }
)
"""The keys that the law, or its error, depends on, and what figures call them."""

FACTORS = (0.5, 0.7, 1.0, 1.4, 2.0)


@dataclass(frozen=True, slots=True)
class LawPoint:
    """One scene: the default one with one key multiplied by a factor."""

    key: str
    factor: float
    sigma_star_m_s: float
    law_m_s: float

    @property
    def error(self) -> float:
        """Of the law, as a fraction of σ*."""
        return self.law_m_s / self.sigma_star_m_s - 1


@dataclass(frozen=True, repr=False)
class DesignLaw(Result):
    """The optimum and the law over scenes."""

    points: tuple[LawPoint, ...]
    scene: Scene

    figure = "design-law"

    def lines(self) -> Iterator[Item]:
        """The largest error of the law, and what doubling each quantity does to σ*."""
        error = 100 * self.largest_error
        yield bold(f"σ* ≈ √(uL/11τ), within {error:.0f} % over these scenes")
        keys = dict.fromkeys(point.key for point in self.points)
        yield Table([(f"  {KEYS[key]}", f"{self.gain(key):.2f}") for key in keys],
                    ("", "twice as much multiplies σ* by"))  # fmt: skip

    @property
    def largest_error(self) -> float:
        """Of the law, as a fraction of σ*."""
        return max(abs(point.error) for point in self.points)

    def gain(self, key: str) -> float:
        """By what the largest factor of a key multiplies σ*."""
        mine = [point for point in self.points if point.key == key]
        base = min(mine, key=lambda point: abs(math.log(point.factor)))
        return mine[-1].sigma_star_m_s / base.sigma_star_m_s


def compare_with_law(
    scene: SceneLike = "paper",
    *,
    keys: Sequence[str] = tuple(KEYS),
    factors: Sequence[float] = FACTORS,
    on_progress: Callable[[float], None] | None = None,
) -> DesignLaw:
    """Compute the optimum with corrections only, and the law, in scenes that differ in one key.

    Args:
        scene: the scene whose keys are multiplied.
        keys: scene keys.
        factors: what each key is multiplied by.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: a scene is invalid.
    """
    report = on_progress or (lambda fraction: None)
    base = load_scene(scene)
    points = []
    count = len(keys) * len(factors)
    for key in keys:
        for factor in factors:
            started = len(points) / count
            found = drop_bound.bound(
                base,
                "corrections",
                overrides=multiplied(base, key, factor),
                on_progress=lambda part, started=started: report(started + part / count),
            )
            points.append(LawPoint(key, factor, found.sigma_star_m_s, found.law_m_s))
    report(1.0)
    return DesignLaw(tuple(points), base)
