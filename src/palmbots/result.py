"""What a carry came to: outcome, corrections, letters, warnings, trace."""

import string
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from palmbots.bounds import Bounds, bounds_of
from palmbots.deadband import warnings_before
from palmbots.scene import Scene
from palmbots.version import __version__

if TYPE_CHECKING:
    import xarray as xr

    from palmbots.dynamic.run import Physics
    from palmbots.dynamic.world import MujocoWorld

__all__ = ["Carry", "Correction", "Letter", "LinkCounts", "Touch", "finished", "trace_dataset"]

_SIDES = ("left", "right")
_STATIONS = (*_SIDES, "station")
_PATIENCE_S = 2.0  # what a partner may take over an answer, besides the radio's time

# Name in the dataset: (name in the core, unit, meaning)
_VARIABLES = {
    "contact": ("contact_m", "m", "contact coordinate p, outward from the pivot"),
    "lift": ("lift_m", "m", "height of the contact vertex above its palm"),
    "palm": ("palm_rad", "rad", "palm angle"),
    "speed": ("speed_m_s", "m/s", "speed over the following tick"),
    "commanded": ("commanded_m_s", "m/s", "commanded speed"),
    "separation": ("separation_m", "m", "separation of the pivots"),
    "midpoint": ("midpoint_m", "m", "advance of the midpoint of the pivots"),
    "object": ("object_rad", "rad", "angle of the object"),
    "sign": ("sign", "1", "tactile sign"),
    "case": ("case", "1", "case of the controller, blank for none"),
    "motion": ("motion", "1", "contact slides down (-1), sticks (0), slides up (+1)"),
}


@dataclass(frozen=True, slots=True)
class Correction:
    """One corrective action. An assisting (c) is part of the correction that it assists."""

    label: str
    """A, B, … Z, AA, … in order of their start."""
    robot: Literal["left", "right", "both"]
    """Whose contact is corrected."""
    case: str
    """``a``, ``b``, ``d`` of Table 2, or ``1`` to ``8`` of Table 1."""
    assistant: Literal["left", "right"] | None
    """Who came to assist; None also where a robot asked and nobody answered."""
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Touch:
    """A time during which the object rested on more, or on something else, than its two contact
    vertices."""

    robot: Literal["left", "right"]
    """Whose palm touched more of it."""
    kind: Literal["flush", "tip"]
    """How it began: an edge or a further vertex came to lie on the palm, or its tip met an edge."""
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Letter:
    """One message of the distributed algorithm."""

    sent_s: float
    received_s: float | None
    """When it is there to be read; None if it was lost, or came damaged."""
    sender: Literal["left", "right"]
    receiver: Literal["left", "right"]
    letter: str


@dataclass(frozen=True, slots=True)
class LinkCounts:
    """What became of the messages on one link, in one direction."""

    sent: int
    delivered: int
    """All that were not lost, and the copies; the last ones may still be under way."""
    lost: int
    duplicated: int
    late: int
    """Heard by the resilient algorithm, but too old to count."""
    rejected: int
    """Came damaged; or was ignored by the resilient algorithm: a copy, or older than one heard."""


