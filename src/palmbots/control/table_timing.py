# SPDX-License-Identifier: Apache-2.0
"""The tables of controllers and their times in a scene, which the core computes
(`sim/table_team.hpp`)."""

from typing import Any

import palmbots._core as _core
from palmbots.control.registry import ControllerEntry
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec


def transition_table(entry: ControllerEntry, scene: Scene) -> dict[str, Any] | None:
    """The table that a controller runs, with its times in a scene; None: it is not such a one."""
    if not entry.runs_in_lanes:
        return None
    return _core.transition_table(entry.name, to_spec(scene, unrolled=True))
