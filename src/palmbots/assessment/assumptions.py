# SPDX-License-Identifier: Apache-2.0
"""Which values of a scene are assumed rather than measured, as far as palmbots can know."""

from __future__ import annotations

from typing import Any

from palmbots._types import Interval
from palmbots.assessment.answer import Answer
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side, value_of

FRICTION = "palm.friction"
DECISIVE = (
    FRICTION, "robot.noise_m_s", "object.mass_kg", "object.com_m", "object.depth_m",
    "radio.latency_s", "mujoco.palm_torque_n_m",
)  # fmt: skip
"""Keys of what users seldom know exactly, and on which most answers depend."""


def assumed(scene: Scene) -> dict[str, Any]:
    """Those of the decisive keys that have their default, with that value. The default of the COM
    and of the mass follows from the outline of the object."""
    outline = {"vertices_m": scene.object.vertices_m, "contacts": scene.object.contacts}
    try:
        usual = load_scene({"object": outline})
    except SceneError:  # on these contacts the object tips over by itself unless its COM is set
        usual = Scene()
    found = {}
    for key in DECISIVE:
        default = value_of(usual, key)
        for one in on_every_side(scene, {key: None}):
            if value_of(scene, one) == default:
                found[one] = default
    return found


def on_assumptions(scene: Scene, friction: Interval | None = None) -> Answer:
    """What the answers take for granted. Whether it is true palmbots cannot know.

    Args:
        scene: whose values they are.
        friction: the interval that was assessed; None: the scene's own values were.
    """
    values = assumed(scene)
    keys = on_every_side(scene, dict.fromkeys(DECISIVE))
    given = {key: value_of(scene, key) for key in keys if key not in values}
    if friction is not None:
        for key in on_every_side(scene, {FRICTION: None}):
            values.pop(key, None)
            given.pop(key, None)
        given = {FRICTION: "from {:g} to {:g} (--friction)".format(*friction), **given}
    texts = []
    if values:
        texts.append(f"defaults: {_listed(values)}")
    if given:
        texts.append(f"given: {_listed(given)}")
    text = "; ".join(texts)
    return Answer("Are the values measured?", "open", text, "palmbots keys")


def _listed(values: dict[str, Any]) -> str:
    return ", ".join(f"{key} {_text(value)}" for key, value in values.items())


def _text(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(f'{one:g}' for one in value)}]"
    return value if isinstance(value, str) else f"{value:g}"
