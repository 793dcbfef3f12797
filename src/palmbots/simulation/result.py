# SPDX-License-Identifier: Apache-2.0
"""The result of a carry: outcome, corrections, messages, warnings, trace."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, cast

from palmbots._types import SIDES, BySide
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import Result
from palmbots._util.text import letter_label
from palmbots._version import __version__
from palmbots.control.python_source import ControllerSource
from palmbots.control.registry import ControllerEntry
from palmbots.control.resilient_timing import Bounds
from palmbots.mechanics.consistent_modes import CODE_OF
from palmbots.scene.scene import Scene
from palmbots.simulation.floor_job import FloorJob, floor_job
from palmbots.simulation.outcome_counts import SceneStatistics, scene_statistics
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.simulation.trace import trace_dataset, with_pose
from palmbots.simulation.worlds import WorldRun

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True)
class Correction:
    """One corrective action. An assisting (c) belongs to the correction that it assists."""

    label: str
    """A, B, … Z, AA, … in order of their start."""
    robot: Literal["left", "right", "both"]
    """Whose contact is corrected."""
    case: str
    """``a``, ``b``, ``d`` of Table 2, or ``1`` to ``8`` of Table 1."""
    assistant: Literal["left", "right"] | None
    """The robot that assisted; None also where a robot asked and got no answer."""
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """A time during which the object rested on other points than its two contact vertices, or on
    further ones."""

    robot: Literal["left", "right"]
    """The robot whose palm had the further contact."""
    kind: Literal["flush", "tip"]
    """``flush``: an edge or a further vertex lay on the palm; ``tip``: the palm's tip met an
    edge."""
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class ContactMotion:
    """How one contact moves after an ambiguous event."""

    surface: Literal["left", "right", "floor"]
    """The palm that the object touches there, or the floor."""
    motion: Literal["ST", "SL", "SR"]
    """It sticks, slides to the left or to the right."""


@dataclass(frozen=True, slots=True)
class AmbiguousChoice:
    """What the world chose where several contact modes could follow."""

    time_s: float
    contacts: tuple[ContactMotion, ...]
    """The contacts that persist; all others open."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message between robots."""

    sent_s: float
    received_s: float | None
    """When the receiver can read it; None if it was lost, or arrived damaged."""
    sender: Literal["left", "right"]
    receiver: Literal["left", "right"]
    kind: str
    """A kind of the controller's messages; or `Hello`, which only answers a message without a
    session: one that was not sent in answer to the present boot of its receiver."""


@dataclass(frozen=True, slots=True)
class LinkStatistics:
    """Counts of the messages on one link, in one direction."""

    sent: int
    delivered: int
    """All that were not lost, and the duplicates; the last ones may still be in transit."""
    lost: int
    duplicated: int
    expired: int
    """Received by the resilient algorithm, but older than the lease."""
    rejected: int
    """Arrived damaged, or ignored: a duplicate, overtaken, or not sent in answer to the receiver's
    present boot."""


_NEVER = BySide(0.0, 0.0)


@dataclass(frozen=True, repr=False)
class Carry(Result):
    """A finished carry."""

    figure = "carry"
    more_figures = ("message_sequence", "lift_phases")
    lines_of = "palmbots.simulation.carry_lines:carry_lines"

    scene: Scene
    controller: str
    world: str
    precision: str
    seed: int
    version: str
    outcome: Literal["delivered", "dropped", "stalled"]
    reason: str | None
    """Why the object was dropped, from a fixed list; None if it was not dropped."""
    time_s: float
    distance_m: float
    contact_rms_m: BySide[float]
    """The root mean square of the contact coordinate."""
    contact_peak_m: BySide[float]
    """The largest absolute contact coordinate."""
    corrections: tuple[Correction, ...]
    """The first 512; `correction_count` is the number of all."""
    correction_count: int
    contact_events: tuple[ContactEvent, ...]
    """When the object rested on other points than its two contact vertices, or on further ones."""
    messages: int
    """Messages sent, reports and commands of a station included."""
    messages_lost: int
    links: dict[str, LinkStatistics]
    """By direction, as in ``left_to_right`` or ``station_to_left``; only links that were used."""
    bounds: Bounds | None
    """The time bounds on which the controller relies; None: it relies on none."""
    waiting_s: BySide[float]
    """How long each robot waited for a message, at its nominal speed."""
    bump_count: int
    warnings: tuple[str, ...]
    trace_hash: str
    """Equal hashes mean equal traces, to the last bit."""
    trace: "xr.Dataset | None" = field(metadata=NOT_IN_JSON)
    """Every tick (None with ``record=False``); the last entry is the end."""
    message_log: tuple[Message, ...] = field(metadata=NOT_IN_JSON)
    mujoco_record: Any = field(default=None, metadata=NOT_IN_JSON)
    """What the world ``mujoco`` alone keeps, for videos (None with ``record=False``)."""
    lateral_peak_m: BySide[float] | None = None
    """The largest lateral contact coordinate: how far the middle of each contact edge moved across
    its palm, to the left seen from the left robot to the right one (None in a planar world)."""
    wheel_slip_m: BySide[float] | None = None
    """How much farther the wheels of each robot rolled than the robot moved; < 0: the robot moved
    farther (None in a world without wheels)."""
    floor_job: FloorJob | None = None
    """The job that began or ended on the floor (None for a carry from palms to palms)."""
    forks: tuple[tuple[float, int], ...] = ()
    """Pairs (time [s], seed): from each time on, the random numbers are those of that seed."""
    ambiguous_events: int = 0
    """How often several contact modes could follow, among further contacts or under a pipe;
    `world.ambiguity` says which one did (0 in worlds other than the quasistatic one)."""
    stalled_s: BySide[float] = _NEVER
    """How long each robot stalled, that is, was slower than commanded: its motors or its traction
    gave less force than it needed, or the object could not give way (0 in the MuJoCo world from
    palms to palms, and in logs of robots)."""
    ambiguous_choices: tuple[AmbiguousChoice, ...] = ()
    """When each ambiguous event was, and how the contacts moved on."""
    controller_source: ControllerSource | None = None
    """Where a Python controller is defined; None: the controller is a shipped one."""
    controller_entry: ControllerEntry | None = field(
        default=None, compare=False, metadata=NOT_IN_JSON
    )
    """The controller itself; None: this carry was read from a log."""

    @derived
    def rest_angle_deg(self) -> float:
        """The angle by which the outline is turned to rest on its contact vertices."""
        return self.scene.object.rest_angle_deg

    @cached_property
    def statistics(self) -> SceneStatistics | None:
        """How often its scene fails with its controller, and which shipped ones do better.

        It takes up to a second when it is first asked for. None: the carries take long;
        `palmbots.simulation.count_outcomes` counts as many as you want.
        """
        prepared = prepare(self.scene, self.controller_entry or self.controller, self.world)
        return scene_statistics(prepared, precision=self.precision)

    def plot(self, figure: str | None = None, **options: Any) -> Any:
        """Draw the carry: ``carry`` (its panels over time), or ``message_sequence``.

        ``lift_phases`` draws a job that begins or ends on the floor.

        Returns:
            The `matplotlib.figure.Figure`; save it with its ``savefig``.

        Raises:
            PalmbotsError: the carry has no trace, or there is no such figure.
        """
        return super().plot(figure, **options)


