# SPDX-License-Identifier: Apache-2.0
"""The variables that the world `mujoco` adds to the trace."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Measured:
    """The values of one tick; pairs are (left, right)."""

    force: tuple[float, float]
    """Normal force of the object on each palm [N]."""
    friction_force: tuple[float, float]
    """Force of the object on each palm along it, outward [N]."""
    speed: tuple[float, float]
    """Mean speeds of the pivots in the tick [m/s]."""
    wheel_slip: tuple[float, float]
    """Rim speeds of the wheels minus the speeds of the robots [m/s]."""
    pitch: tuple[float, float]
    """Pitch of the bodies, outward end up [rad]."""
    yaw: tuple[float, float]
    """Heading of the bodies, anticlockwise seen from above [rad]."""
    lateral: tuple[float, float]
    """Lateral positions of the middles of the contact edges on their palms, to the left seen
    towards +x [m]."""
    pivot_x: tuple[float, float]
    pivot_y: tuple[float, float]
    """Positions of the pivots on the floor [m]."""
    vertex_x: tuple[float, float]
    vertex_y: tuple[float, float]
    """Positions of the middles of the contact edges [m]."""


def _attrs(units: str, long_name: str, log_field: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name, "log_field": log_field}


_D = "dynamics/"  # channel of these fields in a log

COLUMNS = {
    "force": _attrs("N", "force of the object on each palm, along its normal", _D + "force_n"),
    "friction_force": _attrs(
        "N", "force of the object on each palm, along it, outward", _D + "friction_force_n"
    ),
    "speed": _attrs("m/s", "speed of the pivot over the following tick", "speed_m_s"),
    "wheel_slip": _attrs(
        "m/s", "speed of the wheels' rims minus that of the robot", _D + "wheel_slip_m_s"
    ),
    "pitch": _attrs("rad", "pitch of the robot's body, its outward end up", _D + "pitch_rad"),
    "yaw": _attrs(
        "rad", "heading of the robot's body, anticlockwise seen from above", _D + "yaw_rad"
    ),
    "lateral": _attrs(
        "m",
        "contact coordinate across the palm, to the left seen from left robot to right",
        _D + "lateral_m",
    ),
    "pivot_x": _attrs("m", "position of the pivot on the floor, x", _D + "pivot_x_m"),
    "pivot_y": _attrs(
        "m", "position of the pivot on the floor, y, to the left of x", _D + "pivot_y_m"
    ),
    "vertex_x": _attrs("m", "position of the middle of the contact edge, x", _D + "vertex_x_m"),
    "vertex_y": _attrs("m", "position of the middle of the contact edge, y", _D + "vertex_y_m"),
}
"""Attributes of each variable (`palmbots.simulation.trace`); `speed` replaces that of the core."""
