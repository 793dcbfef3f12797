# SPDX-License-Identifier: Apache-2.0
"""The shipped controller `silent` to step by hand, from the compiled code that carries run."""

from typing import cast

import palmbots._core as _core
from palmbots.control.interface import Move, Palm, StepInput, StepOutput
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec


class SilentController:
    """One robot of `silent`: palm and wheels by the sign of its own contact.

    Args:
        scene: the scene, which determines when a robot pauses or stops; the name of a scene, or the
            default scene.
    """

    def __init__(self, scene: Scene | str = "paper") -> None:
        self._spec = to_spec(load_scene(scene), unrolled=True)
        self._core: _core.TableRobot | None = None

    def step(self, seen: StepInput, /) -> StepOutput:
        """Decide for one control period."""
        if self._core is None:  # which robot leads is known from the first step on
            self._core = _core.table_robot("silent", self._spec, seen.leads)
        palm, move, stop, *_ = self._core.step(seen.sign, seen.palm_at_target, 0, 0)
        return StepOutput(palm=cast("Palm", palm), move=cast("Move", move), stop=stop)
