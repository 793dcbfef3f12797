"""The dynamic world against the quasistatic one: modes, switch lines, tilts, carries, creep.

SI units, radians; every number of a trial is what was seen in one engine and what the quasistatic
world says for the same state. Where they differ a cause is named, if it is one of those known:

- ``near a switch line``: less than 1° of friction angle decides which contact slides, and soft
  contacts, their dents and the robots' give are of that size;
- ``unexplained``: not so.
"""

import importlib.util
import math
import random
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from palmbots.batch import DELIVERED, run_seeds
from palmbots.carry import carry
from palmbots.compare import wilson
from palmbots.dynamic import trials
from palmbots.dynamic.peers import PEERS, peer_trials
from palmbots.dynamic.trials import Slides, State
from palmbots.dynamic.world import refuse_unknown
from palmbots.errors import PalmbotsError, show
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene

__all__ = [
    "Agreement",
    "Delivery",
    "Pairing",
    "SwitchLine",
    "Tilt",
    "Trial",
    "Validation",
    "validate",
]

LEAST_AGREEMENT, MOST_CREEP_M = 0.99, 0.25e-3
_KNOWN = 1000  # carries of the quasistatic world
_PLACES = (-0.06, -0.045, -0.03, -0.015, 0.0, 0.015, 0.03, 0.045, 0.06)
_LINE_PLACES = (-0.04, 0.0, 0.04)
_WIDEST_COM = 0.035  # m, off the middle


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
    """Why seen is not expected; None where it is."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """How often an engine slides the contact that the quasistatic world says."""

    engine: str
    n: int
    rate: float
    decisive_n: int
    decisive_rate: float
    decisive_interval: tuple[float, float]
    """Wilson's 95 % interval."""


@dataclass(frozen=True, slots=True)
class SwitchLine:
    """The COM, off the middle, where another contact begins to slide first [m]."""

    right_m: float
    """The right contact; the left one is at 0."""
    closing: bool
    known_m: float | None
    """In the quasistatic world; None: within ±35 mm there is none."""
    seen_m: float | None


@dataclass(frozen=True, slots=True)
class Tilt:
    """One palm turned up, robots at rest: where the contacts began, and by how much they moved."""

    left_m: float
    known_m: tuple[float, float]
    seen_m: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Pairing:
    """One seed carried in both worlds: quasistatic first."""

    seed: int
    outcome: tuple[str, str]
    rms_m: tuple[float, float]
    """Of both contacts together."""
    peak_m: tuple[float, float]
    corrections: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Delivery:
    """How often carries arrive: the paired ones in MuJoCo, many in the quasistatic world."""

    n: int
    delivered: int
    interval: tuple[float, float]
    """Wilson's 95 % interval of the rate in MuJoCo."""
    known_n: int
    known: float
    """Rate in the quasistatic world."""


@dataclass(frozen=True)
class Validation:
    """All of it."""

    scene: Scene
    controller: str
    trials: tuple[Trial, ...]
    agreement: tuple[Agreement, ...]
    lines: tuple[SwitchLine, ...]
    tilts: tuple[Tilt, ...]
    pairs: tuple[Pairing, ...]
    delivery: Delivery
    creep_m: tuple[float, float]
    missing: tuple[str, ...]
    """Peers that are not installed."""

    @property
    def holds(self) -> bool:
        """99 % of decisive states agree, a sticking contact drifts 0.25 mm, carries end alike."""
        own = self.agreement[0]
        return (
            own.decisive_rate >= LEAST_AGREEMENT
            and max(map(abs, self.creep_m)) <= MOST_CREEP_M
            and all(p.outcome[0] == p.outcome[1] for p in self.pairs)
        )

    def summary(self) -> dict[str, Any]:
        """What ``palmbots validate --json`` prints."""
        return {
            "holds": self.holds,
            "agreement": [asdict(a) for a in self.agreement],
            "differences": [asdict(t) for t in self.trials if t.cause is not None],
            "switch_lines": [asdict(line) for line in self.lines],
            "tilts": [asdict(t) for t in self.tilts],
            "carries": [asdict(p) for p in self.pairs],
            "delivery": asdict(self.delivery),
            "creep_m": self.creep_m,
            "controller": self.controller,
            "missing": list(self.missing),
            "scene": self.scene.model_dump(),
        }


