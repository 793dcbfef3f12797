# SPDX-License-Identifier: Apache-2.0
"""The contents of packets (docs/reference/wire.md), and their five payload bytes.

In every content, `stop` states that the sender knows of a stop that is in force.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import palmbots._core as _core
from palmbots._util.arguments import show, shown
from palmbots.control.interface import MOVES, PALMS, Move, Palm
from palmbots.errors import PalmbotsError

Verdict: TypeAlias = _core.wire.Verdict
"""The verdict on received bytes."""
Language: TypeAlias = _core.wire.Language
"""The language of a controller: `messages` of Table 2, `beacons` of the resilient algorithm,
`signs` of a controller that shares signs, `phases` of the table of a job on the floor; `none`: it
says nothing."""
MessageName: TypeAlias = _core.wire.MessageName
"""What a controller or the table of a job on the floor says. `messages` has the first three names,
`beacons` the first five, `signs` the next five, `phases` the others."""
RobotMode: TypeAlias = _core.wire.RobotMode
"""The mode of a robot."""
FaultCode: TypeAlias = _core.wire.FaultCode
"""Why a robot does not carry."""
Operation: TypeAlias = _core.wire.Operation
"""What the operator wants."""
StatusItem = Literal["progress", "battery", "overruns", "sent", "phase"] | Verdict
"""A number that takes its turn in the status: `progress` is the covered part of the distance times
65535, `battery` is in mV (65535: not measured), and `overruns` is how many of the last 100 ticks
came too late. `phase` is the number of the state of a job on the floor (65535: it is none), in the
order of `palmbots.simulation.floor_job.MEANINGS`. All others are counts modulo 65536: packets sent,
and packets received with each verdict."""

# In the order of the core's numbers.
_LANGUAGES: tuple[Language, ...] = _core.wire.languages
_MESSAGES: tuple[MessageName, ...] = _core.wire.messages
_MODES: tuple[RobotMode, ...] = _core.wire.robot_modes
_FAULTS: tuple[FaultCode, ...] = _core.wire.fault_codes
_OPERATIONS: tuple[Operation, ...] = _core.wire.operations
STATUS_ITEMS: tuple[StatusItem, ...] = (*_core.wire.status_numbers, *_core.wire.verdicts)
_CASES = tuple(_core.wire.cases)
_SIGNS: tuple[Literal[-1, 0, 1], ...] = (-1, 0, 1)
_STEPS: tuple[Literal[0, 1, 2, 3], ...] = (0, 1, 2, 3)
_MESSAGES_OF: dict[str, tuple[MessageName, ...]] = {
    language: tuple(said for m, said in enumerate(_MESSAGES) if _core.wire.has_message(k, m))
    for k, language in enumerate(_LANGUAGES)
}


@dataclass(frozen=True, slots=True)
class Hello:
    """The sender is up."""

    settings: int = 0
    """A number that is equal for robots and station if their settings are; 0: not stated."""
    stop: bool = False


@dataclass(frozen=True, slots=True)
class State:
    """What a robot sends to its partner."""

    language: Language = "none"
    message: MessageName = ""
    """What the controller says."""
    mode: RobotMode = "carrying"
    ready: bool = False
    """No condition of the controller keeps the robot from travelling."""
    at_rest: bool = False
    """The robot does not travel."""
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Phase:
    """What a robot sends to its partner in a job on the floor, beside its state."""

    message: MessageName
    """What its table says (`control/lifting.hpp`)."""
    mode: RobotMode = "carrying"
    steps: Literal[0, 1, 2, 3] = 0
    """The steps of its arm above the height on the floor, modulo 4."""
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Status:
    """What a robot reports to the station at intervals."""

    mode: RobotMode = "carrying"
    fault: FaultCode = "none"
    sign: Literal[-1, 0, 1] = 0
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm: Palm = "steep"
    """The palm angle that was commanded last."""
    palm_at_target: bool = False
    """The palm has reached that angle."""
    case: str = " "
    """The case of Table 2 ("a" to "d") or Table 1 ("1" to "8"); " ": none."""
    item: StatusItem = "progress"
    value: int = 0
    """The number that `item` names, 0 to 65535."""
    ready: bool = False
    """No condition of the controller keeps the robot from travelling."""
    at_rest: bool = False
    """The robot does not travel."""
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Operate:
    """What the operator wants a robot to do."""

    operation: Operation
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Report:
    """What a robot of the centralized algorithm reports to the station."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm: Palm
    """The palm angle that was commanded last."""
    palm_at_target: bool
    """The palm has reached that angle."""
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Command:
    """What the station of the centralized algorithm commands a robot to do."""

    palm: Palm
    move: Move
    stop: bool = False


