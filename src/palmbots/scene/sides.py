# SPDX-License-Identifier: Apache-2.0
"""Keys that a side or a sender may override: ``robot.left.noise_m_s`` beside ``robot.noise_m_s``.

The key without a side holds for every side or sender that has no value of its own. A change that is
to act everywhere therefore has to change the overrides, too; if both sides override a key, the key
without a side has no effect. Code that sets or multiplies such keys uses the functions here.
"""

from collections.abc import Mapping
from typing import Any

from palmbots._types import SIDES
from palmbots.scene.overrides import HOLDERS, has_no_effect, key_of, overriding
from palmbots.scene.scene import Scene


def on_every_side(scene: Scene, keys: Mapping[str, Any]) -> dict[str, Any]:
    """These keys with all their overrides, so that each value holds for every side and sender."""
    found: dict[str, Any] = {}
    for key, value in keys.items():
        own = overriding(scene, key)
        if not has_no_effect(own):
            found[key] = value
        found |= {key_of(key, holder): value for holder in own}
    return found


def multiplied(scene: Scene, key: str, factor: float) -> dict[str, float]:
    """The values of a key and its overrides, multiplied; those that are no numbers are left out."""
    found = {}
    for one in on_every_side(scene, {key: None}):
        value = value_of(scene, one)
        if isinstance(value, int | float):
            found[one] = factor * value
    return found


def value_of(scene: Scene, key: str) -> Any:
    """The value that is in force for a dotted key.

    ``robot.left.noise_m_s`` has that of ``robot.noise_m_s`` unless the left robot overrides it. A
    friction that is given as an angle has the coefficient that follows from it.
    """
    section, _, name = key.partition(".")
    holder, _, own = name.partition(".")
    own_ones = [holder] if holder in SIDES else overriding(scene, key)
    of_side = {"palm": scene.palm_of, "robot": scene.robot_of, "arm": scene.arm.of}
    for side in SIDES if section in of_side else ():
        if (side in own_ones) == bool(own):
            return getattr(of_side[section](side), own or name)
    found: Any = scene
    for part in key.split("."):
        found = getattr(found, part)
    if found is None and own and holder in HOLDERS.get(section, ()):
        return value_of(scene, f"{section}.{own}")
    return list(found) if isinstance(found, tuple) else found
