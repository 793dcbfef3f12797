# SPDX-License-Identifier: Apache-2.0
"""A race of palm angles: which pair of a grid lets a controller drop the fewest carries in noise.

All pairs carry with the same seeds. A first round runs a few carries at pairs far apart. Each
further round keeps the best pairs, adds their neighbours at half the distance, and runs more
carries (successive halving). The noise of a round is that at which the leader of the round before
drops a few per cent: with less noise no pair drops, with more noise all do. Among pairs that tie
with the leader, within one standard deviation of the paired difference, the one with the largest
tolerance wins. Only the order matters here; `palmbots.noise_limit` measures the winner with other
seeds.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._types import Interval
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.batch import DROPPED, run_batch
from palmbots.simulation.noise_limit import MOST_M_S, NOISE_KEY
from palmbots.simulation.prepare import prepare
from palmbots.stability.angle_certificate import angle_keys
from palmbots.stability.angle_grid import AngleGrid

Place = tuple[int, int]
"""Row and column of a pair in the grid."""


@dataclass(frozen=True)
class _Round:
    spacing: int | None
    """Distance of neighbours, in steps of the grid; None: no new pairs."""
    kept: int
    """How many of the best pairs of the round before take part."""
    pairs: int
    """How many take part, about, with neighbours and the scene's own; 0: it depends on the grid."""
    carries: int
    drop_rate: float
    """Of the leader, about."""


_ROUNDS = (
    _Round(4, 0, 0, 200, 0.10),
    _Round(2, 10, 53, 400, 0.10),
    _Round(1, 8, 46, 1000, 0.06),
    _Round(None, 10, 11, 3000, 0.03),
    _Round(None, 4, 5, 12_000, 0.015),
)
_MOST_PAIRS = 160
"""Of the first round; where more are admissible, they stand farther apart."""
_SEEDS_APART = 2**40
"""The race does not share seeds with the measurement of its winner."""
_RATE = 0.01
_NORMAL = NormalDist()


@dataclass(frozen=True)
class Race:
    """What came out."""

    best: Place
    sigma_m_s: NDArray[np.float64]
    """About σ* of each pair of the grid that took part; NaN for all others."""


def run_race(
    scene: Scene,
    entry: ControllerEntry,
    grid: AngleGrid,
    own: Place | None,
    start: tuple[float, float],
    *,
    seed: int,
    threads: int,
    report: Callable[[float], None],
) -> Race:
    """Find the admissible pair of a grid with the fewest drops; of ties, the most tolerant one.

    Args:
        scene: its own angles do not matter.
        entry: the controller.
        grid: the pairs.
        own: a pair that takes part in every round if it is admissible.
        start: about σ* [m/s] of some pair, and the slope of its drop rate (`NoiseLimit.slope`).
        seed: random seed.
        threads: worker threads.
        report: called with the completed fraction.

    Raises:
        PalmbotsError: the controller refuses all pairs.
    """
    state = _State(scene, entry, grid, start, seed, threads, report, expected_carries(grid))
    places = _first_places(grid)
    ranked: list[Place] = []
    for number, rules in enumerate(_ROUNDS):
        if number:
            places = ranked[: rules.kept]
            if rules.spacing is not None:
                places = list(dict.fromkeys([*places, *_around(grid, places, rules.spacing)]))
        if own is not None and grid.admissible[own] and own not in places:
            places = [*places, own]
        ranked = state.rank(places, rules)
    report(1.0)
    return Race(ranked[0], state.sigma)


def expected_carries(grid: AngleGrid) -> int:
    """About how many carries a race over this grid takes."""
    most = int(np.count_nonzero(grid.admissible))
    return sum(
        rules.carries * (min(rules.pairs, most) or len(_first_places(grid))) for rules in _ROUNDS
    )


