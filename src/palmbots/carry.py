"""One carry: run a scene with a controller, and get back what happened."""

from collections.abc import Callable, Mapping
from typing import Any

from palmbots import _core
from palmbots.bounds import bounds_of
from palmbots.controllers import Controller, adapted_pair
from palmbots.errors import one_of, seed_of
from palmbots.lowering import lower
from palmbots.result import Carry, finished
from palmbots.scene import load_scene

__all__ = ["CONTROLLERS", "PRECISIONS", "WORLDS", "carry"]

CONTROLLERS = ("none", "centralized", "distributed", "resilient")
WORLDS = ("quasistatic", "mujoco")
PRECISIONS = ("double", "float")


def carry(
    scene: Any = "paper",
    controller: str | Callable[[], Controller] = "distributed",
    *,
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    record: bool = True,
    overrides: Mapping[str, Any] | None = None,
    progress: Callable[[float], None] | None = None,
    watch: Callable[[Any], None] | None = None,
) -> Carry:
    """Carry the scene's object once.

    Args:
        scene: the name of a built-in scene, a TOML file, a table, or a `Scene`.
        controller: ``none``, ``centralized``, ``distributed``, ``resilient``, or something that
            makes a controller when called, such as a class with a ``step`` (see
            `palmbots.controllers`).
        world: ``quasistatic``, or ``mujoco``: with mass, wheels and soft contacts (needs the extra
            ``palmbots[mujoco]``). There the trace has more variables, and "bit for bit" holds for
            one kind of processor and version of MuJoCo.
        precision: ``double`` or ``float``; ``mujoco`` knows only ``double``.
        seed: of all that is random; the same seed gives the same carry, bit for bit.
        record: keep the trace and the letters.
        overrides: scene keys to set, such as ``{"radio.loss": 0.1}``.
        progress: called now and then with the fraction that is done; only by ``mujoco``.
        watch: called with the `palmbots.dynamic.world.MujocoWorld` at the start and after every
            tick; only by ``mujoco``.

    Raises:
        SceneError: the scene cannot be read or makes no sense, or the resilient algorithm cannot
            keep its bounds in it.
        PalmbotsError: any other argument is not one of those above.
    """
    chosen = load_scene(scene, overrides)
    one_of("world", world, WORLDS)
    one_of("precision", precision, PRECISIONS)
    seed = seed_of(seed)
    if isinstance(controller, str):
        one_of("controller", controller, CONTROLLERS)
        name, core_controller = controller, controller
    else:
        core_controller = adapted_pair(controller)
        name = getattr(controller, "__name__", type(controller).__name__)
    if name == "resilient":
        bounds_of(chosen)  # before anything runs: it refuses scenes
    run: Any  # the compiled module's stub knows the shapes of Python types, not their contents
    if world == "mujoco":
        from palmbots.dynamic.run import run as run_in_mujoco

        one_of("precision (world mujoco)", precision, ("double",))
        run, physics, left = run_in_mujoco(
            chosen, core_controller, seed, record=record, watch=watch, progress=progress
        )
    else:
        run = _core.run(lower(chosen), core_controller, seed, precision, record)
        physics, left = None, None
    return finished(
        run, chosen, name, world, seed, record,
        precision=precision, physics=physics, left=left,
    )  # fmt: skip