@dataclass(frozen=True)
class Carry:
    """A finished carry. Dictionaries have the keys ``left`` and ``right``."""

    scene: Scene
    controller: str
    world: str
    precision: str
    seed: int
    version: str
    outcome: Literal["delivered", "dropped", "stalled"]
    reason: str | None
    """Why the object was dropped, from a fixed list; None if it was not."""
    time_s: float
    distance_m: float
    contact_rms_m: dict[str, float]
    contact_peak_m: dict[str, float]
    """The largest absolute contact coordinate."""
    corrections: tuple[Correction, ...]
    """The first 512; `correction_count` tells how many there were."""
    correction_count: int
    touches: tuple[Touch, ...]
    """When the object rested on more, or on something else, than its two contact vertices."""
    messages: int
    """Messages sent: letters, or state packets where a station decides."""
    messages_lost: int
    links: dict[str, LinkCounts]
    """By direction, as in ``left_to_right`` or ``station_to_left``; those that were used."""
    bounds: Bounds | None
    """The time bounds of the resilient algorithm."""
    waiting_s: dict[str, float]
    """How long each robot waited for a message, at its nominal speed."""
    bumps: int
    warnings: tuple[str, ...]
    trace_hash: str
    """Equal hashes: equal traces, to the last bit."""
    trace: "xr.Dataset | None"
    """Every tick (None with ``record=False``); the last entry is the end."""
    letters: tuple[Letter, ...]
    physics: "Physics | None" = None
    """What only the dynamic world keeps, for films (None with ``record=False``)."""
    across_peak_m: dict[str, float] | None = None
    """How far the contacts came across their palms, at most: the coordinate of the middle of each
    contact edge, to the left seen from the left robot to the right one (None where the world is
    planar)."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots carry --json`` prints."""
        return {
            "outcome": self.outcome,
            "reason": self.reason,
            "time_s": self.time_s,
            "distance_m": self.distance_m,
            "contact_rms_m": self.contact_rms_m,
            "contact_peak_m": self.contact_peak_m,
            "corrections": [
                {field: getattr(c, field) for field in Correction.__slots__}
                for c in self.corrections
            ],
            "correction_count": self.correction_count,
            "touches": [
                {field: getattr(t, field) for field in Touch.__slots__} for t in self.touches
            ],
            "messages": self.messages,
            "messages_lost": self.messages_lost,
            "links": {name: asdict(counts) for name, counts in self.links.items()},
            "bounds": None if self.bounds is None else asdict(self.bounds),
            "waiting_s": self.waiting_s,
            "bumps": self.bumps,
            "warnings": list(self.warnings),
            "trace_hash": self.trace_hash,
            "across_peak_m": self.across_peak_m,
            "controller": self.controller,
            "world": self.world,
            "precision": self.precision,
            "seed": self.seed,
            "version": self.version,
            "scene": self.scene.model_dump(),
        }


def finished(
    run: Any,
    scene: Scene,
    controller: str,
    world: str,
    seed: int,
    record: bool,
    *,
    precision: str = "double",
    physics: "Physics | None" = None,
    left: "MujocoWorld | None" = None,
) -> Carry:
    """A carry that the core has run, with its trace if `record`; `left`: the dynamic world as the
    carry has left it."""
    touches = run.touches if left is None else left.touches(run.time_s)
    return Carry(
        scene=scene,
        controller=controller,
        world=world,
        precision=precision,
        seed=seed,
        version=__version__,
        outcome=run.outcome,
        reason=run.reason,
        time_s=run.time_s,
        distance_m=run.distance_m,
        contact_rms_m=_by_side(run.contact_rms_m),
        contact_peak_m=_by_side(run.contact_peak_m),
        corrections=_corrections(run.corrections),
        correction_count=run.correction_count,
        touches=tuple(Touch(_SIDES[side], kind, start, end) for side, kind, start, end in touches),
        messages=run.messages,
        messages_lost=run.messages_lost,
        links=_links(run.links, controller),
        bounds=bounds_of(scene) if controller == "resilient" else None,
        waiting_s=_by_side(run.waiting_s),
        bumps=run.bumps,
        warnings=(
            *warnings_before(scene, controller),
            *(() if left is None else left.warnings),
            *_warnings_after(run, scene, controller),
        ),
        trace_hash=run.trace_hash,
        trace=trace_dataset(run.trace, physics.columns if physics else {}) if record else None,
        letters=tuple(
            Letter(sent, None if np.isnan(got) else got, _SIDES[sender], _SIDES[receiver], letter)
            for sent, got, sender, receiver, letter in run.letters
        ),
        physics=physics,
        across_peak_m=None if left is None else _by_side(left.across_peak),
    )


def _by_side(pair: tuple[float, float]) -> dict[str, float]:
    return dict(zip(_SIDES, pair, strict=True))


