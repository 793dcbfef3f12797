"""The time bounds of the resilient algorithm in a scene, and the refusal of one that has none.

They are worked out by the core (`resilient_bounds.hpp`, with the derivation); here they get names
and a line that says what to change.
"""

from dataclasses import dataclass
from typing import Any

from palmbots import _core
from palmbots.errors import SceneError
from palmbots.lowering import lower
from palmbots.scene import Scene

__all__ = ["Bounds", "bounds_of"]


@dataclass(frozen=True, slots=True)
class Bounds:
    """What the resilient algorithm counts on, in seconds and metres."""

    beacon_s: float
    """A robot with nothing new to say sends a beacon so often."""
    delay_s: float
    """The radio's longest delay."""
    shortest_lease_s: float
    """A perfect radio needs so much: two delays, two beacon periods, two ticks."""
    lease_s: float
    """A beacon that may be older counts as silence (Tm and Tc)."""
    longest_lease_s: float
    """The skew would fill the room."""
    losses: int
    """So many beacons in a row may be lost before anybody stops."""
    hold_s: float
    """A palm stays up so long for a partner that fell silent, or after a boot (Tp and Tb)."""
    alone_s: float
    """The longest that one robot travels while the other rests, whatever the radio does."""
    skew_m: float
    """By how much that, and a start one after the other, shift a contact at most, besides noise."""
    room_m: float
    """From the zero zone to the end of the palm."""


def bounds_of(scene: Scene) -> Bounds:
    """The bounds of a scene.

    Raises `SceneError`, one line, for a scene in which the algorithm cannot keep the object.
    """
    told: dict[str, Any] = _core.resilient_bounds(lower(scene, unrolled=True))
    problem = told.pop("problem")
    bounds = Bounds(**told)
    if problem:
        raise SceneError(_refusal(scene, bounds, problem))
    return bounds


def _refusal(scene: Scene, b: Bounds, problem: str) -> str:
    if problem == "beacon":
        period = scene.control.period_s
        return (
            f"radio.beacon_s: {scene.radio.beacon_s:g} is shorter than control.period_s; allowed "
            f"with controller resilient: a number in s, at least {period:g}"
        )
    need = (
        f"radio delays of {b.delay_s:g} s and beacons every {b.beacon_s:g} s need at least "
        f"{b.shortest_lease_s:g}"
    )
    room = (
        f"with more, a robot alone could shift a contact by more than the {1e3 * b.room_m:.1f} mm "
        f"from the zero zone to the end of its palm"
    )
    if b.shortest_lease_s > b.longest_lease_s:
        return (
            f"radio.lease_s: none will do with controller resilient: {need}, but at most "
            f"{max(b.longest_lease_s, 0):g} is allowed: {room}; lower radio.latency_s, "
            "radio.jitter_s, radio.beacon_s or robot.speed_m_s"
        )
    return (
        f"radio.lease_s: {b.lease_s:g} is too {problem}; allowed with controller resilient: a "
        f"number in s, from {b.shortest_lease_s:g} ({need}) to {b.longest_lease_s:g} ({room})"
    )
