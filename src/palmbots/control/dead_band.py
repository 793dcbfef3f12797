# SPDX-License-Identifier: Apache-2.0
"""The dead-band law, and all that is known to be wrong before a carry starts.

The core computes both (`sim/scene_warnings.hpp` has the law), for the page, too.
"""

from __future__ import annotations

import palmbots._core as _core
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given


def overrun_m(scene: Scene, controller: str | ControllerEntry) -> float:
    """How far [m] a contact can overrun the edge of its zero zone while the other contact is in its
    zone; 0 without a controller. The limit does not cover `silent`, which may stop a robot during
    a correction.

    With u the correction speed of a robot, T its control period and D the delay of the radio, a
    contact overruns by u T and the braking distance where one robot drives. Where both drive by
    both signs (shared-sign), the partner learns of the zero only D later: the sum of u (D + T) and
    the braking distance over both robots. D is a whole number of control periods.
    """
    entry = resolve(controller)
    return _core.overrun(as_given(scene), _registered(entry), entry.team)


def zero_zone_m(scene: Scene) -> float:
    """The width of the zone between − and + in which the sensor reads 0 [m]."""
    low, high = zero_zone_edges_m(scene)
    return high - low


def zero_zone_edges_m(scene: Scene) -> tuple[float, float]:
    """Where the sensor stops reading − and starts reading + [m]; infinite where it never does."""
    return _core.zero_zone(as_given(scene))


def warnings_before(scene: Scene, controller: str | ControllerEntry) -> tuple[str, ...]:
    """The warnings that are known before a carry starts."""
    entry = resolve(controller)
    if not entry.is_reference:
        return tuple(_core.warnings_before(as_given(scene), _registered(entry), entry.team))
    about = (
        f"{entry.name} is a reference with full information: it reads the simulated state, and "
        "no robot can run it"
    )
    # It uses neither sensor nor radio.
    return (about, *_core.warnings_before(as_given(scene), "", "none"))


def _registered(entry: ControllerEntry) -> str:
    """Its name, if the core has it."""
    return entry.name if entry.runs_in_lanes else ""
