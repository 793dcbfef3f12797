# SPDX-License-Identifier: Apache-2.0
"""The core names its enumerations. Where Python repeats names, they are the same.

Type checkers need the names spelled out, and tables give each name a text or a look.
"""

from typing import Any, get_args, get_type_hints

import pytest

import palmbots._core as _core
from palmbots import wire
from palmbots.control import interface
from palmbots.control.registry import ControllerEntry, describe
from palmbots.derivation import contact_motion, global_policy
from palmbots.learn import rendering, spaces
from palmbots.mechanics import consistent_modes, contact_points
from palmbots.mujoco import contact_events
from palmbots.simulation import batch, result
from palmbots.stability import clearance, first_contact
from palmbots.studies import variables
from palmbots.viz import timeline
from palmbots.wire import bodies

MESSAGES = tuple(_core.MessageKind.__members__)[1:]
PALMS = tuple(_core.Palm.__members__)
MOVES = tuple(_core.Move.__members__)
TOUCHES = _core.contact_kinds[2:]  # neither none nor a vertex

ALIASES: dict[str, tuple[Any, tuple[str, ...]]] = {
    "message": (interface.MessageKind, describe("distributed").messages),
    "palm": (interface.Palm, PALMS),
    "move": (interface.Move, MOVES),
    "palm of the derivation": (contact_motion.Palm, (*PALMS, "turning")),
    "direction of the derivation": (global_policy.Direction, MOVES[1:]),
    "outcome": (result.Carry.__annotations__["outcome"], _core.carry_outcomes[1:]),
    "contact": (contact_points.Kind, (*_core.contact_kinds[1:], "nose", "heel")),
    "contact event": (get_type_hints(result.ContactEvent)["kind"], TOUCHES),
    "contact event of MuJoCo": (contact_events.Kind, TOUCHES),
    "closest contact": (clearance.Kind, (*TOUCHES, "back end")),
}


@pytest.mark.parametrize("name", ALIASES)
def test_alias_has_the_names_of_the_core(name: str) -> None:
    alias, names = ALIASES[name]
    assert get_args(alias) == names


WIRE = "Role Kind Verdict Language MessageName RobotMode FaultCode Operation"


@pytest.mark.parametrize("name", WIRE.split())
def test_type_of_names_on_the_wire_is_that_of_the_core(name: str) -> None:
    assert getattr(wire, name) == getattr(_core.wire, name)


@pytest.mark.parametrize(
    ("table", "names"),
    [
        (timeline._MARKERS, (*MESSAGES, "Hello")),
        (rendering._MOVE_TEXTS, MOVES),
        (first_contact.MOTION_NAMES, consistent_modes.MOTION_CODES),
    ],
)
def test_table_has_an_entry_for_every_name(table: dict[str, Any], names: tuple[str, ...]) -> None:
    assert sorted(table) == sorted(names)


def test_numbers_are_those_of_the_core() -> None:
    """Columns of results, study stores and packets are written with these numbers."""
    outcomes = {"delivered": 1, "dropped": 2, "stalled": 3}
    assert {name: batch.OUTCOMES.index(name) for name in outcomes} == outcomes
    reasons = (
        "none", "off-palm", "sliding", "flush", "tip", "tipping", "jammed", "lifting",
        "robot tipped", "fell", "toppled",
    )  # fmt: skip
    codes = {name: code for code, name in enumerate(reasons)}
    stored = [{"not carried": 0} | outcomes | {"missing": 255}, codes | {"missing": 255}]
    assert stored == [variables.OUTCOMES, variables.REASONS]
    assert interface.MESSAGE_KINDS == (None, "TiltUp", "TiltDown", "Ack")
    assert interface.MESSAGE_KINDS[1:] == spaces.OBSERVATION[4:]


def test_languages_have_the_messages_of_the_core() -> None:
    for language, language_name in enumerate(_core.wire.languages):
        kind = _core.wire.packet_kinds.index("phase" if language_name == "phases" else "state")
        for message, message_name in enumerate(_core.wire.messages):
            payload = _core.wire.state(language, message, 0, False, False, False)
            packet = _core.wire.encode(bytes(16), kind, 0, 1, 7, (1, 1), (0, 0), payload)
            assert (packet is not None) == (message_name in bodies._MESSAGES_OF[language_name])


def test_controllers_of_the_core_have_known_teams() -> None:
    teams = get_args(get_type_hints(ControllerEntry)["team"])
    assert {row["team"] for row in _core.controllers()} == set(teams)
