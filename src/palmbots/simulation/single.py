# SPDX-License-Identifier: Apache-2.0
"""One carry: run a scene with a controller once."""

from __future__ import annotations

import numbers
from collections.abc import Callable, Sequence
from typing import Any

from palmbots._types import Overrides
from palmbots._util.arguments import seed_of, show
from palmbots.control.registry import ControllerLike
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import SceneLike, load_scene
from palmbots.simulation.prepare import check_precision, prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import WorldEntry, world_entry

_LATEST_FORK_S = 1_000_000


def carry(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    forks: Sequence[tuple[float, int]] = (),
    record: bool = True,
    overrides: Overrides = None,
    on_tick: Callable[[Any], None] | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Carry:
    """Carry the scene's object once.

    Args:
        scene: the name of a built-in scene, a TOML file, a table, or a `Scene`.
        controller: a name, ``module:Class``, ``FILE.py:Class``, or a class with a ``step`` (see
            `palmbots.control`).
        world: ``quasistatic``, or ``mujoco``: with mass, wheels and soft contacts (needs the extra
            ``palmbots[mujoco]``). There the trace has more variables, and "bit for bit" holds for
            one kind of processor and one version of MuJoCo.
        precision: ``double`` or ``float``; ``mujoco`` has only ``double``.
        seed: random seed; the same seed gives the same carry, bit for bit.
        forks: pairs (time [s], seed) with increasing times; from each time on, the carry continues
            with the random numbers of that seed. Faults keep their schedule. Only in the world
            ``quasistatic``.
        record: keep the trace and the messages.
        overrides: scene keys to set, such as ``{"radio.loss": 0.1}``.
        on_tick: called with the world at the start and after every tick; only by ``mujoco``.
        on_progress: called now and then with the completed fraction; only by ``mujoco``.

    Raises:
        SceneError: the scene cannot be read or is invalid, or the world or the controller refuses
            it.
        PalmbotsError: another argument is not allowed.
    """
    chosen = load_scene(scene, overrides)
    place = world_entry(world)
    check_precision(place, precision)
    seed = seed_of(seed)
    forked = _forks(forks, place)
    prepared = prepare(chosen, controller, place)
    run = place.run(
        prepared,
        seed,
        precision=precision,
        record=record,
        on_tick=on_tick,
        on_progress=on_progress,
        **({"forks": forked} if forked else {}),
    )
    return make_carry(prepared, seed, run, record=record, precision=precision, forks=forked)


def _forks(forks: Sequence[tuple[float, int]], world: WorldEntry) -> tuple[tuple[float, int], ...]:
    """The forks, checked."""
    allowed = "pairs of a time in s, at least 0 and more than the one before, and a seed"
    checked: list[tuple[float, int]] = []
    for fork in forks:
        if not isinstance(fork, tuple | list) or len(fork) != 2:
            raise PalmbotsError(f"forks: value is {show(fork)}; allowed: {allowed}")
        at_s, seed = fork
        is_number = isinstance(at_s, numbers.Real) and not isinstance(at_s, bool)
        after = checked[-1][0] if checked else -1.0
        if not is_number or not after < at_s <= _LATEST_FORK_S or at_s < 0:
            raise PalmbotsError(f"forks: time is {show(at_s)}; allowed: {allowed}")
        checked.append((float(at_s), seed_of(seed)))
    if checked and not world.supports_forks:
        raise PalmbotsError(
            f"forks: the {world.name} world cannot change its seed; allowed: none, or carry "
            "--world quasistatic"
        )
    return tuple(checked)
