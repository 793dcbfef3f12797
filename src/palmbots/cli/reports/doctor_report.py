# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots doctor`."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from palmbots.cli.console import definitions, indented, plain_table, report_console

if TYPE_CHECKING:
    from palmbots._types import Side
    from palmbots.pair.checkup import Check
    from palmbots.pair.link_check import LinkFigures, Needs

_SILENT = (
    "not heard: is its program running, with the same key and number? Does it have its own address "
    "under [link], and does no firewall stop UDP?"
)


def doctor_report(
    figures: Mapping["Side", "LinkFigures"], needs: "Needs | None", controller: str
) -> None:
    """Print what was measured, the lease that it needs, and the controllers it suffices for."""
    console = report_console()
    table = plain_table("robot", "mode", "loss", "round trip: median", "99 %", "longest")
    for side, one in figures.items():
        if one.received:
            times = (f"{1e3 * one.round_trip_s(q):.0f} ms" for q in (0.5, 0.99, 1.0))
            fault = "" if one.fault == "none" else f" ({one.fault})"
            table.add_row(side, one.mode + fault, f"{100 * one.loss:.1f} %", *times)
    if needs is not None:
        console.print(table)
        console.print(
            f"The lease has to be at least {needs.lease_s:.2f} s, for a delay of "
            f"{1e3 * needs.delay_s:.0f} ms and these losses."
        )
        console.print("This radio, if it is the same between the robots, for each controller:")
        console.print(
            definitions(
                (f"{name}{' (chosen)' if name == controller else ''}", verdict)
                for name, verdict in needs.verdicts.items()
            )
        )
    for side, one in figures.items():
        if not one.received:
            console.print(f"{side} robot:")
            console.print(indented(_SILENT))


def checks_report(checks: Sequence["Check"]) -> None:
    """Print one line for each check: what was found, and what to do if it is wrong."""
    console = report_console()
    for check in checks:
        name = f"{check.robot} {check.about}".strip()
        mark = "ok   " if check.is_well else "WRONG"
        remedy = f": {check.remedy}" if check.remedy else ""
        console.print(f"{mark}  {name}: {check.text}{remedy}", soft_wrap=True)
