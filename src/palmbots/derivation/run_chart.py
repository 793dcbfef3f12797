# SPDX-License-Identifier: Apache-2.0
"""A run of the abstract world as a message sequence chart in text.

Time runs downwards. Each robot has a lifeline with the case that it is in and what its wheels do;
an arrow is a message, drawn where it is sent. The columns at the edges are the contacts in units.
"""

from collections.abc import Iterator

from palmbots.derivation.abstract_world import State, Turn
from palmbots.derivation.verification import Step

_LINE = 16  # characters of a lifeline's action
_GAP = 13  # characters between the lifelines


def chart(start: tuple[int, int], run: list[Step], loop: int = 0) -> list[str]:
    """The chart, one line per step. The last `loop` steps repeat for ever."""
    lines = [
        f"{'p_L':>4}  {'left robot':{_LINE}}{'':{_GAP}}  {'right robot':{_LINE}}{'p_R':>4}   palms",
    ]
    p = start
    for number, step in enumerate(run):
        if loop and number == len(run) - loop:
            lines.append("from here the run repeats:")
        lines += _lines(p, step)
        p = step.after.p
    lines.append(f"{p[0]:+4d}  {'':{2 * _LINE + _GAP + 2}}{p[1]:+4d}".replace("+0", " 0"))
    return lines


def _lines(p: tuple[int, int], step: Step) -> Iterator[str]:
    turn = step.turn
    if turn is None:
        what = next(
            f"p_{'LR'[k]} to {step.after.p[k]:+d}" for k in (0, 1) if step.after.p[k] != p[k]
        )
        left, arrow, right = "", "~ disturbed ~", what.replace("+0", "0")
        palms = ""
    else:
        robot = turn.robot or 0
        does = _does(turn, step.after)
        left, right = (does, "|") if robot == 0 else ("|", does)
        arrow = _arrow(turn.said, robot)
        palms = ", ".join(turn.palms)
    yield (
        (f"{p[0]:+4d}  {left:{_LINE}}{arrow:^{_GAP}}  {right:{_LINE}}{p[1]:+4d}   {palms}")
        .replace("+0", " 0")
        .rstrip()
    )


def _does(turn: Turn, after: State) -> str:
    robot = turn.robot or 0
    case = turn.cases[robot].strip()
    text = f"({case})" if case else "idle"
    return f"{text} {turn.motion.direction}" if turn.motion is not None else text


def _arrow(said: str, robot: int) -> str:
    if not said:
        return ""
    bar = "-" * max(1, (_GAP - len(said) - 3) // 2)
    return f"{bar} {said} {bar}>" if robot == 0 else f"<{bar} {said} {bar}"
