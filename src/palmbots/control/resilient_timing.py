# SPDX-License-Identifier: Apache-2.0
"""The time bounds of the resilient algorithm in a scene, and the refusal of a scene without any.

The core computes them (`control/resilient_timing.hpp` has the derivation). This module names them
and states in one line what to change in a scene that is refused.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

_NEED = "radio delays of {delay} s and beacons every {beacon} s need at least {shortest}"
_ROOM = (
    "with more, a robot that travels alone, and the noise, could shift a contact by more than "
    "the {room} mm from the zero zone to the end of its palm"
)
_RANGE = (
    "allowed with controller resilient: a number in s, from {shortest} "
    f"({_NEED}) to {{longest}} ({_ROOM})"
)

REFUSALS = {
    "beacon": "radio.beacon_s: {beacon} is shorter than control.period_s; allowed with "
    "controller resilient: a number in s, at least {period}",
    "short": f"radio.lease_s: {{lease}} is too short; {_RANGE}",
    "long": f"radio.lease_s: {{lease}} is too long; {_RANGE}",
    "impossible": "radio.lease_s: no value is possible with controller resilient: "
    f"{_NEED}, but at most {{longest}} is allowed: {_ROOM}; lower radio.latency_s, "
    "radio.jitter_s, radio.beacon_s or robot.speed_m_s",
    "no room": "{zone}; allowed with controller resilient: a zero zone that ends less than {reach} "
    "m from the pivot, on the usable part of the palm",
}
"""Why a scene is refused, with names in braces for what is filled in: times in s, the room in mm.
The first three in the order of the core's problems; the page fills in the same sentences."""


@dataclass(frozen=True, slots=True, repr=False)
class Bounds(Result):
    """The times and distances on which the resilient algorithm relies, in seconds and metres."""

    beacon_s: float
    """The beacon period."""
    delay_s: float
    """The radio's longest delay."""
    shortest_lease_s: float
    """The minimum with a perfect radio: two delays, two beacon periods, two ticks."""
    lease_s: float
    """A beacon that may be older than this counts as silence (Tm and Tc)."""
    longest_lease_s: float
    """With this lease skew and noise together equal the room."""
    losses: int
    """How many beacons in a row may be lost before a robot stops."""
    hold_s: float
    """How long a palm stays up for a partner that fell silent, or after a boot (Tp and Tb)."""
    alone_s: float
    """The longest time for which one robot travels while the other stands, whatever the radio
    does."""
    skew_m: float
    """The largest shift of a contact from that, and from starts one after the other, without
    noise."""
    noise_m: float
    """What the robots' bias and one standard deviation of their noise add to the skew, and what a
    contact may have moved beyond its zero zone before the fault."""
    room_m: float
    """The distance from the zero zone to the end of the palm."""
    is_noisy: bool
    """Whether the noise leaves no room for any lease; the shortest one is used then."""

    def lines(self) -> Iterator[Item]:
        """The lease and the leases that are possible, the other times, and how far a contact can
        shift."""
        low, high = self.shortest_lease_s, self.longest_lease_s
        yield f"lease {self.lease_s:g} s (possible: {low:g} to {high:g} s)"
        yield Table([
            ("  beacons", f"every {self.beacon_s:g} s; {self.losses} in a row may be lost"),
            ("  radio delay", f"at most {self.delay_s:g} s"),
            ("  palm stays up", f"{self.hold_s:g} s without a beacon"),
            ("  robot travels alone", f"at most {self.alone_s:g} s"),
            ("  shift", f"{millimetres(self.skew_m)}, noise {millimetres(self.noise_m)}"),
            ("  room", f"{millimetres(self.room_m)} to the end of the palm"),
        ])  # fmt: skip


def bounds_of(scene: Scene) -> Bounds:
    """The bounds of a scene.

    Raises `SceneError`, one line, for a scene in which the algorithm cannot hold the object.
    """
    computed: dict[str, Any] = _core.resilient_timing(to_spec(scene, unrolled=True))
    problem = computed.pop("problem")
    bounds = Bounds(**computed)
    if problem:
        raise SceneError(_refusal(scene, bounds, problem))
    return bounds


def _refusal(scene: Scene, b: Bounds, problem: str) -> str:
    half_width = f"tactile.zero_half_width_m: value is {scene.tactile.zero_half_width_m:g}"
    if problem != "beacon" and b.room_m <= 0:
        problem = "no room"
    elif problem != "beacon" and b.shortest_lease_s > b.longest_lease_s:
        problem = "impossible"
    return REFUSALS[problem].format(
        zone=half_width
        if scene.tactile.zones is None
        else "tactile.zones: too much of a palm reads 0",
        reach=f"{min(scene.palm_of(side).reach_m for side in SIDES):g}",
        beacon=f"{scene.radio.beacon_s if problem == 'beacon' else b.beacon_s:g}",
        period=f"{scene.control.period_s:g}",
        delay=f"{b.delay_s:g}",
        shortest=f"{b.shortest_lease_s:g}",
        lease=f"{b.lease_s:g}",
        longest=f"{max(b.longest_lease_s, 0):g}",
        room=f"{1e3 * b.room_m:.1f}",
    )
