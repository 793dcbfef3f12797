# SPDX-License-Identifier: Apache-2.0
"""Validates MuJoCo against the quasistatic world: modes, switch lines, tilts, carries, creep.

Each trial compares an engine with the prediction of the quasistatic world for the same state. A
difference has one of two causes:

- ``near a switch line``: less than 1° of friction angle decides which contact slides, and the
  compliance of contacts and robots has effects of that size;
- ``unexplained``: any other difference.

SI units, radians.
"""

from __future__ import annotations

import importlib.util
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

from palmbots._util.arguments import show
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import wilson
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import Result
from palmbots.control.registry import ControllerEntry, ControllerLike, resolve
from palmbots.errors import PalmbotsError
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.validation import trials
from palmbots.mujoco.validation.engine_trials import ENGINES, engine_trials
from palmbots.mujoco.validation.floor_trials import (
    BOTH_PALMS,
    ONE_PALM,
    ROUNDED,
    FloorTrial,
    floor_trial,
)
from palmbots.mujoco.validation.trials import Slides, State
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, run_seeds
from palmbots.simulation.prepare import prepare
from palmbots.simulation.single import carry

VERTICES = "two vertices"
CONTACTS = (VERTICES, ROUNDED, ONE_PALM, BOTH_PALMS)
FLOOR_TRIALS = 3000  # seeds; some states have contacts that the trials leave out
MIN_AGREEMENT, MAX_CREEP_M = 0.99, 0.25e-3
_QUASISTATIC_CARRIES = {True: 1000, False: 100}  # of a compiled controller, of one in Python
_PLACES = (-0.06, -0.045, -0.03, -0.015, 0.0, 0.015, 0.03, 0.045, 0.06)
LINE_PLACES = (-0.04, 0.0, 0.04)
_MAX_COM_OFFSET = 0.035  # m, from the middle


@dataclass(frozen=True, slots=True)
class Trial:
    """One state, one direction, one engine."""

    engine: str
    state: State
    closing: bool
    expected: Slides
    seen: Slides
    decisive: bool
    slid_m: tuple[float, float]
    cause: str | None
    """Why `seen` differs from `expected`; None: it does not."""

    @property
    def contacts(self) -> str:
        """What touches the palms."""
        return ROUNDED if self.state.radius > 0 else VERTICES


@dataclass(frozen=True, slots=True)
class Agreement:
    """How often the contacts move in an engine as in the quasistatic world."""

    engine: str
    contacts: str
    """What touches: ``two vertices``; ``rounded corners`` on palms and their tips; ``floor, one
    palm`` or ``floor, both palms``, where rounded corners touch the floor as well."""
    n: int
    rate: float
    decisive_n: int
    decisive_rate: float
    decisive_interval: tuple[float, float]
    """Wilson 95 % interval."""


@dataclass(frozen=True, slots=True)
class SwitchLine:
    """The offset of the COM from the middle at which the other contact slides first [m]."""

    right_m: float
    """Position of the right contact; the left one is at 0."""
    closing: bool
    known_m: float | None
    """In the quasistatic world; None: no such offset within ±35 mm."""
    seen_m: float | None


@dataclass(frozen=True, slots=True)
class Tilt:
    """One palm turned up with robots at rest: start and motion of the contacts."""

    left_m: float
    known_m: tuple[float, float]
    seen_m: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Pairing:
    """The carries of one seed in both worlds; pairs are (quasistatic, MuJoCo)."""

    seed: int
    outcome: tuple[str, str]
    rms_m: tuple[float, float]
    """Over both contacts."""
    peak_m: tuple[float, float]
    corrections: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Delivery:
    """Delivery rates: of the paired carries in MuJoCo, and of many quasistatic carries."""

    n: int
    delivered: int
    interval: tuple[float, float]
    """Wilson 95 % interval of the rate in MuJoCo."""
    known_n: int
    known: float
    """Rate in the quasistatic world."""


