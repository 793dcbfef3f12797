# SPDX-License-Identifier: Apache-2.0
"""The distributed algorithm of a policy: a state machine for each robot, from the derived rules.

A rule becomes a chain of states, as the columns of Table 2 do: ask, turn the palm, move, release. A
request becomes the chain of the robot that serves it. Three things come from the policy rather than
from a rule, because the rules leave them open:

- *Order.* A robot that is asked knows both signs: its own, and the one that makes its partner ask.
  So the row for these signs says whose contact comes first. The same holds where requests cross:
  both robots know both signs, the one that is second serves, and the other one ignores the request.
  If the row says nothing, the left robot is first.
- *Own sign.* A robot that serves drives only at those of its own signs at which the policy says so.
- *Rest.* The palms return to the angles of the row (0, 0).

One thing is added: the robot that has served says Ack when its palm is back, and the other one
waits for it. Without this, a robot can begin its next correction while its partner's palm still
turns (tests/derivation/test_verification.py has the run). The messages are TiltUp, TiltDown and
Ack. A request names the angle that the partner's palm shall have, a release the angle at rest.

The machines run in `include/palmbots/control/machine_table.hpp`.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from palmbots._types import SIDES
from palmbots.derivation.global_policy import Angle, signs_text
from palmbots.derivation.local_rules import Derivation, derive
from palmbots.derivation.policy_file import PolicyTable
from palmbots.derivation.robot_rule import Rule, message_for
from palmbots.derivation.table2_programs import DONE
from palmbots.errors import PalmbotsError

SIGNS = (-1, 0, 1)
START: Angle = "steep"
"""The angle of the palms when a carry begins."""
_LETTER = {1: "a", -1: "d"}
_IS = {-1: "negative", 0: "zero", 1: "positive"}
_IS_NOT = {-1: "not_negative", 1: "not_positive"}


Motion = Literal["hold", "away", "closer"]
CoreTable = tuple[
    tuple[tuple[str, str, str, bool, str], ...], tuple[tuple[int, str, str, bool, int, str], ...]
]
"""States and rows as `palmbots._core.Machines` takes them."""


class MachineState(NamedTuple):
    """A state, and what the robot commands in it."""

    name: str
    case: str
    """``a``: corrects a positive contact; ``d``: a negative one; ``c``: serves; a space: idle."""
    palm: Angle
    move: Motion = "hold"
    awaits: str = ""
    """The message for which the robot waits."""


class MachineRow(NamedTuple):
    """A transition, in the words of `palmbots._core.transition_table`."""

    state: str
    contact: str
    heard: str
    """The message that the row reads; empty: it looks at none."""
    turned: bool
    """The palm must have turned."""
    next: str
    send: str = ""


@dataclass
class Machine:
    """The state machine of one robot. It starts in the first state and runs the first row that
    fits."""

    states: list[MachineState] = field(default_factory=list)
    rows: list[MachineRow] = field(default_factory=list)

    @property
    def idle(self) -> int:
        """The number of the state in which the robot neither corrects nor serves its partner."""
        return next(k for k, state in enumerate(self.states) if state.name == "idle")

    def for_core(self) -> CoreTable:
        """States and rows as `palmbots._core.Machines` takes them."""
        number = {state.name: k for k, state in enumerate(self.states)}
        states = tuple((s.case, s.palm, s.move, bool(s.awaits), s.awaits) for s in self.states)
        rows = tuple(
            (number[r.state], r.contact, r.heard, r.turned, number[r.next], r.send)
            for r in self.rows
        )
        return states, rows


def refusals(table: PolicyTable, derivation: Derivation) -> list[str]:
    """Why no distributed algorithm follows from a policy; empty: one does."""
    reasons = list(derivation.findings)
    if (direction := table.rows[0, 0].direction) is not None:
        reasons.insert(0, f"row (0, 0) moves {direction}: the corrections never end")
    for rule in derivation.rules.values():
        if rule.signs[0] and not rule.drives and set(rule.assist) != set(SIGNS):
            silent = [s for s in SIGNS if s not in rule.assist]
            at = ", ".join(_signs(rule, silent))
            reasons.append(f"rows {at}: the robot whose contact moves does not drive, nor does its "
                           "partner at these signs")  # fmt: skip
    return reasons


def _signs(rule: Rule, partners: Iterable[int]) -> list[str]:
    own = rule.signs[0] or 0
    return [signs_text((own, partner)) for partner in partners]


def machines_of(table: PolicyTable, called: str = "policy") -> tuple[Machine, Machine]:
    """The machines of the left and the right robot.

    Raises:
        PalmbotsError: no distributed algorithm follows from the policy; one line with the first
            reason, which names the row.
    """
    derivation = derive(table.cases, rest=table.rest)
    reasons = refusals(table, derivation)
    if reasons:
        more = f" (and {len(reasons) - 1} more: palmbots derive --policy)" if reasons[1:] else ""
        raise PalmbotsError(
            f"{called}: no distributed algorithm follows: {reasons[0]}{more}; allowed: a policy "
            "whose rows each bring a contact to 0 that its own robot can follow"
        )
    return _Builder(table, derivation, 0).machine, _Builder(table, derivation, 1).machine


def unordered_cases(machines: tuple[Machine, Machine]) -> frozenset[str]:
    """The cases that both robots correct without a message, so that nothing orders the two."""
    states = [{state.name for state in machine.states} for machine in machines]
    return frozenset(
        case
        for case in _LETTER.values()
        if all(f"{case}_move" in names and f"{case}_ask" not in names for names in states)
    )


class _Builder:
    """Builds the machine of one robot."""

    def __init__(self, table: PolicyTable, derivation: Derivation, robot: int) -> None:
        self._table = table
        self._robot = robot
        self._rest: Angle = table.rest[robot]
        self._rest_of_partner: Angle = table.rest[1 - robot]
        own, partners = (_rules_by_sign(derivation, k) for k in (robot, 1 - robot))
        asking = {sign: rule for sign, rule in partners.items() if rule.asks}
        self.machine = Machine()
        if self._rest != START:  # a palm that is not yet commanded to rest counts as turned
            self._state("start", self._rest)
            self._state("settle", self._rest)
            self._row("start", "any", "", False, "settle")
            self._row("settle", "any", "", True, "idle")
        self._state("idle", self._rest)
        for sign, rule in asking.items():
            self._serve_from_idle(own, sign, rule)
        for sign, rule in own.items():
            self._correct(sign, rule, asking)
        for sign, rule in asking.items():
            self._serve(sign, rule)

    def _state(
        self,
        name: str,
        palm: Angle,
        move: Motion = "hold",
        awaits: str = "",
    ) -> None:
        case = name[0] if name[1] == "_" else " "
        self.machine.states.append(MachineState(name, case, palm, move, awaits))

    def _row(
        self, state: str, contact: str, heard: str, turned: bool, after: str, send: str = ""
    ) -> None:
        self.machine.rows.append(MachineRow(state, contact, heard, turned, after, send))

    def _is_first(self, own: int, partner: int) -> bool:
        """Whether this robot comes first at these signs of its own and its partner's contact."""
        first = self._table.first((own, partner) if self._robot == 0 else (partner, own))
        return first == self._robot if first is not None else self._robot == 0

    def _serve_from_idle(self, own: dict[int, Rule], sign: int, rule: Rule) -> None:
        serves = [s for s in SIGNS if s not in own or not self._is_first(s, sign)]
        for contact in _contacts(serves):
            self._row("idle", contact, message_for(rule.palms[1]), False, _serving(sign, "turn"))

    def _correct(self, sign: int, rule: Rule, asking: dict[int, Rule]) -> None:
        """The states in which the robot corrects its own contact of this sign."""
        case, palm = _LETTER[sign], rule.palms[0]
        ask, turn, move, wait, back = (f"{case}_{part}" for part in _CORRECTING)
        turns = palm != self._rest
        home = back if turns else "idle"
        direction: Motion = rule.direction if rule.drives else "hold"
        if rule.asks:
            request = message_for(rule.palms[1])
            release = message_for(self._rest_of_partner)
            self._row("idle", _IS[sign], "", False, ask, request)
            self._state(ask, palm, awaits=DONE)
            for other, theirs in asking.items():
                after = ask if self._is_first(sign, other) else _serving(other, "turn")
                self._row(ask, "any", message_for(theirs.palms[1]), False, after)
            self._row(ask, _IS[sign], DONE, True, move)
            self._row(ask, "any", DONE, True, wait, release)
            self._state(move, palm, direction)
            self._row(move, _IS_NOT[sign], "", False, wait, release)
            self._state(wait, self._rest, awaits=DONE)
            self._row(wait, "any", DONE, True, "idle")
            return
        self._row("idle", _IS[sign], "", not turns, turn if turns else move)
        if turns:
            self._state(turn, palm)
            self._row(turn, _IS[sign], "", True, move)
            self._row(turn, "any", "", True, home)
        self._state(move, palm, direction)
        self._row(move, _IS_NOT[sign], "", False, home)
        if turns:
            self._state(back, self._rest)
            self._row(back, "any", "", True, "idle")

    def _serve(self, sign: int, rule: Rule) -> None:
        """The states in which the robot serves its partner, whose contact has this sign."""
        turn, stay, drive, back = (_serving(sign, part) for part in _SERVING)
        palm, release = rule.palms[1], message_for(self._rest)
        drives = [s for s in SIGNS if s in rule.assist]
        stays = [s for s in SIGNS if s not in rule.assist]
        self._state(turn, palm)
        moves: dict[str, Motion] = {stay: "hold", drive: rule.direction}
        for state, signs, other in ((stay, stays, drive), (drive, drives, stay)):
            if not signs:
                continue
            for contact in _contacts(signs):
                self._row(turn, contact, "", True, state, DONE)
            self._state(state, palm, moves[state], release)
            self._row(state, "any", release, False, back)
            for contact in _contacts([s for s in SIGNS if s not in signs]):
                self._row(state, contact, "", False, other)
        self._state(back, self._rest)
        self._row(back, "any", "", True, "idle", DONE)


_CORRECTING = ("ask", "turn", "move", "wait", "back")
_SERVING = ("turn", "hold", "move", "back")


def _serving(sign: int, part: str) -> str:
    """The name of a state in which a robot serves its partner's rule for this sign."""
    return f"c_{_LETTER[sign]}_{part}"


def _rules_by_sign(derivation: Derivation, robot: int) -> dict[int, Rule]:
    """The rules of a robot, by the sign of its contact."""
    found: dict[int, Rule] = {}
    for name, rule in derivation.rules.items():
        if robot not in derivation.robots[name]:
            continue
        sign, other = rule.signs
        if sign not in _LETTER or other is not None or sign in found:
            raise PalmbotsError(  # the properties admit one motion for each sign
                f"policy: the {SIDES[robot]} robot has no single rule for p "
                f"{'+0-'[1 - (sign or 0)]}; allowed: one"
            )
        found[sign] = rule
    return found


def _contacts(signs: Iterable[int]) -> list[str]:
    """Conditions on the contact that hold at these signs."""
    whole = {(-1, 0, 1): "any", (-1, 0): "not_positive", (0, 1): "not_negative"}
    among = tuple(sorted(signs))
    return [whole[among]] if among in whole else [_IS[sign] for sign in among]
