# SPDX-License-Identifier: Apache-2.0
"""A run of robots as a carry, from their logs, and its figures.

Robots know the sign of the contact coordinate, not the coordinate itself: it is NaN. The separation
is that of the start plus what the odometry of both robots adds.
"""

import math
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots._types import SIDES, BySide, Side
from palmbots._util.atomic_files import folder
from palmbots._util.command import Option, writes
from palmbots._version import __version__
from palmbots.errors import PalmbotsError
from palmbots.logs.replaying import ReplayResult
from palmbots.logs.run_log_reader import RunLog
from palmbots.pair.drive_table import drive_table
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.result import Carry, Correction, Message
from palmbots.simulation.trace import trace_dataset
from palmbots.station.correction_watch import CorrectionWatch, SeenCorrection
from palmbots.views.log_alignment import ClockFit, traffic
from palmbots.views.logged_carries import WHOLE, travel_ticks
from palmbots.views.run_replay import RunReplay

_ENDS = (*SIDES, "station")
_GAP_TICKS = 5
_APART_S = 2.0
"""A longer rest of the wheels ends a carry."""
WORLD = "robots"
"""The world of such a carry."""


@writes("replay", out=Option(metavar="DIR"))
def save_figures(
    replay: RunReplay | ReplayResult,
    out: str | PathLike[str],
    *,
    on_warning: Callable[[str], None],
) -> list[Path]:
    """Write ``carry.png``, and ``message_sequence.png`` if the robots exchanged messages.

    Args:
        replay: what was verified.
        out: write figures of a run of real robots to this folder.
        on_warning: called with a line if the logs show no carry of both robots.

    Raises:
        PalmbotsError: a file cannot be written, or the logs are not those of robots.
    """
    from palmbots.viz import carry_figure, sequence_chart

    if isinstance(replay, ReplayResult):
        raise PalmbotsError("--out: draws runs of robots; allowed: for logs of robots")
    try:
        carry = carry_of(replay.run, replay.clocks)
    except PalmbotsError as error:  # what was verified counts all the same
        on_warning(f"no figures: {error}")
        return []
    target = folder(out)
    written = [target / "carry.png"]
    carry_figure.save(carry, written[0])
    if carry.message_log:
        written.append(target / "message_sequence.png")
        sequence_chart.save(carry, written[-1])
    return written


def carry_of(logs: Sequence[RunLog], clocks: Sequence[ClockFit]) -> Carry:
    """The carry that the logs of both robots show; the last one, if there are more.

    Args:
        logs: of both robots, and of the station if there is one.
        clocks: for each log how its clock relates to that of the reference of its run.

    Raises:
        PalmbotsError: there is none, no packets connect the logs of both robots, or one is damaged.
    """
    for log in logs:
        _check(log)
    logs, clocks = _last_run(logs, clocks)
    ticks: dict[Side, list[tuple[float, Any]]] = {
        side: _ticks(side, logs, clocks) for side in SIDES
    }
    scene = load_scene(next(log for log in logs if log.end in SIDES).facts["scene"])
    start_s, end_s = _span(ticks)
    count = max(1, round((end_s - start_s) / scene.control.period_s)) + 1
    times = np.arange(count) * scene.control.period_s
    rows: dict[Side, list[Any]] = {side: _rows(ticks[side], times + start_s) for side in SIDES}
    is_measured = not any(travel_ticks(log) for log in logs if log.end in SIDES)
    trace = _trace(scene, times, rows, is_measured)
    for side in SIDES:  # where the log of a robot has a gap, nobody knows where the robot was
        instants = np.array([now for now, _ in ticks[side]])
        places = np.searchsorted(instants, times + start_s, side="right") - 1
        ages = times + start_s - instants[np.maximum(places, 0)]
        trace["separation"][ages > _GAP_TICKS * scene.control.period_s] = math.nan
    controller = next(log for log in logs if log.end in SIDES).facts["controller"]
    messages = _messages(logs, clocks, start_s, end_s)
    corrections = _corrections(times, rows)
    ends = {side: _last(side, logs, ticks[side]) for side in SIDES}
    is_done = set(ends.values()) == {"done"}
    reason = ", ".join(f"{side} {text}" for side, text in ends.items())
    if len(set(ends.values())) == 1:
        reason = f"both robots {ends['left']}"
    nothing = BySide(math.nan, math.nan)
    return Carry(
        scene=scene,
        controller=controller,
        world=WORLD,
        precision="double",
        seed=0,
        version=__version__,
        outcome="delivered" if is_done else "stalled",
        reason=None if is_done else reason,
        time_s=float(times[-1]),
        distance_m=abs(float(trace["midpoint"].to_numpy()[-1])),
        contact_rms_m=nothing,
        contact_peak_m=nothing,
        corrections=corrections,
        correction_count=len(corrections),
        contact_events=(),
        messages=len(messages),
        messages_lost=sum(message.received_s is None for message in messages),
        links={},
        bounds=None,
        waiting_s=nothing,
        bump_count=0,
        warnings=(),
        trace_hash="",
        trace=trace,
        message_log=messages,
    )