@dataclass(frozen=True, repr=False)
class Validation(Result):
    """The comparison of MuJoCo with the quasistatic world."""

    figure = "validation"
    lines_of = "palmbots.mujoco.validation.validation_lines:validation_lines"

    scene: Scene
    controller: str
    trials: tuple[Trial, ...] = field(metadata=NOT_IN_JSON)
    floor_trials: tuple[FloorTrial, ...] = field(metadata=NOT_IN_JSON)
    agreement: tuple[Agreement, ...]
    """MuJoCo by kind of contact, and then the further engines."""
    switch_lines: tuple[SwitchLine, ...]
    tilts: tuple[Tilt, ...]
    carries: tuple[Pairing, ...]
    delivery: Delivery
    creep_m: tuple[float, float]
    missing: tuple[str, ...]
    """Further engines that are not installed."""

    @derived
    def holds(self) -> bool:
        """Whether at least 99 % of the decisive states of each kind agree, sticking contacts creep
        by at most 0.25 mm, and all paired carries have equal outcomes."""
        return (
            all(one.decisive_rate >= MIN_AGREEMENT for one in self.own)
            and max(map(abs, self.creep_m)) <= MAX_CREEP_M
            and all(p.outcome[0] == p.outcome[1] for p in self.carries)
        )

    @property
    def own(self) -> tuple[Agreement, ...]:
        """The agreement of MuJoCo, by kind of contact."""
        return tuple(one for one in self.agreement if one.engine == "MuJoCo")

    @derived
    def differences(self) -> tuple[Trial, ...]:
        """The states in which another contact slides."""
        return tuple(trial for trial in self.trials if trial.cause is not None)


@command(
    order=110,
    example="palmbots validate --states 100 --carries 3 --out out",
    progress="validating",
    figure="validation.png",
    failure=("holds", "the worlds disagree"),
    states=Option(),
    carries=Option(),
)
def validate(
    scene: SceneLike = "paper",
    *,
    controller: ControllerLike = "distributed",
    states: int | None = None,
    carries: int = 12,
    on_progress: Callable[[float], None] | None = None,
) -> Validation:
    """Compare the MuJoCo world with the quasistatic one.

    Args:
        scene: object, size of the palms and robots; the trials set angles, friction, COM and
            contacts.
        controller: controller of the paired carries; a name or a class with a ``step``.
        states: number of states with two sharp vertices to try; None: all. They are spread over
            their grid. Of the states with other kinds of contact, the same share is tried.
        carries: number of paired carries. They have the seeds 0, 1, …
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene is invalid, or MuJoCo or the controller refuses it.
        PalmbotsError: MuJoCo is not installed, or another argument is not allowed.
    """
    entry = resolve(controller)
    base = load_scene(scene)
    for world in ("mujoco", "quasistatic"):  # refused before any trial runs
        prepare(base, entry, world)
    mujoco()
    width = trials.spec_of(base).width
    grid = trials.grid(width)
    rolling = trials.rolling_grid(width)
    on_floor = FLOOR_TRIALS
    for name, count, most in (("states", states, len(grid)), ("carries", carries, 1000)):
        if count is not None and not 1 <= count <= most:
            raise PalmbotsError(f"{name}: value is {show(count)}; allowed: 1 to {most}")
    if states is not None:
        share = states / len(grid)
        grid = random.Random(0).sample(grid, states)
        rolling = random.Random(0).sample(rolling, math.ceil(share * len(rolling)))
        on_floor = math.ceil(share * on_floor)
    engines = [name for name, (module, _) in ENGINES.items() if importlib.util.find_spec(module)]
    total = len(grid) * (1.0 + 0.3 * len(engines)) + 40.0 * carries + 300.0
    total += len(rolling) + 0.5 * on_floor
    finished = 0.0

    def add_progress(units: float) -> None:
        nonlocal finished
        finished += units
        if on_progress is not None:
            on_progress(min(1.0, finished / total))

    results: list[Trial] = []
    for state in grid:
        results += _trials(base, state, engines)
        add_progress(1.0 + 0.3 * len(engines))
    for state in rolling:
        results += _trials(base, state, [])
        add_progress(1.0)
    floor = []
    for seed in range(on_floor):
        if (one := floor_trial(base, seed, trials.MARGIN)) is not None:
            floor.append(one)
        add_progress(0.5)
    lines = []
    for right in LINE_PLACES:
        for closing in (True, False):
            lines.append(_line(base, width, right, closing))
            add_progress(20.0)
    tilts = []
    for place in _PLACES:
        at = load_scene(base, {"start.left_m": place, "start.right_m": 0.0})
        seen, known = trials.tilted(at, 0)
        tilts.append(Tilt(place, (known[0] - place, known[1]), (seen[0] - place, seen[1])))
        add_progress(10.0)
    pairs = []
    for seed in range(carries):
        pairs.append(_pair(base, entry, seed))
        add_progress(40.0)
    return Validation(
        scene=base,
        controller=entry.name,
        trials=tuple(results),
        floor_trials=tuple(floor),
        agreement=tuple(
            _agreement(engine, contacts, results, floor)
            for engine, contacts in (
                *(("MuJoCo", one) for one in CONTACTS),
                *((name, VERTICES) for name in engines),
            )
        ),
        switch_lines=tuple(lines),
        tilts=tuple(tilts),
        carries=tuple(pairs),
        delivery=_delivery(base, entry, pairs),
        creep_m=trials.creep(),
        missing=tuple(name for name in ENGINES if name not in engines),
    )


