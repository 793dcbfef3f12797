"""The same carry, only slower: what a world makes of it tells how much accelerations matter.

With every time `factor` times as long, speeds are 1/factor and accelerations 1/factor² of what
they were. Where inertia plays no part nothing else changes: contacts take the same path, tick for
tick. What does change is due to accelerations alone.
"""

from typing import Any

from palmbots.errors import PalmbotsError, show
from palmbots.scene import Scene, load_scene

__all__ = ["slow_motion"]

# By what a key is multiplied, as its unit says: a power of the factor. The first that fits counts.
_POWERS = (("_m_s2", -2), ("_m_s", -1), ("_deg_s", -1), ("_per_s", -1), ("_s", 1))
_AS_THEY_ARE = ("dynamic",)  # of the engine and of the floor: its time step stays


def slow_motion(scene: Scene, factor: float) -> Scene:
    """The scene, `factor` times slower. Raises `SceneError` where a key would leave its range."""
    if not factor > 0:
        raise PalmbotsError(f"slow_motion: factor is {show(factor)}; allowed: a number above 0")
    table = scene.model_dump()
    kept = {name: table.pop(name) for name in _AS_THEY_ARE}
    return load_scene(_slowed(table, factor) | kept)


def _slowed(value: Any, factor: float) -> Any:
    if isinstance(value, dict):
        return {key: _number(key, one, factor) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_slowed(one, factor) for one in value]
    return value


def _number(key: str, value: Any, factor: float) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return _slowed(value, factor)
    power = next((power for suffix, power in _POWERS if key.endswith(suffix)), 0)
    return value * factor**power if power else value
