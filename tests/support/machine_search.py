# SPDX-License-Identifier: Apache-2.0
"""An independent search of the runs of two machines: the rows are interpreted here, not compiled.

Every rule of the abstract world is written down anew: turns, palms, messages, disturbances, the
contact that slides. Nothing of the package is imported.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

State = tuple[Any, ...]
Turn = tuple[int, str, str, tuple[str, ...], State]
"""The robot, its move, the other one's, the palms as seen, the state after."""
ENDS = {"positive": {1}, "negative": {-1}, "zero": {0}, "any": {-1, 0, 1},
        "not_positive": {-1, 0}, "not_negative": {0, 1}}  # fmt: skip


def row_of(machine: Any, state: str, sign: int, heard: str, settled: bool) -> Any:
    """The first row that fits; None: there is none."""
    for row in machine.rows:
        fits = row.state == state and sign in ENDS[row.contact]
        fits = fits and row.heard in ("", heard)
        if fits and (settled or not row.turned):
            return row
    return None


class MachineSearch:
    """All states of two machines, with disturbances up to `reach` units and late messages."""

    def __init__(self, machines: Any, *, reach: int, delay: int, turning: int) -> None:
        self.machines = machines
        self.row = cache(lambda robot, *seen: row_of(machines[robot], *seen))
        self.outputs = [{s.name: s for s in machine.states} for machine in machines]
        self.reach, self.delay, self.turning = reach, delay, turning

    def start(self, p: tuple[int, int]) -> State:
        """(p, palms as (angle, turns left), wheels, states, inboxes, lead)."""
        names = tuple(machine.states[0].name for machine in self.machines)
        return (p, (("steep", 0), ("steep", 0)), ("hold", "hold"), names, ((), ()), 0)

    def turns(self, state: State) -> Iterator[Turn]:
        """Every possible turn."""
        p, palms, wheels, names, inboxes, lead = state
        for robot in (0, 1):
            ahead = lead + (1 if robot == 0 else -1)
            if ahead not in (-1, 0, 1):
                continue
            mine = inboxes[robot]
            choices = [mine[0][0] if mine else ""]
            if mine and mine[0][1] < self.delay:
                choices.append("")
            for heard in choices:
                sign = (p[robot] > 0) - (p[robot] < 0)
                row = self.row(robot, names[robot], sign, heard, palms[robot][1] == 0)
                name = names[robot] if row is None else row.next
                unread = [(said, min(age + 1, self.delay)) for said, age in mine]
                if row is not None and row.heard:
                    unread = unread[1:]
                sent = [(row.send, 0)] if row is not None and row.send else []
                both = [list(inboxes[0]), list(inboxes[1])]
                both[robot] = unread
                both[1 - robot] = both[1 - robot] + sent
                output = self.outputs[robot][name]
                angle, left = palms[robot]
                left = self.turning if output.palm != angle else max(0, left - 1)
                new_palms = list(palms)
                new_palms[robot] = (output.palm, left)
                new_wheels = list(wheels)
                new_wheels[robot] = output.move
                new_names = list(names)
                new_names[robot] = name
                shown = tuple("turning" if n else angle for angle, n in new_palms)
                for place in self._slides(p, output.move, shown):
                    after = (place, tuple(new_palms), tuple(new_wheels), tuple(new_names),
                             tuple(map(tuple, both)), ahead)  # fmt: skip
                    yield robot, output.move, new_wheels[1 - robot], shown, after

    @staticmethod
    def _slides(p: tuple[int, int], move: str, palms: tuple[str, ...]) -> list[tuple[int, int]]:
        if move == "hold":
            return [p]
        change = 1 if move == "closer" else -1
        able = [0, 1]
        if set(palms) == {"steep", "shallow"}:  # the shallow one on closing, the steep one else
            able = [palms.index("shallow" if move == "closer" else "steep")]
        return [(p[0] + change * (k == 0), p[1] + change * (k == 1)) for k in able]

    def disturbed(self, state: State) -> Iterator[State]:
        """Every disturbance."""
        p, *rest = state
        for k in (0, 1):
            for change in (-1, 1):
                place = (p[0] + change * (k == 0), p[1] + change * (k == 1))
                if abs(place[k]) <= self.reach:
                    yield (place, *rest)

    def all_states(self, span: int) -> dict[State, list[Turn]]:
        """Every state with its turns. A contact beyond `span` has left its palm: there it ends."""
        grid = range(-self.reach, self.reach + 1)
        stack = [self.start((a, b)) for a in grid for b in grid]
        found: dict[State, list[Turn]] = {}
        while stack:
            state = stack.pop()
            if state in found:
                continue
            found[state] = list(self.turns(state))
            stack += [s for *_, s in found[state] if max(map(abs, s[0])) <= span]
            stack += self.disturbed(state)
        return found
