# SPDX-License-Identifier: Apache-2.0
"""How fast palms turn, and where their switches change, from logs of carries."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.confidence_intervals import Z95, student_t95
from palmbots.fitting.fitted_values import Estimate
from palmbots.simulation.result import Carry

Floats = NDArray[np.float64]

_LEAST_TICKS = 4  # of a turn, of which the first and the last tick are partial
_LEAST_DEG_S = 0.1
_NO_TURN = "no palm turned for long enough"
_NO_EDGE = "no contact passed an edge of the zone in which the sensor reads 0"


@dataclass(frozen=True)
class Readings:
    """What the logs of a carry show of both palms."""

    rates_deg_s: tuple[Floats, Floats]
    """Of each turn, left and right."""
    contacts_m: Floats
    """Contact coordinates at which a sensor was read."""
    signs: NDArray[np.int64]
    """What it read there."""


def readings_of(carry: Carry) -> Readings:
    """Of one carry."""
    trace = carry.trace
    assert trace is not None
    palms, contacts, signs = (
        trace[name].transpose("time", "side").to_numpy() for name in ("palm", "contact", "sign")
    )
    rates = np.degrees(np.diff(palms, axis=0)) / carry.scene.control.period_s
    is_known = np.isfinite(contacts)
    return Readings(
        (_turns(rates[:, 0]), _turns(rates[:, 1])),
        contacts[is_known],
        signs[is_known].astype(np.int64),
    )


def _turns(rates: Floats) -> Floats:
    """The rate of each turn, from its whole ticks: those faster than half of the fastest one."""
    fast = np.abs(rates) > max(0.5 * float(np.abs(rates).max()), _LEAST_DEG_S)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fast, [False]])))
    return np.array(
        [
            float(np.median(np.abs(rates[first + 1 : after - 1])))
            for first, after in edges.reshape(-1, 2)
            if after - first >= _LEAST_TICKS
        ]
    )


def palm_estimates(readings: Sequence[Readings]) -> list[Estimate]:
    """The rate of each palm, and the zone of the sensors."""
    found = []
    for number, side in enumerate(SIDES):
        rates = np.concatenate([one.rates_deg_s[number] for one in readings])
        key = f"palm.{side}.rate_deg_s"
        if len(rates) < 2:
            found.append(Estimate(key, reason=_NO_TURN))
            continue
        mean = float(rates.mean())
        half = student_t95(len(rates) - 1) * float(rates.std(ddof=1)) / math.sqrt(len(rates))
        found.append(Estimate(key, mean, mean - half, mean + half))
    places = np.abs(np.concatenate([one.contacts_m for one in readings]))
    beyond = np.concatenate([one.signs for one in readings]) != 0
    return [*found, _half_width(places, beyond)]


def _half_width(places: Floats, beyond: NDArray[np.bool_]) -> Estimate:
    """Where a sensor ceases to read 0: the place that the fewest readings contradict.

    False readings are independent, so the interval contains the places that few more readings
    contradict than the best one (the likelihood ratio).
    """
    key = "tactile.zero_half_width_m"
    if not len(beyond):
        return Estimate(key, reason="the logs do not show where the contacts are")
    if not beyond.any() or beyond.all():
        return Estimate(key, reason=_NO_EDGE)
    order = np.argsort(places, kind="stable")
    places, beyond = places[order], beyond[order]
    # Of a width above the first k places: readings within it that are not 0, and those beyond it
    # that are.
    against = np.concatenate([[0], np.cumsum(beyond)]) + (
        np.count_nonzero(~beyond) - np.concatenate([[0], np.cumsum(~beyond)])
    )
    fewest = int(against.min())
    rate = fewest / len(places)
    more = 0.5 * Z95**2 / math.log((1 - rate) / rate) if 0 < rate < 0.5 else 0.0
    kept = np.flatnonzero(against <= fewest + more)
    best = np.flatnonzero(against == fewest)
    ends = np.concatenate([[0.0], places, [places[-1]]])
    value = 0.5 * float(ends[best[0]] + ends[best[-1] + 1])
    return Estimate(key, value, float(ends[kept[0]]), float(ends[kept[-1] + 1]))
