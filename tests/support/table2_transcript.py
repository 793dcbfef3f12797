# SPDX-License-Identifier: Apache-2.0
"""Table 2 of the paper, transcribed line by line: a robot that reads the printed table.

Written from the paper's table and prose alone, to compare the shipped controller with.
"""

from dataclasses import dataclass, replace

from abstract_world import ACK, AWAY, CLOSER, HOLD, NONE, SHALLOW, STEEP, TILT_DOWN, TILT_UP, StepIn

# The columns of the table, each from its first distinguishing line on. A cell's lines in order.
COLUMNS = {
    # "If p > 0: Send TiltUp, Wait for message"
    "request": ["Send TiltUp", "Wait for message"],
    # message==Ack
    "a": ["Move away until p <= 0", "Send TiltDown"],
    # message==TiltUp
    "b": [
        "Send Ack",
        "Wait for Ack",
        "Move away until p <= 0",
        "Tilt Up",
        "Send TiltDown",
        "Wait for TiltDown",
        "Tilt Down",
    ],
    # "else (p <= 0): Check for message. If message==TiltUp"
    "c": ["Tilt Up", "Send Ack", "Wait for TiltDown", "Tilt Down"],
    # "otherwise: If p < 0"
    "d": ["Tilt Up", "Move closer until p >= 0", "Tilt Down"],
}
MESSAGES = {"TiltUp": TILT_UP, "TiltDown": TILT_DOWN, "Ack": ACK}


@dataclass(frozen=True)
class Robot:
    """A robot that reads the table: column, line, and the last commanded angle of its palm."""

    column: str | None = None
    line: int = 0
    palm: int = STEEP


@dataclass(frozen=True)
class Deed:
    """What shows of a tick."""

    palm: int
    move: int = HOLD
    send: int = NONE
    read: bool = False
    case: str = " "
    waits: bool = False


def tick(robot: Robot, seen: StepIn) -> tuple[Robot, Deed]:
    """One tick: a line that takes time is looked at once, and what follows it starts at once."""
    p, message, turned = seen
    if robot.column is None:
        if p > 0:
            return begin(replace(robot, column="request"), NONE, read=False)
        read = message != NONE  # "Check for message"
        if message == TILT_UP:
            return begin(replace(robot, column="c"), NONE, read)
        if p < 0:
            return begin(replace(robot, column="d"), NONE, read)
        return robot, Deed(robot.palm, read=read)
    line = COLUMNS[robot.column][robot.line]
    read = line.startswith("Wait") and message != NONE
    done = {
        "Wait for message": message in (ACK, TILT_UP),
        "Wait for Ack": message == ACK,
        "Wait for TiltDown": message == TILT_DOWN,
        "Move away until p <= 0": p <= 0,
        "Move closer until p >= 0": p >= 0,
        "Tilt Up": turned,
        "Tilt Down": turned,
    }[line]
    if not done:
        return begin(robot, NONE, read)
    if line == "Wait for message":
        return begin(replace(robot, column="a" if message == ACK else "b", line=0), NONE, read)
    return begin(replace(robot, line=robot.line + 1), NONE, read)


def begin(robot: Robot, send: int, read: bool) -> tuple[Robot, Deed]:
    """Carries out lines until one takes time, or the column is at its end."""
    assert robot.column is not None
    if robot.line == len(COLUMNS[robot.column]):
        idle = Robot(palm=robot.palm)
        return idle, Deed(idle.palm, send=send, read=read)
    line = COLUMNS[robot.column][robot.line]
    if line.startswith("Send "):
        assert send == NONE, "two messages in one tick"
        message = MESSAGES[line.removeprefix("Send ")]
        return begin(replace(robot, line=robot.line + 1), message, read)
    if line.startswith("Tilt"):
        robot = replace(robot, palm=SHALLOW if line == "Tilt Up" else STEEP)
    move = AWAY if "away" in line else CLOSER if "closer" in line else HOLD
    case = "a" if robot.column == "request" else robot.column or " "
    return robot, Deed(robot.palm, move, send, read, case, line.startswith("Wait"))
