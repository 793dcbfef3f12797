# SPDX-License-Identifier: Apache-2.0
"""Recordings of packets: which arrived, and how late.

A row is a packet that arrived, in the order of arrival. Its *index* is its number among those sent.
A delay of one way is relative to the fastest packet: the clocks of sender and receiver have a line
between them, and the line is the highest one below all times of arrival with the least sum of
distances (Moon, Skelly, Towsley 1999). It is a segment of the lower convex hull.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import Source
from palmbots.scene.recorded_tables import Recording, read_recording

Floats = NDArray[np.float64]

DelayKind = Literal["round trip", "one-way delay", "delay behind the fastest"]
"""What delays are. Those of one way need a common clock, otherwise only differences are known."""

COLUMNS = ("index", "time_s", "sent_s", "round_trip_s")
_RESTART = 1000  # a greater fall of the index is no reordering
_LONGEST_S = 2.0  # a longer median delay is in another unit, or a clock jumped
_MOST_LOST = 20.0  # packets for each that arrived
_IRREGULAR = 5.0  # a median delay of more intervals than this: the sender paused


@dataclass(frozen=True)
class Packets:
    """One run."""

    source: Source
    gaps: NDArray[np.int64]
    """Numbers of packets lost between packets that arrived, in the order of sending; empty: the
    packets have no indices."""
    received: int
    duplicates: int
    reordered: int
    """Packets that arrived after one that was sent later."""
    interval_s: float | None
    """Median between packets."""
    delays_s: Floats
    """Empty: unknown."""
    delay_kind: DelayKind
    why_no_delays: str
    fates_s: Floats
    """The delay of each packet in the order of sending, −1 if it was lost; empty: unknown."""
    too_long_s: float = 0.0
    too_short_s: float = 0.0
    """By how much each delay may be too long or too short, because of the receiver's ticks."""


def read_packets(path: str | os.PathLike[str]) -> Packets:
    """Read one run.

    Raises:
        PalmbotsError: it cannot be read, or is no such recording.
    """
    table = read_recording(path, COLUMNS, 1, instead="round_trip_s")
    source = Source(table.name, table.sha256)
    trips = table.columns.get("round_trip_s", np.zeros(0))
    if trips.size:
        _check_trips(table.name, trips)
    if "index" not in table:
        none = np.zeros(0, np.int64)
        return Packets(source, none, len(trips), 0, 0, None, trips, "round trip", "", trips)
    index = _whole(table)
    spacing = int(np.gcd.reduce(np.diff(np.unique(index))))
    if spacing > 1:
        raise PalmbotsError(
            f"{table.name}: the index grows by multiples of {spacing}; expected the number of the "
            "packet, which grows by 1 for each packet sent"
        )
    interval_s, delays, why = None, trips, ""
    if "time_s" in table:
        interval_s = interval_of(index, table.times_s)
    if not trips.size:
        delays, why = _one_way(table, index, interval_s)
    kind: DelayKind = "round trip" if trips.size else "delay behind the fastest"
    return packets_of(source, index, interval_s, delays, kind, why)


def interval_of(index: NDArray[np.int64], arrived_s: Floats) -> float:
    """The median time between packets."""
    slope = np.polyfit(index.astype(float), arrived_s, 1)[0]
    once = np.sort(np.unique(index, return_index=True)[1])
    steps = np.diff(arrived_s[once]) / np.maximum(1, np.abs(np.diff(index[once])))
    return float(np.median(steps)) or float(abs(slope))


def packets_of(
    source: Source,
    index: NDArray[np.int64],
    interval_s: float | None,
    delays_s: Floats,
    delay_kind: DelayKind,
    why_no_delays: str = "",
) -> Packets:
    """One run.

    Args:
        source: its file.
        index: numbers of the packets, in the order of arrival.
        interval_s: median between packets.
        delays_s: of the packets, or empty.
        delay_kind: what they are.
        why_no_delays: why there are none.
    """
    highest = np.maximum.accumulate(index)
    ordered, first = np.unique(index, return_index=True)
    late = np.zeros(len(index), bool)
    late[first] = True
    return Packets(
        source=source,
        gaps=np.diff(ordered) - 1,
        received=len(ordered),
        duplicates=len(index) - len(ordered),
        reordered=int(np.sum(late & (index < highest))),
        interval_s=interval_s,
        delays_s=delays_s,
        delay_kind=delay_kind,
        why_no_delays=why_no_delays,
        fates_s=fates_of(index, delays_s),
    )


