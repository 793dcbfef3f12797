# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots carry` and `palmbots replay`."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from palmbots._types import SIDES
from palmbots._util.text import millimetres, plural
from palmbots.cli.reports.console import (
    BAD,
    GOOD,
    QUIET,
    indented,
    plain_table,
    print_written_files,
    report_console,
)
from palmbots.control.registry import describe
from palmbots.control.tolerated_noise import RECOMMENDED, gain_of_recommended

if TYPE_CHECKING:
    from palmbots.control.resilient_timing import Bounds
    from palmbots.logs.replaying import ReplayResult
    from palmbots.simulation.result import Carry

NEARLY = 0.8
"""The part of the half palm beyond which a contact nearly left it."""

REASONS = {
    "off-palm": "a contact left its palm at an end or a side",
    "sliding": "no squeeze force balances the object: it slides on both palms",
    "flush": "a palm and an edge of the object coincide",
    "tip": "the end of a palm is inside the object",
    "tipping": "the centre of mass passed a contact",
    "jammed": "no motion that the palms allow is in balance",
    "lifting": "the object lifted off a palm",
}


def carry_report(
    carry: "Carry",
    scene_name: str,
    warnings: Sequence[str],
    written: Sequence[Path],
    removed: Sequence[Path] = (),
    hint: str | None = None,
) -> None:
    """Print the outcome of a carry: result, hint, contacts, corrections, messages, files."""
    console = report_console()
    good = carry.outcome == "delivered"
    head = Text(carry.outcome.upper(), style=GOOD if good else BAD)
    head.append(
        f"  {carry.distance_m:.2f} of {carry.scene.task.distance_m:.2f} m in {carry.time_s:.1f} s",
        style="bold",
    )
    kind = carry.precision if carry.world == "quasistatic" else carry.world
    head.append(f"   {scene_name}, {carry.controller}, seed {carry.seed}, {kind}", style=QUIET)
    console.print(head)
    if carry.reason is not None:
        console.print(indented(f"{carry.reason}: {REASONS[carry.reason]}"))
    elif carry.outcome == "stalled":
        is_default = carry.scene.task.timeout_s is None
        usual = ", the default: twice the time at nominal speed" if is_default else ""
        console.print(
            indented(f"time limit reached: task.timeout_s is {carry.scene.timeout_s:g} s{usual}")
        )
    if hint is not None:
        sentence, _, command = hint.partition("; run: ")
        console.print(indented(sentence))
        if command:  # whole, so that it can be copied
            console.print(f"  run: {command}", soft_wrap=True)
    angle = carry.scene.object.rest_angle_deg
    if abs(angle) >= 0.05:
        console.print(f"object: outline turned by {angle:.1f}° to rest on its contacts")
    _contacts(console, carry)
    _corrections(console, carry)
    if carry.bounds is not None:
        _bounds(console, carry.bounds)
    _further_contacts(console, carry)
    _messages(console, carry)
    for warning in warnings:
        console.print(Text("warning: ", style="bold yellow").append(warning, style="default"))
    print_written_files(console, written)
    for path in removed:
        console.print(f"removed {path} of an earlier carry", soft_wrap=True)
    if (line := _recommendation(carry)) is not None:
        console.print(line, style=QUIET)


def _recommendation(carry: "Carry") -> str | None:
    """Names a controller that tolerates more noise, if the object was or nearly was dropped."""
    if carry.controller == RECOMMENDED:
        return None
    if carry.outcome != "dropped" and not any(
        carry.contact_peak_m[side] > NEARLY * 0.5 * carry.scene.palm_of(side).length_m
        for side in SIDES
    ):
        return None
    gain = gain_of_recommended(carry.controller)
    than = f" tolerates {gain:.1f} times as much noise in the default scene" if gain else ""
    return f"recommended: --controller {RECOMMENDED}{than}"


