# SPDX-License-Identifier: Apache-2.0
"""What the station knows of the robots, as text: for the screen and for plain lines."""

from typing import Any

from palmbots._types import SIDES

UNKNOWN = "–"
_SIGNS = {-1: "−1, contact inward", 0: "0, contact centred", 1: "+1, contact outward"}
_CASES = {
    "": "none",
    "a": "(a) moves away",
    "b": "(b) moves away, then assists",
    "c": "(c) assists",
    "d": "(d) moves closer",
}
_BAR = 12


def sign_text(robot: dict[str, Any]) -> str:
    """The tactile sign of the contact coordinate."""
    return _SIGNS[robot["sign"]]


def palm_text(robot: dict[str, Any]) -> str:
    """The palm angle last commanded, and whether it is reached."""
    return robot["palm"] + ("" if robot["palm_at_target"] else ", turning")


def case_text(robot: dict[str, Any]) -> str:
    """The case of Table 1 or Table 2."""
    return _CASES.get(robot["case"], f"({robot['case']})")


def link_text(robot: dict[str, Any]) -> str:
    """Losses and round trip."""
    loss, trip = robot["loss"], robot["round_trip_s"]
    lost = UNKNOWN if loss is None else f"{100 * loss:.0f} % lost"
    return f"{lost}, {UNKNOWN if trip is None else f'{1000 * trip:.0f} ms round trip'}"


def battery_text(robot: dict[str, Any]) -> str:
    """The voltage."""
    volts = robot["battery_v"]
    return "not measured" if volts is None else f"{volts:.1f} V"


def progress_text(robot: dict[str, Any]) -> str:
    """The covered part of the distance, with a bar."""
    part = robot["progress"]
    if part is None:
        return UNKNOWN
    full = round(_BAR * part)
    return f"{'█' * full}{'░' * (_BAR - full)} {100 * part:3.0f} %"


def plain_status(state: dict[str, Any]) -> list[str]:
    """One line for each robot, and one for each warning."""
    lines = [
        f"{state['time_s']:7.2f} s  {side:5}  {_line(state['robots'][side])}" for side in SIDES
    ]
    absent = {side for side in SIDES if not (state["robots"][side] or {}).get("is_heard")}
    return lines + [
        f"{state['time_s']:7.2f} s  warning: {text}"
        for text in state["warnings"]
        if text.partition(":")[0] not in absent  # its line says that it is not heard
    ]


def _line(robot: dict[str, Any] | None) -> str:
    if robot is None:
        return "not heard yet"
    if not robot["is_heard"]:
        return f"not heard for {robot['silent_s']:.0f} s; was {robot['mode']}"
    part = robot["progress"]
    battery = [] if robot["battery_v"] is None else [battery_text(robot)]
    return ", ".join([
        robot["mode"] + (f" ({robot['reason']})" if robot["reason"] else ""),
        f"sign {robot['sign']:+d}" if robot["sign"] else "sign 0",
        f"palm {palm_text(robot)}",
        UNKNOWN if part is None else f"{100 * part:.0f} %",
        link_text(robot),
        *battery,
    ])  # fmt: skip
