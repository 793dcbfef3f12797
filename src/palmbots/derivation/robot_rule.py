# SPDX-License-Identifier: Apache-2.0
"""The rule of one robot: when it applies, which palms and wheels it needs, and its program.

Pairs are seen from the robot that has the rule: (own, partner's).
"""

from dataclasses import dataclass

from palmbots.control.interface import SIGN_WORDS
from palmbots.derivation.global_policy import Angle, Angles, Direction, Signs
from palmbots.derivation.table2_programs import DONE, RELEASE, REQUEST, Program

_RELATION = {-1: "<", 0: "=", 1: ">"}
_CONDITION: dict[tuple[int, ...], str] = {
    (-1, 0): "p ≤ 0",
    (0, 1): "p ≥ 0",
    **{(sign,): words for sign, words in SIGN_WORDS.items()},
}


def tilt_to(angle: Angle) -> str:
    """The action that turns a palm to this angle, in the words of Table 2."""
    return "Tilt Up" if angle == "shallow" else "Tilt Down"


def message_for(angle: Angle) -> str:
    """The message that asks a robot to turn its palm to this angle."""
    return REQUEST if angle == "shallow" else RELEASE


@dataclass(frozen=True)
class Rule:
    """The rule of one robot. Pairs are (own, partner's)."""

    signs: tuple[int | None, int | None]
    """The condition; None: any sign."""
    palms: Angles
    direction: Direction
    until: tuple[tuple[int, str], ...]
    """Conditions of which one suffices: the contact (0 own, 1 the partner's), and ≤ or ≥."""
    asks: bool
    """Another robot has to turn a palm, or to drive."""
    asked: Angles = ("shallow", "steep")
    """The angle of the palm that the other robot turns: during the move, and at rest."""
    turn: Angle | None = None
    """The angle to which the robot itself turns a palm; None: it turns none."""
    drives: bool = True
    """The robot itself drives."""
    assist: tuple[int, ...] = ()
    """The signs of the partner's contact at which the partner drives, too."""

    def holds(self, robot: int, signs: Signs) -> bool:
        """Whether the rule of this robot applies at these signs (left, right)."""
        seen = signs if robot == 0 else signs[::-1]
        return all(want in (None, sign) for want, sign in zip(self.signs, seen, strict=True))

    def program(self) -> Program:
        """In the words of Table 2."""
        names = ("p", "the partner's p")
        wanted = zip(names, self.signs, strict=True)
        when = ", ".join(f"{name} {_RELATION[s]} 0" for name, s in wanted if s is not None)
        until = " or ".join(f"{names[whose]} {relation} 0" for whose, relation in self.until)
        does = f"Move {self.direction}" if self.drives else "Wait"
        lines = (f"{does} until {until}",)
        if self.asks:
            request, release = map(message_for, self.asked)
            lines = (f"Send {request}", f"Wait for {DONE}", *lines, f"Send {release}")
        if self.turn is not None:
            back: Angle = "shallow" if self.turn == "steep" else "steep"
            lines = (tilt_to(self.turn), *lines, tilt_to(back))
        return Program(when, lines)

    def service(self, free: str) -> Program:
        """What the partner does when it is asked; `free` is when it serves."""
        wanted, rest = self.asked
        release = message_for(rest)
        stays = f"Wait for {release}"
        if self.assist:
            where = _CONDITION.get(self.assist)
            stays = f"Move {self.direction}{f' while {where}' if where else ''} until {release}"
        lines = (f"Send {DONE}", stays)
        if wanted != rest:
            lines = (tilt_to(wanted), *lines, tilt_to(rest))
        return Program(f"{free}got {message_for(wanted)}", lines)
