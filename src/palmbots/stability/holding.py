# SPDX-License-Identifier: Apache-2.0
"""Whether palms and robots hold the object wherever the contacts may be: the first line of
`analyze` and `load`, which the first line of `assess` repeats."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from palmbots._types import SIDES
from palmbots._util.report import Item, Line, Marked, Table, bad, bold, good
from palmbots._util.text import millimetres
from palmbots.errors import PalmbotsError
from palmbots.mechanics.load_limits import LoadLimits, mass_text
from palmbots.scene.scene import Scene

if TYPE_CHECKING:
    from palmbots.stability.analysis import Analysis


@dataclass(frozen=True)
class Holding:
    """A word, and the reason."""

    word: Literal["HOLDS", "MAY FAIL", "TOUCHES", "FAILS"]
    """``HOLDS``: nothing is wrong. ``MAY FAIL``: a number of the scene exceeds what is allowed for
    contacts somewhere. ``TOUCHES``: all properties hold, but a palm is inside the object.
    ``FAILS``: a property fails, the object cannot be lifted, or a carry cannot begin."""
    text: str

    def line(self) -> Line:
        """The first line of a report."""
        marked: Marked = good(self.word) if self.word == "HOLDS" else bad(self.word)
        return Line(marked, bold(f"  {self.text}"))


def holding(analysis: Analysis) -> Holding:
    """The verdict of an analysis, for the contacts of its region."""
    load = analysis.load
    scene, contacts = analysis.scene, analysis.problem.contacts
    if analysis.lone is not None:
        if analysis.lone.refusals:
            return Holding("FAILS", analysis.lone.refusals[0])
        return Holding("HOLDS", f"the {analysis.lone.robot} robot alone holds the object")
    if analysis.hand_over is not None:
        if analysis.hand_over.refusals:
            return Holding("FAILS", analysis.hand_over.refusals[0])
        return Holding("HOLDS", "one palm at a time holds the object")
    if refusal := load.refusal():
        return Holding("FAILS", refusal)
    if analysis.lifting is not None and not analysis.lifting.works:
        return Holding("FAILS", analysis.lifting.refusals[0])
    for report in analysis.properties.values():
        if not report.holds:
            where = f"with the {report.shallow} palm shallow"
            return Holding("FAILS", f"property {report.number} fails {where}: {report.binding}")
    if analysis.clearance.touches:
        return Holding("TOUCHES", "all properties hold, but a palm touches the object elsewhere")
    doubts = [one for one in analysis.warnings if one != load.warning()]
    farthest = max(abs(end) for ends in contacts for end in ends)
    if farthest >= max(scene.palm_of(side).reach_m for side in SIDES):
        return _of_load(load, doubts)
    loads = [mass for mass, _ in load.limits_within(farthest)]
    if loads and load.mass_kg > loads[0]:
        doubts.insert(0, load.within_sentence(farthest))
    low, high = contacts[0]
    where = f"with contacts from {1e3 * low:.1f} to {millimetres(high)}"
    return _judged(load, doubts, where)


def _of_load(load: LoadLimits, doubts: list[str]) -> Holding:
    """The verdict with contacts anywhere on the palms, from the load and from other doubts."""
    doubts = [*([] if load.holds else [load.zone_sentence()]), *doubts]
    return _judged(load, doubts, "with contacts anywhere on the palms")


def _judged(load: LoadLimits, doubts: list[str], where: str) -> Holding:
    if doubts:
        return Holding("MAY FAIL", "; ".join(doubts))
    return Holding("HOLDS", f"an object of {load.mass_kg:g} kg, {where}")


def holding_of(scene: Scene, load: LoadLimits) -> Holding:
    """The verdict with contacts anywhere on the palms. Where planar mechanics do not apply, such as
    on a curved path, it is only about what the robots hold."""
    from palmbots.stability.analysis import analyze

    try:
        return holding(analyze(scene))
    except PalmbotsError:
        if refusal := load.refusal():
            return Holding("FAILS", refusal)
        return _of_load(load, [])


def load_lines(load: LoadLimits) -> Iterator[Item]:
    """The report of `load`: the first line, and every limit."""
    found = holding_of(load.scene, load)
    yield found.line()
    if not load.holds and load.refusal() is None and load.zone_sentence() not in found.text:
        yield load.zone_sentence()
    yield load.sentence()
    half = {kind: mass for mass, kind in load.limits_within(0.5 * load.reach_m)}
    rows = [
        (
            f"  {limit.meaning}",
            *map(_mass, (limit.heaviest_kg, half.get(limit.kind), limit.at_start_kg)),
            limit.key,
        )
        for limit in load.limits
    ]
    numbers = ("anywhere\n[kg]", "inner half\n[kg]", "at start\n[kg]")
    yield Table(rows, ("", *numbers, "key"), right=numbers, gap=2)


def _mass(mass: float | None) -> str:
    return "any" if mass is None else mass_text(mass)