def _contacts(console: Console, carry: "Carry") -> None:
    table = plain_table()
    table.add_row("", Text("left", style="bold"), Text("right", style="bold"))
    table.add_row("contact rms", *(millimetres(carry.contact_rms_m[s]) for s in SIDES))
    table.add_row("contact peak", *(millimetres(carry.contact_peak_m[s]) for s in SIDES))
    if carry.lateral_peak_m is not None and carry.scene.task.path.is_curved:
        table.add_row("lateral peak", *(millimetres(carry.lateral_peak_m[s]) for s in SIDES))
    if carry.messages and describe(carry.controller).team == "robots":
        table.add_row("waiting time", *(f"{carry.waiting_s[s]:.1f} s" for s in SIDES))
    console.print(table)


def _corrections(console: Console, carry: "Carry") -> None:
    """The number of corrections, by case and robot."""
    if not carry.corrections:
        return
    controller = carry.controller_entry or describe(carry.controller)
    listed = len(carry.corrections)
    part = f"; the first {listed}:" if listed < carry.correction_count else ""
    console.print(f"{plural(carry.correction_count, 'correction')}{part}", end="")
    console.print("   p: distance of a contact from its pivot, outward > 0", style=QUIET)
    counts = Counter((c.case, c.robot) for c in carry.corrections)
    alone = Counter(c.case for c in carry.corrections if c.assistant is None)
    table = plain_table()
    for case in sorted({case for case, _ in counts}):
        by_robot = "   ".join(
            f"{robot} {counts[case, robot]}" for robot in (*SIDES, "both") if counts[case, robot]
        )
        if case in controller.assisted_cases and alone[case]:
            by_robot += f"   ({alone[case]} unanswered)"
        table.add_row(f"  ({case})", Text(controller.cases.get(case, ""), style=QUIET), by_robot)
    console.print(table)


def _bounds(console: Console, b: "Bounds") -> None:
    """The time bounds of the resilient algorithm."""
    console.print(
        f"lease {b.lease_s:g} s (at least {b.shortest_lease_s:g} s): tolerates "
        f"{plural(b.losses, 'lost beacon')} in a row; a palm stays up for {b.hold_s:g} s of "
        "silence",
        style=QUIET,
    )
    console.print(
        f"a robot travels alone for at most {b.alone_s:g} s: a contact shifts by at most "
        f"{millimetres(b.skew_m)}, plus {millimetres(b.noise_m)} by noise, of the "
        f"{millimetres(b.room_m)} available",
        style=QUIET,
    )


def _further_contacts(console: Console, carry: "Carry") -> None:
    if not carry.contact_events:
        return
    first = carry.contact_events[0]
    total_s = sum(event.end_s - event.start_s for event in carry.contact_events)
    console.print(
        f"{plural(len(carry.contact_events), 'period')} with more than two contacts, "
        f"{total_s:.2f} s in total; first: {first.kind}, {first.robot} palm, at "
        f"{first.start_s:.2f} s"
    )


def _messages(console: Console, carry: "Carry") -> None:
    line = plural(carry.messages, "message")
    if carry.messages_lost:
        line += f", {carry.messages_lost} lost"
    if carry.scene.radio.corruption > 0:
        line += f", {sum(link.rejected for link in carry.links.values())} rejected"
    if carry.bump_count:
        line += f"   {plural(carry.bump_count, 'bump')}"
    console.print(f"{line}   trace {carry.trace_hash}", style=QUIET)


def replay_report(result: "ReplayResult", log: Path) -> None:
    """Print whether the new run equals the logged one."""
    console = report_console()
    if result.identical:
        head = Text("IDENTICAL", style=GOOD)
        head.append(
            f"  {result.samples} samples agree bit for bit   trace {result.trace_hash}", "default"
        )
        console.print(head)
    else:
        console.print(Text("DIFFERS", style=BAD).append(f"  {result.difference}", style="default"))
    console.print(
        f"{log}: {result.log.controller}, seed {result.log.seed}, {result.log.precision}, "
        f"version {result.log.version}",
        style=QUIET,
        soft_wrap=True,
    )
