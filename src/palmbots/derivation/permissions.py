# SPDX-License-Identifier: Apache-2.0
"""Which level permits a motion, and how a motion departs from the policy, in words.

A *motion* is one unit of closing or opening, with the signs of both contacts and the palms at that
time. There are four permissions, each wider than the one before:

- *policy*: the global policy makes this motion with these signs and palms, in some case.
- *rules*: or a derived rule of a robot does. This is the policy with guards dropped: a robot acts
  on its own contact, whatever the sign of the other one.
- *at once*: or the robot follows its rule while the other one is in a rule that nothing orders
  with it, wherever the other's palm is.
- *begun*: or that is so but for the robot's own contact, which has come to 0 since it began to turn
  its palm, and this is the first unit: what was begun is moved through once before it is looked at.
"""

from typing import NamedTuple

from palmbots._types import SIDES
from palmbots.derivation.abstract_world import Motion, Turn
from palmbots.derivation.contact_motion import Palms, improves, sliders
from palmbots.derivation.global_policy import Signs, signs_text
from palmbots.derivation.local_rules import Conflict, Derivation

LEVELS = ("policy", "rules", "at once", "begun")


class Kind(NamedTuple):
    """The features that distinguish departures."""

    differs: str
    """``order``, ``palms``, ``fight``, or ``moves on``: the policy would not move."""
    case: str
    """The case of the moving robot."""
    level: str | None
    """The narrowest permission that the motion has."""
    strays: bool
    """The motion may move a contact away from 0."""


class Permissions:
    """The motions that the policy and the derived rules permit."""

    def __init__(self, derivation: Derivation) -> None:
        self._derivation = derivation
        self._policy = {
            (signs, step.palms, step.move.direction)
            for step in derivation.steps
            for signs in step.during
        }

    def level(self, turn: Turn, motion: Motion) -> str | None:
        """The narrowest permission of a motion; None: it has none."""
        signs, palms, direction, fights = motion
        if fights:
            return None
        if (signs, palms, direction) in self._policy:
            return "policy"
        if any(self._by_rule(robot, motion) for robot in (0, 1)):
            return "rules"
        if turn.robot is None or not self._unordered(turn.robot, turn.cases, motion):
            return None
        rule = self._derivation.rules[turn.cases[turn.robot]]
        if rule.holds(turn.robot, signs):
            return "at once"
        return "begun" if turn.begins and signs[turn.robot] == 0 else None

    def kind(self, turn: Turn, motion: Motion) -> Kind | None:
        """The kind of departure of a motion; None: the policy permits it."""
        level = self.level(turn, motion)
        if level == "policy":
            return None
        strays = not improves(motion.signs, motion.palms, motion.direction)
        return Kind(self._differs(motion), turn.cases[turn.robot or 0], level, strays)

    def _by_rule(self, robot: int, motion: Motion) -> bool:
        """Whether a rule of the robot applies and makes this motion."""
        palms = motion.palms if robot == 0 else motion.palms[::-1]
        return any(
            robot in self._derivation.robots[name]
            and rule.holds(robot, motion.signs)
            and (rule.palms, rule.direction) == (palms, motion.direction)
            for name, rule in self._derivation.rules.items()
        )

    def _unordered(self, robot: int, cases: tuple[str, str], motion: Motion) -> bool:
        """Whether the robot follows a rule that no message orders with the case of the other."""
        pair = (min(cases), max(cases))
        if not any(c.rules == pair and c.asking == 0 for c in self._derivation.conflicts):
            return False
        rule = self._derivation.rules[cases[robot]]
        own = rule.palms[0], rule.direction
        return own == (motion.palms[robot], motion.direction)

    def _differs(self, motion: Motion) -> str:
        """How a motion differs from all motions of the policy at these signs."""
        if motion.fights:
            return "fight"
        here = [s for s in self._derivation.steps if motion.signs in s.during]
        if not here:
            return "moves on"
        directions = {s.move.direction for s in here}
        return "palms" if motion.direction in directions else "order"

    def explained(self, turn: Turn, motion: Motion) -> str:
        """What a motion does, what the policy does instead, and the conflict that causes it."""
        text = f"at {signs_text(motion.signs)} it {_done(motion.direction, motion.palms)}"
        text += f"; the policy {self._instead(motion.signs)}"
        if turn.robot is not None and self.level(turn, motion) == "begun":
            text += f"; p_{'LR'[turn.robot]} was off when it began"
        if motion.fights:
            text += "; and the other robot drives the other way"
        movable = sliders(motion.palms, motion.direction)
        outward = 1 if motion.direction == "closer" else -1
        astray = [f"p_{'LR'[c]}" for c in sorted(movable) if motion.signs[c] != -outward]
        if astray:
            text += f"; {' and '.join(astray)} may slide away from 0"
        conflict = self._conflict(turn, motion)
        if conflict is not None:
            text += f". {'∥'.join(f'({name})' for name in conflict.rules)}: {conflict.order}"
        return text

    def _conflict(self, turn: Turn, motion: Motion) -> Conflict | None:
        """The conflict of the rules in use, or of those that apply at these signs."""
        cases = (min(turn.cases), max(turn.cases))
        known = self._derivation.conflicts
        if turn.robot is None:
            return None
        if turn.cases[turn.robot] not in self._derivation.rules:  # the case that breaks ties
            return next((c for c in known if c.asking == 2), None)
        by_case = (c for c in known if c.rules == cases)
        by_signs = (c for c in known if motion.signs in c.signs)
        return next(by_case, None) or next(by_signs, None)

    def _instead(self, signs: Signs) -> str:
        """The motion of the policy at these signs, in words."""
        does: dict[str, list[str]] = {}
        for step in self._derivation.steps:
            if signs in step.during:
                does.setdefault(_done(step.move.direction, step.palms), []).append(str(step.case))
        motions = [f"{what} (case {' and '.join(cases)})" for what, cases in does.items()]
        return " or ".join(motions) or "does not move"


def _done(direction: str, palms: Palms) -> str:
    """The direction of a motion and its palms, in words."""
    how = [f"the {SIDES[k]} palm {_PALM[palms[k]]}" for k in (0, 1) if palms[k] != "steep"]
    if palms[0] == palms[1]:
        how = [f"both palms {_PALM[palms[0]]}"]
    return f"{'closes' if direction == 'closer' else 'separates'} with {' and '.join(how)}"


_PALM = {"steep": "steep", "shallow": "up", "turning": "turning"}
