# SPDX-License-Identifier: Apache-2.0
"""One carry: run a scene with a controller once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from palmbots._types import Overrides
from palmbots._util.arguments import seed_of
from palmbots._util.renamed_names import PROGRESS, renamed_arguments
from palmbots.control.registry import ControllerLike
from palmbots.scene.scene import SceneLike, load_scene
from palmbots.simulation.prepare import prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import check_precision, world_entry

__all__ = ["carry"]


@renamed_arguments(watch="on_tick", **PROGRESS)
def carry(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
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
    prepared = prepare(chosen, controller, place)
    run = place.run(
        prepared,
        seed,
        precision=precision,
        record=record,
        on_tick=on_tick,
        on_progress=on_progress,
    )
    return make_carry(prepared, seed, run, record=record, precision=precision)
