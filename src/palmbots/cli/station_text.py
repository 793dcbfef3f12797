# SPDX-License-Identifier: Apache-2.0
"""What the station knows of the robots, as text: for the screen and for plain lines."""

from typing import Any

from palmbots.control.registry import describe

UNKNOWN = "–"
_SIGNS = {-1: "−1, contact inward", 0: "0, contact centred", 1: "+1, contact outward"}
_BAR = 12
_WIDTH = 80  # columns


def sign_text(robot: dict[str, Any]) -> str:
    """The tactile sign of the contact coordinate."""
    return _SIGNS[robot["sign"]]


def palm_text(robot: dict[str, Any]) -> str:
    """The palm angle last commanded, and whether it is reached."""
    return robot["palm"] + ("" if robot["palm_at_target"] else ", turning")


def case_text(robot: dict[str, Any], controller: str) -> str:
    """The case of Table 1 or Table 2, as this controller defines it."""
    case = robot["case"]
    return f"({case}) {describe(controller).cases.get(case, '')}".rstrip() if case else "none"


def link_text(robot: dict[str, Any], *, in_words: bool = True) -> str:
    """Losses and round trip."""
    loss, trip = robot["loss"], robot["round_trip_s"]
    lost = UNKNOWN if loss is None else f"{100 * loss:.0f} % lost"
    what = " round trip" if in_words else ""
    return f"{lost}, {UNKNOWN if trip is None else f'{1000 * trip:.0f} ms{what}'}"


def battery_text(robot: dict[str, Any]) -> str:
    """The voltage."""
    volts = robot["battery_v"]
    return "not measured" if volts is None else f"{volts:.1f} V"


def progress_text(robot: dict[str, Any]) -> str:
    """The covered part of the distance, with a bar; and the phase of a job on the floor."""
    part = robot["progress"]
    if part is None:
        return UNKNOWN
    full = round(_BAR * part)
    phase = f"  {robot['phase']}" if robot["phase"] else ""
    return f"{'█' * full}{'░' * (_BAR - full)} {100 * part:3.0f} %{phase}"


def plain_status(state: dict[str, Any]) -> list[str]:
    """One line for each robot, within 80 columns, and one for each warning."""
    lines = []
    for side, robot in state["robots"].items():
        head = f"{state['time_s']:7.2f} s  {side:5}  "
        lines.append(head + _line(robot, _WIDTH - len(head)))
    absent = {side for side, one in state["robots"].items() if not (one or {}).get("is_heard")}
    return lines + [
        f"{state['time_s']:7.2f} s  warning: {text}"
        for text in state["warnings"]
        if text.partition(":")[0] not in absent  # its line says that it is not heard
    ]


def _line(robot: dict[str, Any] | None, width: int) -> str:
    """What matters most comes first; what follows a long reason is left out."""
    if robot is None:
        return "not heard yet"
    if not robot["is_heard"]:
        return f"not heard for {robot['silent_s']:.0f} s; was {robot['mode']}"
    part = robot["progress"]
    battery = [] if robot["battery_v"] is None else [battery_text(robot)]
    parts = [
        robot["mode"] + (f" ({robot['reason']})" if robot["reason"] else ""),
        *([robot["phase"]] if robot["phase"] else []),
        f"sign {robot['sign']:+d}" if robot["sign"] else "sign 0",
        f"{'palm' if robot['palm_at_target'] else 'turns to'} {robot['palm']}",
        UNKNOWN if part is None else f"{100 * part:.0f} %",
        link_text(robot, in_words=False),
        *battery,
    ]
    while len(parts) > 1 and len(", ".join(parts)) > width:
        parts.pop()
    return ", ".join(parts)