def _check(log: RunLog) -> None:
    """Refuse numbers that no robot writes. A correct checksum does not exclude them."""
    most = len(_core.wire.messages)
    for number, (_, tick) in enumerate(log.messages["ticks"], start=1):
        if not (
            tick.palm in (0, 1)
            and tick.move in (0, 1, 2)
            and tick.sign in (-1, 0, 1)
            and tick.case.isascii()
            and len(tick.receivers) == len(tick.words)
            and all(0 <= to < len(_ENDS) for to in tick.receivers)
            and all(0 <= word < most for word in tick.words)
        ):
            raise PalmbotsError(f"{log.path}: is damaged: its tick {number} is none of a robot")


def _last_run(
    logs: Sequence[RunLog], clocks: Sequence[ClockFit]
) -> tuple[list[RunLog], list[ClockFit]]:
    """The logs of the last run in which both robots were active."""
    active = {side: set[int]() for side in SIDES}
    for log, clock in zip(logs, clocks, strict=True):
        if log.end in SIDES and log.messages["ticks"]:
            active[log.end].add(clock.run)
    for side, runs in active.items():
        if not runs:
            raise PalmbotsError(f"logs: none of the {side} robot; needed: those of both robots")
    both = active["left"] & active["right"]
    if not both:
        raise PalmbotsError(
            "logs: no packets connect those of both robots; needed: the station's log, or packets "
            "of the partner"
        )
    pairs = [pair for pair in zip(logs, clocks, strict=True) if pair[1].run == max(both)]
    return [log for log, _ in pairs], [clock for _, clock in pairs]


def _ticks(side: Side, logs: Sequence[RunLog], fits: Sequence[ClockFit]) -> list[tuple[float, Any]]:
    """All ticks of one robot, on the clock of the reference."""
    found: list[tuple[float, Any]] = []
    for log, fit in zip(logs, fits, strict=True):
        if log.end != side or not log.messages["ticks"]:
            continue
        found += [(fit.to_reference(now), tick) for now, tick in log.messages["ticks"]]
    return sorted(found, key=lambda entry: entry[0])


def _last(side: Side, logs: Sequence[RunLog], ticks: list[tuple[float, Any]]) -> str:
    """The last mode or fault of a robot that a log knows. That of a robot that was ended may lack
    it."""
    modes = [(tick.mode, tick.fault) for _, tick in ticks[-1:]]
    for log in logs:
        if log.end == "station":
            news = [s for _, s in log.messages["received"] if s.sender == side]
            modes += [(status.mode, status.fault) for status in news[-1:]]
    if ("done", "none") in modes:
        return "done"
    mode, fault = modes[-1]
    return mode if fault == "none" else fault


def _span(ticks: dict[Side, list[tuple[float, Any]]]) -> tuple[float, float]:
    """Start and end of the last carry in which the wheels of both robots could turn."""
    starts, ends = [], []
    for side in SIDES:
        turning = [now for now, tick in ticks[side] if tick.wheels]
        if not turning:
            raise PalmbotsError("logs: show no carry: the wheels of a robot never turned")
        gaps = [k for k in range(1, len(turning)) if turning[k] - turning[k - 1] > _APART_S]
        starts.append(turning[gaps[-1] if gaps else 0])
        ends.append(turning[-1])
    if max(starts) > min(ends):
        raise PalmbotsError("logs: show no carry: the wheels of both robots never turned at once")
    end_s = max(ends)
    after = [now for side in SIDES for now, _ in ticks[side] if 0 < now - end_s <= _APART_S]
    return min(starts), min(after, default=end_s)