def _first_places(grid: AngleGrid) -> list[Place]:
    """Admissible pairs, evenly spread: at most `_MOST_PAIRS`."""
    spacing = _ROUNDS[0].spacing or 1
    rows, columns = np.nonzero(grid.admissible)
    while True:
        chosen = (rows % spacing == 0) & (columns % spacing == 0)
        if np.count_nonzero(chosen) <= _MOST_PAIRS:
            break
        spacing += 1
    if not chosen.any():  # few pairs, none of which is on the coarse grid
        chosen = np.arange(len(rows)) % (1 + len(rows) // _MOST_PAIRS) == 0
    return list(zip(rows[chosen].tolist(), columns[chosen].tolist(), strict=True))


def _around(grid: AngleGrid, places: Iterable[Place], spacing: int) -> list[Place]:
    """The admissible neighbours of these pairs, `spacing` steps of the grid away."""
    size = len(grid.degrees)
    steps = (-spacing, 0, spacing)
    return [
        (r, c)
        for row, column in places
        for r in (row + step for step in steps)
        for c in (column + step for step in steps)
        if 0 <= r < size and 0 <= c < size and grid.admissible[r, c]
    ]


@dataclass
class _State:
    """Runs the rounds; the noise and the estimates go from one round to the next."""

    scene: Scene
    entry: ControllerEntry
    grid: AngleGrid
    start: tuple[float, float]
    seed: int
    threads: int
    report: Callable[[float], None]
    expected: int
    """Carries, about."""
    carried: int = 0
    sigma: NDArray[np.float64] = field(init=False)
    noise_m_s: float = field(init=False)
    refused: dict[Place, str] = field(default_factory=dict)
    used: int = _SEEDS_APART

    def __post_init__(self) -> None:
        size = len(self.grid.degrees)
        self.sigma = np.full((size, size), np.nan)
        limit, slope = self.start
        load_scene(self.scene, {NOISE_KEY: limit}, called="design:")  # refused if no robot takes it
        self.noise_m_s = self._towards(limit, _RATE, _ROUNDS[0].drop_rate, slope)

    def rank(self, places: list[Place], rules: _Round) -> list[Place]:
        """The pairs, the best first; the round is repeated if the noise was far off."""
        attempts = 0
        while True:
            attempts += 1
            used = self.noise_m_s
            found, dropped = self._carry(places, rules.carries)
            rates = (np.count_nonzero(dropped, axis=1) + 0.5) / (rules.carries + 1)
            least = float(rates.min())
            fits = rules.drop_rate / 5 < least < min(4 * rules.drop_rate, 0.5)
            if fits or used == MOST_M_S or attempts == 5:
                break
            self.noise_m_s = self._towards(used, least, rules.drop_rate, self.start[1])
        for place, rate in zip(found, rates.tolist(), strict=True):
            self.sigma[place] = self._towards(used, rate, _RATE, self.start[1])
        following = _ROUNDS[min(_ROUNDS.index(rules) + 1, len(_ROUNDS) - 1)]
        self.noise_m_s = self._towards(used, least, following.drop_rate, self.start[1])
        return self._ranked(found, dropped)

    def _ranked(self, found: list[Place], dropped: NDArray[np.bool_]) -> list[Place]:
        """The pairs in turn by tolerance, of those that tie with the leader, and by drops."""
        drops = np.count_nonzero(dropped, axis=1)
        by_drops = np.argsort(drops, kind="stable")
        apart = np.count_nonzero(dropped != dropped[by_drops[0]], axis=1)
        ties = np.flatnonzero(drops - drops[by_drops[0]] <= np.sqrt(apart))
        tolerance = [self.grid.tolerance[found[i]] for i in ties]
        by_tolerance = ties[np.argsort(tolerance, kind="stable")[::-1]]
        turns = itertools.chain.from_iterable(
            itertools.zip_longest(by_tolerance.tolist(), by_drops.tolist())
        )
        return [found[i] for i in dict.fromkeys(turns) if i is not None]

    def _carry(self, places: list[Place], carries: int) -> tuple[list[Place], NDArray[np.bool_]]:
        """The pairs that the controller accepts, and which of their carries dropped the object."""
        found, specs = [], []
        for place in places:
            if place in self.refused:
                continue
            try:
                specs.append(self._spec(place))
                found.append(place)
            except SceneError as error:
                self.refused[place] = str(error)
        if not found:
            raise PalmbotsError(
                f"{self.entry.name} refuses every pair of angles that qualifies: "
                f"{next(iter(self.refused.values()))}"
            )
        index = np.repeat(np.arange(len(found)), carries)
        first = np.uint64((self.seed + self.used) % 2**64)
        seeds = np.tile(np.arange(carries, dtype=np.uint64) + first, len(found))
        self.used += carries
        outcome = run_batch(
            specs, index, seeds, self.entry, threads=self.threads, watch=self._watch
        )["outcome"]
        self.carried += len(index)
        return found, outcome.reshape(len(found), carries) == DROPPED

    def _watch(self, done: int) -> None:
        """Report the fraction; the race may take more carries than expected."""
        self.report(min((self.carried + done) / self.expected, 0.99))

    def _spec(self, place: Place) -> Any:
        keys: dict[str, Any] = {**angle_keys(self.scene, self._angles(place))}
        keys[NOISE_KEY] = self.noise_m_s
        return prepare(load_scene(self.scene, keys), self.entry).spec

    def _angles(self, place: Place) -> Interval:
        return float(self.grid.degrees[place[0]]), float(self.grid.degrees[place[1]])

    @staticmethod
    def _towards(noise_m_s: float, rate: float, wanted: float, slope: float) -> float:
        """The noise at which a pair that drops `rate` at `noise_m_s` drops about `wanted`."""
        step = (_NORMAL.inv_cdf(wanted) - _NORMAL.inv_cdf(rate)) / max(slope, 1.0)
        return min(noise_m_s * math.exp(min(max(step, -1.0), 1.0)), MOST_M_S)
