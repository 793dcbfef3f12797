# SPDX-License-Identifier: Apache-2.0
"""What people read of a carry."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from palmbots._types import SIDES
from palmbots._util.report import Item, Line, Table, bold, quiet, verdict, warning
from palmbots._util.text import millimetres, plural
from palmbots.control.registry import describe
from palmbots.scene.spec import to_spec
from palmbots.simulation.carry_ends import reason_text
from palmbots.simulation.floor_job import covered_m

if TYPE_CHECKING:
    from palmbots.control.resilient_timing import Bounds
    from palmbots.simulation.floor_job import FloorJob
    from palmbots.simulation.result import Carry


def carry_lines(
    carry: "Carry", warnings: Sequence[str] | None = None, hint: str | None = None
) -> Iterator[Item]:
    """The outcome, its reason, contacts, corrections, messages.

    Args:
        carry: the carry.
        warnings: those of its warnings that are not printed yet; None: all.
        hint: a sentence on the reason of the outcome, and after "; run: " a command.
    """
    yield _head(carry)
    if carry.floor_job is not None and carry.floor_job.failure is not None:
        yield Line(carry.floor_job.failure, indent=2)
    if carry.reason is not None:
        yield Line(reason_text(carry.reason, carry.world), indent=2)
    elif (
        carry.outcome == "stalled"
        and carry.time_s > carry.scene.timeout_s - carry.scene.control.period_s
    ):
        is_default = carry.scene.task.timeout_s is None
        usual = ", the default: twice the time at nominal speed" if is_default else ""
        limit = f"time limit reached: task.timeout_s is {carry.scene.timeout_s:g} s{usual}"
        yield Line(limit, indent=2)
    if hint is not None:
        sentence, _, command = hint.partition("; run: ")
        yield Line(sentence, indent=2)
        if command:  # whole, so that it can be copied
            yield Line(f"run: {command}", indent=2, is_whole=True)
    if abs(carry.rest_angle_deg) >= 0.05:
        yield f"object: outline turned by {carry.rest_angle_deg:.1f}° to rest on its contacts"
    if carry.floor_job is not None:
        yield from _floor_job(carry.floor_job)
    yield from _contacts(carry)
    yield from _corrections(carry)
    if carry.bounds is not None:
        yield from _bounds(carry.bounds)
    yield from _further_contacts(carry)
    yield _messages(carry)
    yield from map(warning, carry.warnings if warnings is None else warnings)


def _head(carry: "Carry") -> Line:
    kind = carry.precision if carry.world == "quasistatic" else carry.world
    forks = "".join(f", {seed} from {at_s:g} s" for at_s, seed in carry.forks)
    way_m = covered_m(carry.floor_job, carry.distance_m)
    way = f"{way_m:.2f} of {carry.scene.task.distance_m:.2f} m in {carry.time_s:.1f} s"
    word = carry.outcome.upper()
    return Line(
        verdict(carry.outcome == "delivered", word, word),
        bold(f"  {way}"),
        quiet(f"   {carry.controller}, seed {carry.seed}{forks}, {kind}"),
    )


def _floor_job(job: "FloorJob") -> Iterator[Item]:
    """Where the object ends, and when each robot began its phases."""
    off = "less" if job.missed_m < 0 else "more"
    yield (
        f"the object moved {job.moved_m:.2f} m, {100 * abs(job.missed_m):.1f} cm {off} than the "
        "distance of the task"
    )
    if job.falls:
        highest = max(fall.height_m for fall in job.falls)
        energy = sum(fall.energy_j for fall in job.falls)
        times = "once" if len(job.falls) == 1 else f"{len(job.falls)} times"
        yield f"it fell {times}, by at most {millimetres(highest)}; {1e3 * energy:.2g} mJ in all"
    yield Line("phases", quiet("   begun at"))
    starts: dict[str, dict[str, str]] = {}
    for one in job.phases:
        starts.setdefault(one.phase, {}).setdefault(one.robot, f"{one.start_s:.1f} s")
    rows = [(f"  {name}", *(by.get(side, "") for side in SIDES)) for name, by in starts.items()]
    yield Table([("", bold("left"), bold("right")), *rows])


def _contacts(carry: "Carry") -> Iterator[Table]:
    rows: list[tuple[str, ...]] = []
    if not to_spec(carry.scene, unrolled=True).on_one_palm:  # they count what two palms hold
        rows += [
            ("contact rms", *map(millimetres, carry.contact_rms_m.values())),
            ("contact peak", *map(millimetres, carry.contact_peak_m.values())),
        ]
    if carry.lateral_peak_m is not None and carry.scene.task.path.is_curved:
        rows.append(("lateral peak", *map(millimetres, carry.lateral_peak_m.values())))
    if carry.wheel_slip_m is not None:
        rows.append(("wheel slip", *map(millimetres, carry.wheel_slip_m.values())))
    if carry.messages and describe(carry.controller).team == "robots":
        rows.append(("waiting time", *(f"{waited:.1f} s" for waited in carry.waiting_s.values())))
    if any(carry.stalled_s.values()):
        rows.append(("stalled", *(f"{stalled:.1f} s" for stalled in carry.stalled_s.values())))
    if rows:
        yield Table([("", bold("left"), bold("right")), *rows])


def _corrections(carry: "Carry") -> Iterator[Item]:
    """The number of corrections, by case and robot."""
    if not carry.corrections:
        return
    controller = carry.controller_entry or describe(carry.controller)
    listed = len(carry.corrections)
    part = f"; the first {listed}:" if listed < carry.correction_count else ""
    yield Line(
        f"{plural(carry.correction_count, 'correction')}{part}",
        quiet("   p: distance of a contact from its pivot, outward > 0"),
    )
    counts = Counter((c.case, c.robot) for c in carry.corrections)
    alone = Counter(c.case for c in carry.corrections if c.assistant is None)
    rows = []
    for case in sorted({case for case, _ in counts}):
        by_robot = "   ".join(
            f"{robot} {counts[case, robot]}" for robot in (*SIDES, "both") if counts[case, robot]
        )
        if case in controller.assisted_cases and alone[case]:
            by_robot += f"   ({alone[case]} unanswered)"
        rows.append((f"  ({case})", quiet(controller.cases.get(case, "")), by_robot))
    yield Table(rows)


def _bounds(b: "Bounds") -> Iterator[Item]:
    """The time bounds of the resilient algorithm."""
    yield quiet(
        f"lease {b.lease_s:g} s (at least {b.shortest_lease_s:g} s): tolerates "
        f"{plural(b.losses, 'lost beacon')} in a row; a palm stays up for {b.hold_s:g} s of "
        "silence"
    )
    yield quiet(
        f"a robot travels alone for at most {b.alone_s:g} s: a contact shifts by at most "
        f"{millimetres(b.skew_m)}, plus {millimetres(b.noise_m)} by noise, of the "
        f"{millimetres(b.room_m)} available"
    )


def _further_contacts(carry: "Carry") -> Iterator[Item]:
    if carry.ambiguous_events:
        yield quiet(
            f"{plural(carry.ambiguous_events, 'event')} after which several contact modes were "
            f"possible (world.ambiguity: {carry.scene.world.ambiguity})"
        )
    if carry.ambiguous_choices:
        first_choice = carry.ambiguous_choices[0]
        contacts = ", ".join(f"{one.surface} {one.motion}" for one in first_choice.contacts)
        yield quiet(f"  first: at {first_choice.time_s:.2f} s, chosen: {contacts}")
    if not carry.contact_events:
        return
    first = carry.contact_events[0]
    total_s = sum(event.end_s - event.start_s for event in carry.contact_events)
    yield (
        f"{plural(len(carry.contact_events), 'period')} with more than two contacts, "
        f"{total_s:.2f} s in total; first: {first.kind}, {first.robot} palm, at "
        f"{first.start_s:.2f} s"
    )


def _messages(carry: "Carry") -> Item:
    line = plural(carry.messages, "message")
    if carry.messages_lost:
        line += f", {carry.messages_lost} lost"
    if carry.scene.radio.corruption > 0:
        line += f", {sum(link.rejected for link in carry.links.values())} rejected"
    if carry.bump_count:
        line += f"   {plural(carry.bump_count, 'bump')}"
    return quiet(f"{line}   trace {carry.trace_hash}")