def _label(index: int) -> str:
    """A … Z, AA, AB, …: the letters of Figure 8."""
    text = ""
    index += 1
    while index > 0:
        index, letter = divmod(index - 1, 26)
        text = string.ascii_uppercase[letter] + text
    return text


def _corrections(rows: list[Any]) -> tuple[Correction, ...]:
    robots = ("left", "right", "both")
    return tuple(
        Correction(
            label=_label(i),
            robot=robots[robot],
            case=case,
            assistant=None if assistant < 0 else _SIDES[assistant],
            start_s=start,
            end_s=end,
        )
        for i, (robot, case, assistant, start, end) in enumerate(rows)
    )


def _links(rows: list[Any], controller: str) -> dict[str, LinkCounts]:
    """The links that were used, by name."""
    partners = ("station", "station") if controller == "centralized" else ("right", "left")
    names = [f"{side}_to_{to}" for side, to in zip(_SIDES, partners, strict=True)]
    names += [f"station_to_{side}" for side in _SIDES]
    return {
        name: LinkCounts(sent, sent - lost + copies, lost, copies, late, rejected)
        for name, (sent, lost, copies, late, rejected) in zip(names, rows, strict=True)
        if sent
    }


def _warnings_after(run: Any, scene: Scene, controller: str) -> tuple[str, ...]:
    told = _resting(run) if controller == "resilient" else _hanging(run, scene)
    told += [
        f"limit cycle: the {side} robot's corrections follow each other with alternating sign"
        for side, cycles in zip(_SIDES, run.limit_cycle, strict=True)
        if cycles
    ]
    if run.correction_count > len(run.corrections):
        told.append(f"{run.correction_count} corrections; only the first are listed")
    if run.touch_count > len(run.touches):
        told.append(f"{run.touch_count} touches; only the first are listed")
    return tuple(told)


def _resting(run: Any) -> list[str]:
    """Robots that stand at the end of a carry that did not get there."""
    if run.outcome != "stalled":
        return []
    return [
        f"the {side} robot is at rest: it hears nothing fresh from its partner, or waits for p = 0"
        for side, rests in zip(_SIDES, run.rests, strict=True)
        if rests
    ]


def _hanging(run: Any, scene: Scene) -> list[str]:
    """Robots still waiting at the end where letters were lost: for ever, as far as one can see."""
    damaged = any(rejected for *_, rejected in run.links)
    if run.messages_lost == 0 and not damaged:
        return []
    longest = _PATIENCE_S + 2 * (scene.radio.latency_s + scene.radio.jitter_s)
    names = {"": "a letter", "Ack": "an Ack", "TiltDown": "a TiltDown"}
    return [
        f"{side} has waited since {since:.1f} s for {names[letter]} that does not come "
        f"(a letter {'was lost' if run.messages_lost else 'came damaged'})"
        for side, (since, lasts, letter) in zip(_SIDES, run.hanging, strict=True)
        if lasts > longest
    ]


def trace_dataset(
    trace: dict[str, np.ndarray], more: Mapping[str, tuple[np.ndarray, str, str]] | None = None
) -> "xr.Dataset":
    """The arrays of a trace, named as the core names them, as a labelled dataset.

    `more`: further variables by name, or others in place of these (values, unit, meaning).
    """
    variables: dict[str, Any] = {}
    for name, (key, unit, meaning) in _VARIABLES.items():
        values = trace[key]
        if name == "case":
            values = values.view("S1").astype("U1")
        dims = ("time", "side") if values.ndim == 2 else ("time",)
        variables[name] = (dims, values, {"units": unit, "long_name": meaning})
    for name, (values, unit, meaning) in (more or {}).items():
        variables[name] = (("time", "side"), values, {"units": unit, "long_name": meaning})
    time = ("time", trace["time_s"], {"units": "s", "long_name": "time"})
    import xarray as xr  # here: it takes longer to import than a carry to run

    return xr.Dataset(variables, coords={"time": time, "side": list(_SIDES)})