# Values of the core's record that a `Carry` has under the same name.
_AS_MEASURED = (
    "outcome", "reason", "time_s", "distance_m", "correction_count", "messages", "messages_lost",
    "trace_hash", "ambiguous_events",
)  # fmt: skip
_BY_SIDE = ("contact_rms_m", "contact_peak_m", "waiting_s", "stalled_s")


def make_carry(
    prepared: Prepared,
    seed: int,
    run: WorldRun,
    *,
    record: bool,
    precision: str = "double",
    forks: tuple[tuple[float, int], ...] = (),
) -> Carry:
    """The result of a carry that a world has run, with its trace if `record`."""
    measured, entry = run.measured, prepared.controller
    trace = None
    if record:
        trace = with_pose(trace_dataset(measured.trace, run.trace), prepared.spec)
    values: dict[str, Any] = {name: getattr(measured, name) for name in _AS_MEASURED}
    values |= {name: BySide.of(getattr(measured, name)) for name in _BY_SIDE}
    events = measured.contact_events if run.contact_events is None else run.contact_events
    return Carry(
        **values,
        scene=prepared.scene,
        controller=entry.name,
        world=prepared.world.name,
        precision=precision,
        seed=seed,
        forks=forks,
        version=__version__,
        corrections=_corrections(measured.corrections),
        contact_events=tuple(
            ContactEvent(SIDES[side], kind, start, end) for side, kind, start, end in events
        ),
        links=_links(measured.links, entry),
        bounds=prepared.timing,
        bump_count=measured.bumps,
        warnings=(
            *prepared.warnings,
            *run.warnings,
            *measured.warnings(prepared.spec, entry.stops_in_silence),
        ),
        trace=trace,
        message_log=tuple(
            Message(sent, None if math.isnan(got) else got, SIDES[sender], SIDES[receiver], kind)
            for sent, got, sender, receiver, kind in measured.message_log
        ),
        mujoco_record=run.recording,
        lateral_peak_m=None if run.lateral_peak_m is None else BySide.of(run.lateral_peak_m),
        wheel_slip_m=None if run.wheel_slip_m is None else BySide.of(run.wheel_slip_m),
        floor_job=floor_job(prepared.scene, measured) if prepared.spec.uses_floor else None,
        ambiguous_choices=_choices(measured.choices),
        controller_source=entry.source,
        controller_entry=entry,
    )


_SURFACES: tuple[Literal["left", "right", "floor"], ...] = ("left", "right", "floor")


def _choices(rows: list[Any]) -> tuple[AmbiguousChoice, ...]:
    return tuple(
        AmbiguousChoice(
            time_s,
            tuple(
                # The floor counts outward as the right palm.
                ContactMotion(_SURFACES[surface], cast(Any, CODE_OF[min(surface, 1)][motion]))
                for surface, motion in contacts
            ),
        )
        for time_s, contacts in rows
    )


def _corrections(rows: list[Any]) -> tuple[Correction, ...]:
    robots = (*SIDES, "both")
    return tuple(
        Correction(
            label=letter_label(i),
            robot=robots[robot],
            case=case,
            assistant=None if assistant < 0 else SIDES[assistant],
            start_s=start,
            end_s=end,
        )
        for i, (robot, case, assistant, start, end) in enumerate(rows)
    )


def _links(rows: list[Any], controller: ControllerEntry) -> dict[str, LinkStatistics]:
    """The links that were used, by name."""
    partners = ("station", "station") if controller.team == "station" else ("right", "left")
    names = [f"{side}_to_{to}" for side, to in zip(SIDES, partners, strict=True)]
    names += [f"station_to_{side}" for side in SIDES]
    return {
        name: LinkStatistics(sent, sent - lost + copies, lost, copies, expired, rejected)
        for name, (sent, lost, copies, expired, rejected) in zip(names, rows, strict=True)
        if sent
    }
