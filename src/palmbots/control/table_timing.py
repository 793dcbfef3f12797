# SPDX-License-Identifier: Apache-2.0
"""The tables of controllers and their times in a scene.

The core computes the times (`sim/table_team.hpp`); this module states in one line what to change in
a scene whose lease is too short for the round trip of two beacons.
"""

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


def short_lease_warning(entry: ControllerEntry, scene: Scene) -> str | None:
    """The warning, in one line, for a lease within which a beacon may not be answered in time.

    Below twice the latency of the radio no beacon is answered in time: the controller carries as
    `silent` does. From there up to the lease named in the warning, some answers arrive in time.
    """
    table = transition_table(entry, scene)
    if table is None or "shortest_lease_s" not in table:
        return None
    lease, shortest = table["lease_s"], table["shortest_lease_s"]
    if lease > shortest - 1e-9:
        return None
    return (
        f"radio.lease_s: {lease:g} s is shorter than the round trip of two beacons, "
        f"{shortest:g} s: a robot takes its partner for silent although no message is lost, and "
        f"{entry.name} works like silent meanwhile (raise it, or lower radio.latency_s or "
        "radio.beacon_s)"
    )