def _check_trips(name: str, trips: Floats) -> None:
    if trips.min() <= 0:
        raise PalmbotsError(f"{name}: round_trip_s is {trips.min():.4g}; expected above 0")
    usual = float(np.median(trips))
    if usual > _LONGEST_S:
        raise PalmbotsError(
            f"{name}: round_trip_s is {usual:.4g} in the median; expected s, and at most "
            f"{_LONGEST_S:g}"
        )


def _whole(table: Recording) -> NDArray[np.int64]:
    values = table["index"]
    odd = np.flatnonzero((values != np.round(values)) | (np.abs(values) > 2**52))
    if odd.size:
        row = int(odd[0])
        raise PalmbotsError(
            f"{table.name}: index is {values[row]:.10g} in row {row + 1}; expected whole numbers"
        )
    index = values.astype(np.int64)
    falls = np.flatnonzero(np.diff(index) < -_RESTART)
    if falls.size:
        row = int(falls[0])
        raise PalmbotsError(
            f"{table.name}: the index falls from {index[row]} to {index[row + 1]} in row "
            f"{row + 2}; expected one run of packets in a file"
        )
    if len(np.unique(index)) < 2:
        raise PalmbotsError(f"{table.name}: the index is constant; expected one for each packet")
    falling = int(np.sum(np.diff(index) < 0))
    if 2 * falling > len(index):
        raise PalmbotsError(
            f"{table.name}: the index falls in {falling} of {len(index)} rows; expected the number "
            "of the packet, which grows by 1 for each packet sent"
        )
    return index


def _one_way(
    table: Recording, index: NDArray[np.int64], interval_s: float | None
) -> tuple[Floats, str]:
    """Delays relative to the fastest packet, or why there are none."""
    if interval_s is None:
        return np.zeros(0), "the file has no time_s"
    sent = table["sent_s"] if "sent_s" in table else index.astype(float)
    if np.ptp(sent) == 0:
        raise PalmbotsError(f"{table.name}: sent_s is constant; expected when each packet was sent")
    delays = above_line(sent, table.times_s)
    usual = float(np.median(delays))
    if "sent_s" not in table and usual > _IRREGULAR * interval_s:
        return np.zeros(0), (
            f"the packets were not sent regularly: the median is {usual:.2g} s behind the fastest; "
            "record sent_s"
        )
    if usual > _LONGEST_S:
        raise PalmbotsError(
            f"{table.name}: packets arrive {usual:.3g} s later than the fastest in the median; "
            f"expected at most {_LONGEST_S:g} s, and clocks that do not jump"
        )
    return delays, ""


def fates_of(index: NDArray[np.int64], delays_s: Floats) -> Floats:
    """What became of each packet, in the order of sending: its delay [s], or −1 if it was lost.
    Empty: too many numbers are missing to be losses, or delays do not belong to packets.

    Args:
        index: of the packets that arrived.
        delays_s: theirs, or empty.
    """
    ordered, first = np.unique(index, return_index=True)
    size = int(ordered[-1] - ordered[0]) + 1
    if size > _MOST_LOST * len(ordered) or delays_s.size not in (0, len(index)):
        return np.zeros(0)
    fates = np.full(size, -1.0)
    fates[ordered - ordered[0]] = delays_s[first] if delays_s.size else 0.0
    return fates


def above_line(x: Floats, y: Floats) -> Floats:
    """Distances above the line below all points with the least sum of distances."""
    order = np.lexsort((y, x))
    hull: list[int] = []
    for place in order:
        if hull and x[place] == x[hull[-1]]:
            continue
        while len(hull) > 1:
            a, b = hull[-2], hull[-1]
            if (y[b] - y[a]) * (x[place] - x[a]) < (y[place] - y[a]) * (x[b] - x[a]):
                break
            hull.pop()
        hull.append(int(place))
    corners = x[hull]
    at = int(np.clip(np.searchsorted(corners, x.mean()), 1, len(hull) - 1))
    a, b = hull[at - 1], hull[at]
    slope = (y[b] - y[a]) / (x[b] - x[a])
    return np.maximum(0.0, y - y[a] - slope * (x - x[a]))