Body = Hello | State | Status | Operate | Report | Command | Phase
"""Content of a packet."""

# In the order of the core's kinds of packets.
BODIES: tuple[type[Body], ...] = get_args(Body)


def payload_of(body: Body) -> bytes:
    """The five bytes of a content.

    Raises:
        PalmbotsError: a field has no allowed value.
    """
    match body:
        case Hello():
            return _core.wire.hello(whole("settings", body.settings, 0, 2**32 - 1), bool(body.stop))
        case State():
            language = index("language", _LANGUAGES[:-1], body.language)
            index(f"message of {body.language}", _MESSAGES_OF[body.language], body.message)
            return _core.wire.state(
                language,
                _MESSAGES.index(body.message),
                index("mode", _MODES, body.mode),
                bool(body.ready),
                bool(body.at_rest),
                bool(body.stop),
            )
        case Phase():
            index("message of phases", _MESSAGES_OF["phases"], body.message)
            steps = index("steps", _STEPS, body.steps)
            return _core.wire.state(
                _LANGUAGES.index("phases"),
                _MESSAGES.index(body.message),
                index("mode", _MODES, body.mode),
                bool(steps & 2),
                bool(steps & 1),
                bool(body.stop),
            )
        case Status():
            return _core.wire.status(
                index("mode", _MODES, body.mode),
                index("fault", _FAULTS, body.fault),
                _SIGNS[index("sign", _SIGNS, body.sign)],
                index("palm", PALMS, body.palm),
                bool(body.palm_at_target),
                _CASES[index("case", _CASES, body.case)],
                index("item", STATUS_ITEMS, body.item),
                whole("value", body.value, 0, 0xFFFF),
                bool(body.ready),
                bool(body.at_rest),
                bool(body.stop),
            )
        case Operate():
            return _core.wire.operate(
                index("operation", _OPERATIONS, body.operation), bool(body.stop)
            )
        case Report():
            return _core.wire.report(
                _SIGNS[index("sign", _SIGNS, body.sign)],
                index("palm", PALMS, body.palm),
                bool(body.palm_at_target),
                bool(body.stop),
            )
        case Command():
            palm, move = index("palm", PALMS, body.palm), index("move", MOVES, body.move)
            return _core.wire.command(palm, move, bool(body.stop))
    allowed = ", ".join(kind.__name__ for kind in BODIES)
    raise PalmbotsError(f"body: value is {shown(body)}; allowed: {allowed}")


def body_of(kind: int, payload: bytes) -> Body:
    """The content of an accepted packet; `kind` is the core's number."""
    match BODIES[kind].__name__:
        case "Hello":
            return Hello(*_core.wire.hello_of(payload))
        case "State":
            language, message, mode, *flags = _core.wire.state_of(payload)
            return State(_LANGUAGES[language], _MESSAGES[message], _MODES[mode], *flags)
        case "Phase":
            _, message, mode, high, low, stop = _core.wire.state_of(payload)
            return Phase(_MESSAGES[message], _MODES[mode], _STEPS[2 * high + low], stop)
        case "Status":
            mode, fault, sign, palm, at_target, case, item, value, *flags = _core.wire.status_of(
                payload
            )
            return Status(
                _MODES[mode],
                _FAULTS[fault],
                _SIGNS[sign + 1],
                PALMS[palm],
                at_target,
                case,
                STATUS_ITEMS[item],
                value,
                *flags,
            )
        case "Operate":
            operation, stop = _core.wire.operate_of(payload)
            return Operate(_OPERATIONS[operation], stop)
        case "Report":
            sign, palm, palm_at_target, stop = _core.wire.report_of(payload)
            return Report(_SIGNS[sign + 1], PALMS[palm], palm_at_target, stop)
        case _:
            palm, move, stop = _core.wire.command_of(payload)
            return Command(PALMS[palm], MOVES[move], stop)


def index(what: str, legal: tuple[object, ...], value: object) -> int:
    """The position of a value among those allowed; raises PalmbotsError if it is none of them."""
    if type(value) in (str, int) and value in legal:
        return legal.index(value)
    allowed = ", ".join(show(one) for one in legal)
    raise PalmbotsError(f"{what}: value is {shown(value)}; allowed: {allowed}")


def whole(what: str, value: int, least: int, most: int) -> int:
    """The value, if it is a whole number in this range; otherwise raises PalmbotsError."""
    if type(value) is int and least <= value <= most:
        return value
    raise PalmbotsError(f"{what}: value is {shown(value)}; allowed: {least} to {most}")
