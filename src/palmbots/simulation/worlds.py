# SPDX-License-Identifier: Apache-2.0
"""The worlds: what moves the robots and the object in a carry, and what each world supports.

A world is a `WorldEntry` in the registry. A higher room, or a program, registers one by name; the
text ``"module:attribute"`` is loaded on first use, so this room names no other world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from palmbots._util.named_registry import Registry
from palmbots.simulation.driven_world import DrivenWorld

PRECISIONS = ("double", "float")
DEFAULT_WORLD = "quasistatic"


@dataclass(frozen=True)
class WorldRun:
    """What a world returns of one finished carry."""

    measured: Any
    """The compiled core's record: outcome, metrics, messages, trace (`palmbots._core.Run`)."""
    contact_events: Sequence[tuple[int, Any, float, float]] | None = None
    """Further contacts as (side, kind, start, end), times in seconds. None means those of
    `measured`."""
    warnings: tuple[str, ...] = ()
    lateral_peak_m: tuple[float, float] | None = None
    """The largest lateral contact coordinate; None: the world is planar."""
    wheel_slip_m: tuple[float, float] | None = None
    """How much farther the wheels of each robot rolled than it moved; None: there are no wheels."""
    trace: Mapping[str, tuple[Any, Mapping[str, str]]] = field(default_factory=dict)
    """Further variables of the trace (values, attributes), see `simulation.trace`."""
    recording: Any = None
    """What this world alone keeps, for videos."""


@dataclass(frozen=True)
class WorldEntry:
    """One world, and what other parts of the package need to know about it."""

    name: str
    description: str
    """One line for people."""
    run: Callable[..., WorldRun]
    """``run(prepared, seed, precision, record, on_tick, on_progress)`` runs one carry."""
    episode: Callable[..., Any] | None = None
    """``episode(scene, seed, record)`` begins a carry whose robots are commanded from outside, a
    `palmbots.simulation.episode.Episode`; None: this world has none."""
    driven: Callable[..., DrivenWorld] | None = None
    """``driven(scene, pivot_heights_m)`` begins a carry whose wheels and palms are moved from
    outside; None: this world has none."""
    precisions: tuple[str, ...] = ("double",)
    supports_curved: bool = False
    supports_bumps: bool = False
    supports_floor: bool = False
    """A job can begin and end with the object on the floor (task.from, task.to)."""
    supports_forks: bool = False
    """A carry can continue with the random numbers of another seed (`palmbots.carry`)."""
    supports_references: bool = False
    """Controllers with full information can read its state (`ControllerEntry.is_reference`)."""
    is_stepped: bool = False
    """The world runs tick by tick in Python: it calls `on_tick` and `on_progress`."""
    trace_variables: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """The attributes of the variables that it adds to the trace."""
    extra: str | None = None
    """The optional dependency that it needs, as in ``palmbots[mujoco]``."""


_WORLDS: Registry[WorldEntry] = Registry(
    "world", {DEFAULT_WORLD: "palmbots.simulation.quasistatic:WORLD"}
)


def register_world(name: str, entry: WorldEntry | str) -> None:
    """Add a world, or the text ``"module:attribute"`` that names one.

    Raises:
        PalmbotsError: the name is taken.
    """
    _WORLDS.register(name, entry)


def unregister_world(name: str) -> None:
    """Remove a registered world."""
    _WORLDS.unregister(name)


def world_names() -> tuple[str, ...]:
    """The names of all worlds, the default first."""
    return _WORLDS.names()


def world_entry(name: str) -> WorldEntry:
    """The world of a name.

    Raises:
        PalmbotsError: there is no such world.
    """
    return _WORLDS.get(name)