def validate(
    scene: Any = "paper",
    *,
    controller: str = "distributed",
    states: int | None = None,
    seeds: int = 12,
    progress: Callable[[float], None] | None = None,
) -> Validation:
    """Put the dynamic world beside the quasistatic one.

    Args:
        scene: as in `palmbots.carry`; its object, palms' size and robots are taken, angles,
            friction, COM and contacts are those of the trials.
        controller: of the paired carries.
        states: how many of the grid's states to try, spread over it; None: all of them.
        seeds: how many carries to pair, from seed 0.
        progress: called with the fraction that is done.

    Raises:
        SceneError: the scene makes no sense, or the dynamic world cannot obey it.
        PalmbotsError: MuJoCo is not installed, or a count is not as above.
    """
    base = load_scene(scene)
    refuse_unknown(base)
    width = trials.spec_of(base).width
    grid = trials.grid(width)
    for name, count, most in (("states", states, len(grid)), ("seeds", seeds, 1000)):
        if count is not None and not 1 <= count <= most:
            raise PalmbotsError(f"{name}: value is {show(count)}; allowed: 1 to {most}")
    if states is not None:
        grid = random.Random(0).sample(grid, states)
    peers = [name for name, (module, _) in PEERS.items() if importlib.util.find_spec(module)]
    work = len(grid) * (1.0 + 0.3 * len(peers)) + 40.0 * seeds + 300.0
    done = 0.0

    def more(units: float) -> None:
        nonlocal done
        done += units
        if progress is not None:
            progress(min(1.0, done / work))

    tried: list[Trial] = []
    for state in grid:
        tried += _trials(base, state, peers)
        more(1.0 + 0.3 * len(peers))
    lines = []
    for right in _LINE_PLACES:
        for closing in (True, False):
            lines.append(_line(base, width, right, closing))
            more(20.0)
    tilts = []
    for place in _PLACES:
        at = load_scene(base, {"start.left_m": place, "start.right_m": 0.0})
        seen, known = trials.tilted(at, 0)
        tilts.append(Tilt(place, (known[0] - place, known[1]), (seen[0] - place, seen[1])))
        more(10.0)
    pairs = []
    for seed in range(seeds):
        pairs.append(_pair(base, controller, seed))
        more(40.0)
    return Validation(
        scene=base,
        controller=controller,
        trials=tuple(tried),
        agreement=tuple(_agreement(name, tried) for name in ("MuJoCo", *peers)),
        lines=tuple(lines),
        tilts=tuple(tilts),
        pairs=tuple(pairs),
        delivery=_delivery(base, controller, pairs),
        creep_m=trials.creep(),
        missing=tuple(name for name in PEERS if name not in peers),
    )


def _trials(base: Scene, state: State, peers: list[str]) -> list[Trial]:
    scene = trials.scene_of(base, state)
    spec = trials.spec_of(scene)
    known: dict[bool, Slides | None] = {c: trials.expected(spec, c) for c in (True, False)}
    if known[True] is None:  # no state to be in
        return []
    decisive = {closing: trials.is_decisive(spec, closing) for closing in known}
    runs = {"MuJoCo": trials.tried(scene)}
    for name in peers:
        runs[name] = peer_trials(name, scene, trials.SPEED, trials.RAMP_S, trials.PUSH_S)
    found = []
    for name, run in runs.items():
        for closing, moved in run:
            says = known[closing]
            seen = trials.named(moved)
            assert says is not None
            cause = None if seen == says else _cause(decisive[closing])
            found.append(Trial(name, state, closing, says, seen, decisive[closing], moved, cause))
    return found


def _cause(decisive: bool) -> str:
    return "unexplained" if decisive else "near a switch line"


def _agreement(engine: str, tried: list[Trial]) -> Agreement:
    own = [t for t in tried if t.engine == engine]
    sure = [t for t in own if t.decisive]
    right, surely = (sum(t.cause is None for t in some) for some in (own, sure))
    return Agreement(
        engine, len(own), right / max(1, len(own)), len(sure), surely / max(1, len(sure)),
        wilson(surely, max(1, len(sure))),
    )  # fmt: skip


def _line(base: Scene, width: float, right: float, closing: bool) -> SwitchLine:
    """By bisection over the COM, at equal palm angles and a friction of 0.3."""

    def state(off: float) -> Scene:
        return trials.scene_of(base, State(0.3, width / 2 + off, (15.0, 15.0), (0.0, right)))

    def known(off: float) -> bool:
        return trials.expected(trials.spec_of(state(off)), closing) == "left"

    def seen(off: float) -> bool:
        _, moved = next(trials.tried(state(off), directions=(closing,)))
        return abs(moved[0]) > abs(moved[1])

    return SwitchLine(right, closing, _switch(known, 20), _switch(seen, 8))


def _switch(left_slides: Callable[[float], bool], halvings: int) -> float | None:
    low, high = -_WIDEST_COM, _WIDEST_COM
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


def _delivery(base: Scene, controller: str, pairs: list[Pairing]) -> Delivery:
    ends = run_seeds(lower(base), controller, 0, _KNOWN, "double")["outcome"]
    rate = float((ends == DELIVERED).mean())
    n, arrived = len(pairs), sum(p.outcome[1] == "delivered" for p in pairs)
    return Delivery(n, arrived, wilson(arrived, n), _KNOWN, rate)


def _pair(base: Scene, controller: str, seed: int) -> Pairing:
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
