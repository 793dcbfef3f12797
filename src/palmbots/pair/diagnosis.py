# SPDX-License-Identifier: Apache-2.0
"""What `palmbots doctor` finds: the radio, the lease that it needs, and what else was checked."""

from collections.abc import Iterator
from dataclasses import dataclass

from palmbots._types import Side
from palmbots._util.report import Item, Line, Table, bold
from palmbots._util.results import Result
from palmbots.pair.checkup import Check
from palmbots.pair.link_check import LinkFigures, Needs

_SILENT = (
    "not heard: is its program running, with the same key and number? Does it have its own address "
    "under [link], and does no firewall stop UDP?"
)


@dataclass(frozen=True, repr=False)
class Diagnosis(Result):
    """What is well with a pair, or with one robot, and what is not."""

    well: bool
    """Nothing has to be done."""
    checks: tuple[Check, ...]
    controller: str | None = None
    """The chosen one; None: the radio was not measured, as on a robot."""
    links: dict[Side, LinkFigures] | None = None
    """Between the station and each robot; None: not measured."""
    needs: Needs | None = None
    """What the radio means for the controllers; None: no robot was heard, or not measured."""

    def lines(self) -> Iterator[Item]:
        """What was measured, the lease that it needs, and one line for each check."""
        links: dict[Side, LinkFigures] = self.links or {}
        if self.needs is not None:
            heads = ("robot", "mode", "loss", "round trip: median", "99 %", "longest")
            yield Table([_row(side, one) for side, one in links.items() if one.received], heads)
            yield (
                f"The lease has to be at least {self.needs.lease_s:.2f} s, for a delay of "
                f"{1e3 * self.needs.delay_s:.0f} ms and these losses."
            )
            yield "This radio, if it is the same between the robots, for each controller:"
            rows = [
                (bold(f"{name}{' (chosen)' if name == self.controller else ''}"), verdict)
                for name, verdict in self.needs.verdicts.items()
            ]
            yield Table(rows, gap=2)
        for side, one in links.items():
            if not one.received:
                yield f"{side} robot:"
                yield Line(_SILENT, indent=2)
        for check in self.checks:
            name = f"{check.robot} {check.about}".strip()
            mark = "WRONG" if not check.is_well else "ok" if check.is_sure else "unsure"
            remedy = f": {check.remedy}" if check.remedy else ""
            yield Line(f"{mark:6} {name}: {check.text}{remedy}", is_whole=True)


def _row(side: Side, one: LinkFigures) -> tuple[str, ...]:
    fault = "" if one.fault == "none" else f" ({one.fault})"
    times = (f"{1e3 * one.round_trip_s(q):.0f} ms" for q in (0.5, 0.99, 1.0))
    return (side, one.mode + fault, f"{100 * one.loss:.1f} %", *times)
