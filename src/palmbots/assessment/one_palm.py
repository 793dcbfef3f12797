# SPDX-License-Identifier: Apache-2.0
"""Answers about a job in which one palm at a time holds the object, where those for two palms do
not apply."""

from __future__ import annotations

import math
from typing import Any

from palmbots._types import SIDES, Interval
from palmbots.assessment.answer import Answer
from palmbots.errors import PalmbotsError
from palmbots.mechanics.lifting import check_lift
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene, load_scene

_MOST = 2.0  # friction coefficient
_HALVINGS = 24


def one_palm_answers(scene: Scene, name: str) -> dict[str, Answer]:
    """The answers by their names in `Answers`."""
    how = "one palm at a time holds the object"
    found = {
        "controllers": Answer(
            "Which controllers suffice?", "yes",
            f"any: {how}, so the controllers have nothing to do", command_text("analyze", name),
        ),
        "angles": Answer(
            "Are the palm angles right?", "open",
            f"pairs of angles are compared for two palms only, and {how}; each angle is among the "
            "changes below", command_text("analyze", name),
        ),
        "friction": _on_friction(scene, name),
        "curve": Answer(
            "Does it survive a curve?", "open", f"{how}, and such jobs were not tried on curves",
            command_text("carry", name, world="mujoco"),
        ),
    }  # fmt: skip
    if scene.task.dock == "alone":
        found["radio"] = Answer(
            "Does it survive lost messages?", "yes", "one robot alone needs no messages",
            command_text("carry", name),
        )  # fmt: skip
    return found


def _on_friction(scene: Scene, name: str) -> Answer:
    low, high = friction_range(scene)
    most = f"to {high:.3f}" if high < _MOST else "on"
    text = f"the closed forms permit the job for a friction of the palms from {low:.3f} {most}"
    return Answer("Is the friction right?", "yes", text, command_text("analyze", name))


def friction_range(scene: Scene) -> Interval:
    """The friction coefficients of the palms, around those of the scene, with which the job may
    begin; both palms are multiplied by the same factor."""
    own = [scene.palm_of(side).friction for side in SIDES]
    least = min(own)

    def works(friction: float) -> bool:
        keys: dict[str, Any] = {
            f"palm.{side}.friction": friction * mu / least
            for side, mu in zip(SIDES, own, strict=True)
        }
        try:
            check_lift(load_scene(scene, keys))
        except PalmbotsError:
            return False
        return True

    ends = []
    for end in (0.01, _MOST):
        good, bad = least, end
        for _ in range(_HALVINGS if works(least) and not works(end) else 0):
            middle = math.sqrt(good * bad)
            good, bad = (middle, bad) if works(middle) else (good, middle)
        ends.append(good if works(least) and not works(end) else end)
    return ends[0], ends[1]