def _trials(base: Scene, state: State, engines: list[str]) -> list[Trial]:
    scene = trials.scene_of(base, state)
    spec = trials.spec_of(scene)
    known: dict[bool, Slides | None] = {c: trials.expected(spec, c) for c in (True, False)}
    if known[True] is None:  # the object is not held in this state
        return []
    decisive = {closing: trials.is_decisive(spec, closing) for closing in known}
    runs = {"MuJoCo": trials.run_trial(scene)}
    for name in engines:
        runs[name] = engine_trials(name, scene, trials.SPEED, trials.RAMP_S, trials.PUSH_S)
    results = []
    for name, run in runs.items():
        for closing, moved in run:
            expected = known[closing]
            seen = trials.slide_name(moved)
            assert expected is not None
            cause = None if seen == expected else _cause(decisive[closing])
            results.append(
                Trial(name, state, closing, expected, seen, decisive[closing], moved, cause)
            )
    return results


def _cause(decisive: bool) -> str:
    return "unexplained" if decisive else "near a switch line"


def _agreement(
    engine: str, contacts: str, results: list[Trial], floor: list[FloorTrial]
) -> Agreement:
    judged = [
        (one.decisive, agrees)
        for own, one, agrees in (
            *((t.engine, t, t.cause is None) for t in results),
            *(("MuJoCo", t, t.agrees) for t in floor),
        )
        if (own, one.contacts) == (engine, contacts)
    ]
    decisive = [agrees for is_decisive, agrees in judged if is_decisive]
    n, rate = len(judged), sum(agrees for _, agrees in judged) / max(1, len(judged))
    m = max(1, len(decisive))
    return Agreement(
        engine, contacts, n, rate, len(decisive), sum(decisive) / m, wilson(sum(decisive), m)
    )


def _line(base: Scene, width: float, right: float, closing: bool) -> SwitchLine:
    """By bisection over the COM, at equal palm angles and a friction of 0.3."""

    def state(off: float) -> Scene:
        return trials.scene_of(base, State(0.3, width / 2 + off, (15.0, 15.0), (0.0, right)))

    def known(off: float) -> bool:
        return trials.expected(trials.spec_of(state(off)), closing) == "left"

    def seen(off: float) -> bool:
        _, moved = next(trials.run_trial(state(off), directions=(closing,)))
        return abs(moved[0]) > abs(moved[1])

    return SwitchLine(right, closing, _switch(known, 20), _switch(seen, 8))


def _switch(left_slides: Callable[[float], bool], halvings: int) -> float | None:
    low, high = -_MAX_COM_OFFSET, _MAX_COM_OFFSET
    at_low, at_high = left_slides(low), left_slides(high)
    if at_low == at_high:
        return None
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        if left_slides(middle) == at_low:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _delivery(base: Scene, controller: ControllerEntry, pairs: list[Pairing]) -> Delivery:
    carries = _QUASISTATIC_CARRIES[not controller.is_python]
    outcomes = run_seeds(to_spec(base), controller, 0, carries)["outcome"]
    rate = float((outcomes == DELIVERED).mean())
    n, arrived = len(pairs), sum(p.outcome[1] == "delivered" for p in pairs)
    return Delivery(n, arrived, wilson(arrived, n), carries, rate)


def _pair(base: Scene, controller: ControllerEntry, seed: int) -> Pairing:
    known, seen = (
        carry(base, controller, world=world, seed=seed, record=False)
        for world in ("quasistatic", "mujoco")
    )
    rms = [math.sqrt(sum(x * x for x in one.contact_rms_m.values()) / 2) for one in (known, seen)]
    peak = [max(one.contact_peak_m.values()) for one in (known, seen)]
    return Pairing(
        seed,
        (known.outcome, seen.outcome),
        (rms[0], rms[1]),
        (peak[0], peak[1]),
        (len(known.corrections), len(seen.corrections)),
    )