def _rows(ticks: list[tuple[float, Any]], times: Any) -> list[Any]:
    """The newest tick at each of these times. After the wheels' last turn only the first tick at
    rest counts: later ones belong to no carry, and their progress is 0."""
    last = max(k for k, (_, tick) in enumerate(ticks) if tick.wheels)
    ticks = ticks[: last + 2]
    instants = np.array([now for now, _ in ticks])
    places = np.clip(np.searchsorted(instants, times, side="right") - 1, 0, len(ticks) - 1)
    return [ticks[k][1] for k in places]


def _trace(scene: Scene, times: Any, rows: dict[Side, list[Any]], is_measured: bool) -> Any:
    """Without encoders the midpoint is where the commands would have moved it, and the separation
    is NaN: unknown."""
    spec = to_spec(scene)
    drives = {side: drive_table(scene, side) for side in SIDES}

    def by_side(value: Any) -> Any:
        return np.array([[value(side, row) for row in rows[side]] for side in SIDES]).T

    def drive(side: Side, row: Any) -> Any:
        return drives[side][row.palm, row.move, row.rests, row.wheels]

    forward = 1.0 if scene.task.direction == "forward" else -1.0
    commanded = forward * by_side(lambda side, row: drive(side, row).speed_m_s)
    unknown = np.full((len(times), 2), math.nan)
    period_s = scene.control.period_s
    separation = np.full(len(times), math.nan)
    speed = commanded
    moved = np.concatenate([np.zeros((1, 2)), period_s * np.cumsum(commanded[:-1], axis=0)])
    if is_measured:
        progress = by_side(lambda _, row: row.progress / WHOLE)
        moved = forward * scene.task.distance_m * (progress - progress[0])
        speed = np.diff(moved, axis=0, append=moved[-1:]) / period_s
        separation = spec.com_left + spec.com_right + moved[:, 1] - moved[:, 0]
    columns = {
        "time_s": times,
        "contact_m": unknown,
        "vertex_height_m": np.zeros_like(unknown),
        "palm_rad": by_side(lambda side, row: drive(side, row).palm_rad),
        "speed_m_s": speed,
        "commanded_m_s": commanded,
        "separation_m": separation,
        "midpoint_m": moved.mean(axis=1),
        "object_rad": np.zeros(len(times)),
        "sign": by_side(lambda _, row: row.sign).astype(np.int64),
        "case": by_side(lambda _, row: row.case if row.wheels else " ").astype("S1"),
        "motion": np.zeros(unknown.shape, np.int64),
    }
    return trace_dataset(columns)


def _corrections(times: Any, rows: dict[Side, list[Any]]) -> tuple[Correction, ...]:
    watch = CorrectionWatch()
    for k, now in enumerate(times.tolist()):
        for side in SIDES:
            watch.take(side, rows[side][k].case if rows[side][k].wheels else " ", now)
    over = [*watch.ended, *watch.under_way]

    def place(one: SeenCorrection) -> tuple[int, str]:
        return len(one.label), one.label

    return tuple(
        Correction(
            one.label,
            one.robot,
            one.case,
            one.assistant,
            one.start_s,
            float(times[-1]) if one.end_s is None else one.end_s,
        )
        for one in sorted(over, key=place)
    )


def _messages(
    logs: Sequence[RunLog], fits: Sequence[ClockFit], start_s: float, end_s: float
) -> tuple[Message, ...]:
    """What the robots said to each other, as far as it is a message of a controller."""
    names = _core.wire.messages
    arrived: dict[tuple[str, str, int, int], float] = {}
    packets = [traffic(log) for log in logs]
    for own, fit in zip(packets, fits, strict=True):
        for stamp, now in own.received.items():
            arrived.setdefault(stamp, fit.to_reference(now) - start_s)
    found: list[Message] = []
    for log, own, fit in zip(logs, packets, fits, strict=True):
        if log.end not in SIDES:
            continue
        receiver: Side = "right" if log.end == "left" else "left"
        sent = {s: fit.to_reference(now) for s, now in own.sent.items() if s[1] == receiver}
        said = [
            names[number]
            for _, tick in log.messages["ticks"]
            for to, number in zip(tick.receivers, tick.words, strict=True)
            if _ENDS[to] == receiver and to not in tick.withheld
        ]
        for (stamp, now), name in zip(sent.items(), said, strict=False):
            if name and start_s <= now <= end_s:
                got = arrived.get(stamp)
                found.append(Message(now - start_s, got, log.end, receiver, name))
    return tuple(sorted(found, key=lambda message: message.sent_s))
