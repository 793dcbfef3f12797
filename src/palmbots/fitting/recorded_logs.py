# SPDX-License-Identifier: Apache-2.0
"""Logs of carries as recordings: stretches in which robots drive, and the packets between them.

The commands of a carry change often, so a stretch is all that a robot drives without standing:
where the commands alone would have moved it follows from them and from the acceleration in the
scene. A command answers to what the noise has done before. So positions are taken close to each
other before the command changes: it depends on these and earlier positions, and the likelihood
holds.

The log of a simulated carry has the true positions. Logs of real robots have what their encoders
count, so slip of the wheels is no error there. The clocks of the programs are aligned by their
packets, with the shortest ways in both directions taken as equal.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES, Side
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import Source
from palmbots.fitting.motion_likelihood import Stretch
from palmbots.fitting.object_fit import Touch, touch_of
from palmbots.fitting.recorded_packets import Packets, packets_of
from palmbots.fitting.speed_steps import Step, steps_in
from palmbots.fitting.straight_stretches import LEAST_S, MOST_S, SLOWEST_M_S, thinned
from palmbots.logs.mcap_reader import read_log
from palmbots.logs.run_log_reader import RunLog, log_of_carry
from palmbots.simulation.result import Carry
from palmbots.simulation.worlds import DEFAULT_WORLD
from palmbots.views.log_alignment import ClockFit, Stamp, align, traffic
from palmbots.views.run_figures import WORLD as ROBOTS
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run

Floats = NDArray[np.float64]

LEAST_ARRIVED = 20
"""Packets of one direction of a log."""
_DIGITS = 9  # of a delay in seconds: the rest is rounding
_IRREGULAR = 3.0  # the longest usual interval between packets over the shortest usual one


def are_logs(files: Sequence[str | os.PathLike[str]]) -> bool:
    """Whether all files are logs of carries, or folders with the logs of robots."""
    paths = [user_path(file) for file in files]
    return bool(paths) and all(path.is_dir() or path.suffix == ".mcap" for path in paths)


@dataclass(frozen=True)
class RecordedCarry:
    """What a log of a carry shows, or the logs of robots in a folder of its last one."""

    sources: tuple[Source, ...]
    stretches: tuple[Stretch, ...]
    steps: tuple[Step, ...]
    packets: tuple[Packets, ...]
    """Of each direction between two programs."""
    touch: Touch


def read_carry(path: str | os.PathLike[str], run: int) -> RecordedCarry:
    """Read a log of a carry, or a folder with the logs of robots.

    Args:
        path: the file or the folder.
        run: number of the recording.

    Raises:
        PalmbotsError: it cannot be read, shows no carry, or one on a curved path.
    """
    place = user_path(path)
    file = log_of_carry(place) if place.is_dir() else place
    if file is None:
        logs = read_run([place])
        clocks = align(logs)
        carry = carry_of(logs, clocks)
        links = packets_between(logs, clocks)
    else:
        carry = read_log(file)
        links = packets_in(carry)
    if carry.scene.task.path.is_curved:
        raise PalmbotsError(f"{path}: is of a curved path; expected carries on a straight one")
    files = sorted(place.glob("*.mcap")) if place.is_dir() else [place]
    sources = [Source(str(file), hashlib.sha256(file.read_bytes()).hexdigest()) for file in files]
    stretches = tuple(stretches_in(carry, run))
    period_s = carry.scene.control.period_s
    packets = (_packets(sources[0], sent, period_s) for sent in links)
    return RecordedCarry(
        tuple(sources),
        stretches,
        tuple(steps_of(carry, run)),
        tuple(one for one in packets if one),
        touch_of(carry, os.fspath(path)),
    )


def stretches_in(carry: Carry, run: int) -> Iterator[Stretch]:
    """What each robot drives without standing."""
    trace = carry.trace
    assert trace is not None
    times = trace["time"].to_numpy()
    held_s = 0.0 if carry.world == ROBOTS else carry.scene.control.period_s
    is_exact = carry.world == DEFAULT_WORLD
    for number, side in enumerate(SIDES):
        moved = _moved(carry, side)
        wanted = trace["commanded"].to_numpy()[:, number]
        speeds = _reached(wanted, carry, side)
        commanded = np.concatenate([[0.0], np.cumsum(speeds[:-1] * np.diff(times))])
        drives = ((wanted != 0) | (speeds != 0)) & np.isfinite(moved)
        drives[-1] = False  # the end of a carry lies within a tick
        edges = np.flatnonzero(np.diff(np.concatenate([[False], drives, [False]])))
        last_s = math.nan  # of the stretch before
        for first, after in edges.reshape(-1, 2):
            every = np.arange(first, after)
            rows = every[times[every] < times[first] + MOST_S]
            is_cut = len(rows) < len(every)
            if not is_exact:
                rows = rows[thinned(times[rows], wanted[rows])]
            if len(rows) < 2:
                continue
            duration = times[rows[-1]] - times[rows[0]]
            way = abs(commanded[rows[-1]] - commanded[rows[0]])
            yield Stretch(
                times[rows] - times[first],
                moved[rows] - moved[first],
                commanded[rows],
                run,
                stood_s=times[first] - last_s,
                held_s=held_s,
                is_exact=is_exact,
                is_short=bool(duration <= LEAST_S or way <= SLOWEST_M_S * duration),
            )
            last_s = math.nan if is_cut else times[rows[-1]]


def steps_of(carry: Carry, run: int) -> Iterator[Step]:
    """Changes of the commanded speed of each robot."""
    trace = carry.trace
    assert trace is not None
    times = trace["time"].to_numpy()
    for number, side in enumerate(SIDES):
        moved = _moved(carry, side)
        is_known = np.isfinite(moved)
        if is_known.sum() > 1:
            wanted = trace["commanded"].to_numpy()[:, number]
            yield from steps_in((times, wanted), times[is_known], moved[is_known], 0.0, run)


def _moved(carry: Carry, side: Side) -> Floats:
    """The displacement of a robot."""
    trace = carry.trace
    assert trace is not None
    outward = -0.5 if side == "left" else 0.5
    return trace["midpoint"].to_numpy() + outward * trace["separation"].to_numpy()


def _reached(wanted: Floats, carry: Carry, side: Side) -> Floats:
    """The speeds that wheels reach in each tick, within the acceleration of the scene."""
    most = carry.scene.robot_of(side).acceleration_m_s2 * carry.scene.control.period_s
    speed, found = 0.0, []
    for one in wanted.tolist():
        speed += min(max(one - speed, -most), most)
        found.append(speed)
    return np.array(found)


@dataclass(frozen=True)
class Sent:
    """The packets of one direction."""

    times_s: Sequence[tuple[float, float | None]]
    """For each when it was sent and when it arrived, on one clock; None: it was lost."""
    is_timed: bool
    """Whether the delays count."""


def packets_in(carry: Carry) -> list[Sent]:
    """The messages of each direction of a simulated carry."""
    found: dict[tuple[str, str], list[tuple[float, float | None]]] = {}
    for one in carry.message_log:
        found.setdefault((one.sender, one.receiver), []).append((one.sent_s, one.received_s))
    return [Sent(one, is_timed=True) for one in found.values()]


def packets_between(logs: Sequence[RunLog], clocks: Sequence[ClockFit]) -> list[Sent]:
    """All packets of each direction between programs that both have a log."""
    sent: dict[tuple[int, str, str], list[tuple[float, Stamp]]] = {}
    arrived: dict[Stamp, float] = {}
    for log, clock in zip(logs, clocks, strict=True):
        one = traffic(log)
        arrived |= {stamp: clock.to_reference(now) for stamp, now in one.received.items()}
        for stamp, now in one.sent.items():
            sent.setdefault((clock.run, *stamp[:2]), []).append((clock.to_reference(now), stamp))
    return [
        Sent(
            [(now, arrived.get(stamp)) for now, stamp in sorted(one)],
            # The station has a longer period than the robots, so its times are less exact.
            is_timed={*link[1:]} == {*SIDES},
        )
        for link, one in sent.items()
    ]


def _packets(source: Source, sent: Sent, period_s: float) -> Packets | None:
    """One direction as a recording; None: too few arrived.

    A packet is noticed at the end of a control period. Delays that differ are spread evenly over
    that period, so each may be too short; delays that do not may be too long.
    """
    arrived = sorted(
        (at, index, round(at - now, _DIGITS))
        for index, (now, at) in enumerate(sent.times_s)
        if at is not None
    )
    if len(arrived) < LEAST_ARRIVED:
        return None
    _, index, delays = (np.array(column) for column in zip(*arrived, strict=True))
    short, usual, long = np.quantile(np.diff([now for now, _ in sent.times_s]), (0.1, 0.5, 0.9))
    interval_s = float(usual) if long < _IRREGULAR * short else None
    differ = bool(np.ptp(delays) > 0)
    if not sent.is_timed:
        delays = np.zeros(0)
    elif differ:
        order = np.argsort(np.random.default_rng(0).random(len(delays)))
        delays = delays - period_s * (order + 0.5) / len(delays)
    found = packets_of(source, index.astype(np.int64), interval_s, delays, "one-way delay")
    return replace(found, too_long_s=0.0 if differ else period_s, too_short_s=period_s * differ)
