"""What the trace of the dynamic world holds besides what every trace holds: units and meanings."""

__all__ = ["COLUMNS", "LOGGED"]

COLUMNS = {
    "force": ("N", "force of the object on each palm, along its normal"),
    "drag": ("N", "force of the object on each palm, along it, outward"),
    "speed": ("m/s", "speed of the pivot over the following tick"),
    "slip": ("m/s", "by how much the wheels run ahead of the robot"),
    "pitch": ("rad", "pitch of the robot's body, its outward end up"),
    "yaw": ("rad", "heading of the robot's body, anticlockwise seen from above"),
}

LOGGED = (
    ("force", "force_n"),
    ("drag", "drag_n"),
    ("slip", "slip_m_s"),
    ("pitch", "pitch_rad"),
    ("yaw", "yaw_rad"),
)
"""Variable of the trace, field of the log's message; `speed` is logged for every world."""
