# SPDX-License-Identifier: Apache-2.0
"""Keys that a side or a sender may override: ``robot.left.noise_m_s`` beside ``robot.noise_m_s``.

The key without a side holds for every side or sender that has no value of its own. A change that is
to act everywhere therefore has to change the overrides, too; if both sides override a key, the key
without a side has no effect. Code that sets or multiplies such keys uses the functions here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.scene.overrides import leaves, merged

if TYPE_CHECKING:
    from palmbots.scene.scene import Scene

_HOLDERS = {"palm": SIDES, "robot": SIDES, "radio": (*SIDES, "station")}
_EITHER = ("friction", "friction_angle_deg")  # a side with one of them ignores both of the pair


def overriding(scene: Scene, key: str) -> tuple[str, ...]:
    """The sides and senders with a value of their own for a key without a side."""
    section, _, name = key.partition(".")
    names = _EITHER if key.startswith("palm.") and name in _EITHER else (name,)
    found = []
    for holder in _HOLDERS.get(section, ()):
        own = getattr(getattr(scene, section), holder)
        if any(getattr(own, one, None) is not None for one in names):
            found.append(holder)
    return tuple(found)


def on_every_side(scene: Scene, keys: Mapping[str, Any]) -> dict[str, Any]:
    """These keys with all their overrides, so that each value holds for every side and sender."""
    found: dict[str, Any] = {}
    for key, value in keys.items():
        own = overriding(scene, key)
        if not _is_without_effect(own):
            found[key] = value
        found |= {_key_of(key, holder): value for holder in own}
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
    for side in SIDES if section in ("palm", "robot") else ():
        if (side in own_ones) == bool(own):
            parameters = scene.palm_of(side) if section == "palm" else scene.robot_of(side)
            return getattr(parameters, own or name)
    found: Any = scene
    for part in key.split("."):
        found = getattr(found, part)
    if found is None and own and holder in _HOLDERS.get(section, ()):
        return value_of(scene, f"{section}.{own}")
    return list(found) if isinstance(found, tuple) else found


def refuse_without_effect(scene: Scene, changes: Mapping[str, Any], called: str) -> None:
    """Raise `SceneError` for a change without effect: of a key without a side that both sides
    override, unless `changes` also sets both overrides. `scene` has the changes already."""
    given = merged({}, changes)
    for section in _HOLDERS:
        if not isinstance(given.get(section), Mapping):
            continue
        keys = {k for k, value in leaves(section, given[section]).items() if value is not None}
        for key in sorted(keys):
            own = overriding(scene, key)
            if _is_without_effect(own) and not {_key_of(key, one) for one in SIDES} <= keys:
                ones = " and ".join(_key_of(key, one) for one in SIDES)
                raise SceneError(f"{called} {key}: both sides override it; allowed: {ones}")


def _is_without_effect(overriding: tuple[str, ...]) -> bool:
    """Whether both robots have values of their own. That the station may have none does not count,
    because it has a key of its own."""
    return set(SIDES) <= set(overriding)


def _key_of(key: str, holder: str) -> str:
    return key.replace(".", f".{holder}.", 1)
