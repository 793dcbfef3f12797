"""What the trace of the dynamic world holds besides what every trace holds: units and meanings."""

from dataclasses import dataclass

__all__ = ["COLUMNS", "LOGGED", "Measured"]


@dataclass(frozen=True, slots=True)
class Measured:
    """What the trace of the dynamic world holds besides that of every world; of one tick."""

    force: tuple[float, float]
    """With which the object presses on each palm, along its normal [N]."""
    drag: tuple[float, float]
    """With which it drags each palm along, outward [N]."""
    speed: tuple[float, float]
    """Of the pivots over the tick [m/s]."""
    slip: tuple[float, float]
    """By how much the wheels run ahead of the robot [m/s]."""
    pitch: tuple[float, float]
    """Of the robots' bodies, outward end up [rad]."""
    yaw: tuple[float, float]
    """Of the robots' bodies, anticlockwise seen from above [rad]."""
    across: tuple[float, float]
    """Of the middles of the contact edges on their palms, to the left seen towards +x [m]."""
    pivot_x: tuple[float, float]
    pivot_y: tuple[float, float]
    """Places of the pivots on the floor [m]."""
    vertex_x: tuple[float, float]
    vertex_y: tuple[float, float]
    """Places of the middles of the contact edges [m]."""


COLUMNS = {
    "force": ("N", "force of the object on each palm, along its normal"),
    "drag": ("N", "force of the object on each palm, along it, outward"),
    "speed": ("m/s", "speed of the pivot over the following tick"),
    "slip": ("m/s", "by how much the wheels run ahead of the robot"),
    "pitch": ("rad", "pitch of the robot's body, its outward end up"),
    "yaw": ("rad", "heading of the robot's body, anticlockwise seen from above"),
    "across": (
        "m",
        "contact coordinate across the palm, to the left seen from left robot to right",
    ),
    "pivot_x": ("m", "place of the pivot on the floor, x"),
    "pivot_y": ("m", "place of the pivot on the floor, y, to the left of x"),
    "vertex_x": ("m", "place of the middle of the contact edge, x"),
    "vertex_y": ("m", "place of the middle of the contact edge, y"),
}

LOGGED = (
    ("force", "force_n"),
    ("drag", "drag_n"),
    ("slip", "slip_m_s"),
    ("pitch", "pitch_rad"),
    ("yaw", "yaw_rad"),
    ("across", "across_m"),
    ("pivot_x", "pivot_x_m"),
    ("pivot_y", "pivot_y_m"),
    ("vertex_x", "vertex_x_m"),
    ("vertex_y", "vertex_y_m"),
)
"""Variable of the trace, field of the log's message; `speed` is logged for every world."""
