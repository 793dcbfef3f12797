# SPDX-License-Identifier: Apache-2.0
"""The worlds: what moves the robots and the object in a carry, and what each world supports.

A world is a `WorldEntry` in the registry. A higher room, or a program, registers one by name; the
text ``"module:attribute"`` is loaded on first use, so this room names no other world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from palmbots._util.arguments import one_of, show
from palmbots._util.named_registry import Registry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene
from palmbots.simulation.driven_world import DrivenWorld

PRECISIONS = ("double", "float")


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
    """``episode(scene, seed, record)`` begins a carry that is stepped from outside, as in
    `palmbots.learn`; None: this world has none."""
    driven: Callable[..., DrivenWorld] | None = None
    """``driven(scene, pivot_heights_m)`` begins a carry whose wheels and palms are moved from
    outside; None: this world has none."""
    precisions: tuple[str, ...] = ("double",)
    supports_curved: bool = False
    supports_bumps: bool = False
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
    "world", {"quasistatic": "palmbots.simulation.quasistatic:WORLD"}
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


def check_precision(world: WorldEntry, precision: str) -> None:
    """Raise `PalmbotsError` for a precision that does not exist, or that this world lacks."""
    one_of("precision", precision, PRECISIONS)
    one_of(f"precision (world {world.name})", precision, world.precisions)


def check_scene(world: WorldEntry, scene: Scene) -> None:
    """Raise `SceneError` for a scene that needs something which this world does not support."""
    if scene.task.path.is_curved and not world.supports_curved:
        others = _others(lambda entry: entry.supports_curved)
        raise SceneError(
            f"task.path.kind: {show(scene.task.path.kind)} is a curved path, and the {world.name} "
            f"world and its mechanics are planar; allowed: straight{others}"
        )
    if (scene.bumps.script or scene.bumps.rate_per_m > 0) and not world.supports_bumps:
        others = _others(lambda entry: entry.supports_bumps)
        raise SceneError(
            f"bumps: the {world.name} world cannot shift contacts; allowed: no bumps "
            f"(mujoco.ridges has bumps of the floor){others}"
        )


def _others(supports: Callable[[WorldEntry], bool]) -> str:
    """The worlds that do support it, as the end of a message."""
    names = []
    for name in world_names():
        try:
            if supports(world_entry(name)):
                names.append(name)
        except (ImportError, PalmbotsError):  # a registered world that cannot be loaded here
            continue
    return f", or carry --world {' or '.join(names)}" if names else ""
