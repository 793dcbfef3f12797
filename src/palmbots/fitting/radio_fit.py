# SPDX-License-Identifier: Apache-2.0
"""A radio, fitted to recordings of the packets that arrived (`fit_radio`)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95, clopper_pearson, student_t95
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import (
    LEAST_RUNS,
    Estimate,
    FittedPart,
    Source,
    refuse_twice,
)
from palmbots.fitting.loss_likelihood import LossFit
from palmbots.fitting.recorded_packets import DelayKind, Packets, read_packets
from palmbots.fitting.replay_files import fate_replay

Floats = NDArray[np.float64]

_PIECES = 20  # of each run, if there are fewer runs than `LEAST_RUNS`
_DRAWS = 1000
_LEAST_GAIN = 3.0
"""By less, bursts do not raise the log-likelihood clearly: half the 95 % quantile of χ² with two
degrees of freedom. At the end of a range the true quantile is below it."""
_LEAST_BEYOND = 5  # packets beyond a quantile
_QUANTILES = (("median", 0.5), ("p99", 0.99), ("p99.9", 0.999))


@dataclass(frozen=True)
class PacketData:
    """What the figure shows."""

    burst_packets: Floats
    """Numbers of packets lost together, from 1."""
    bursts: Floats
    """How many bursts had at least so many."""
    fitted: Floats
    """The same, expected by the fit."""
    independent: Floats
    """The same, expected if each packet were lost independently."""
    delays_s: Floats
    """Delays at the probabilities `shares`: round trips, or one way relative to the fastest."""
    shares: Floats
    model_s: Floats
    """The same of a simulated radio with the fitted keys."""


@dataclass(frozen=True, repr=False)
class RadioFit(FittedPart, Result):
    """Losses and delays of a radio, with 95 % intervals, and what they were fitted to."""

    figure = "radio-fit"
    name = "radio"

    runs: int
    received: int
    lost: int
    """Packets that were lost between two that arrived."""
    bursts: int
    """Groups of successive packets that were lost."""
    burst_packets: float
    """Mean number of packets in such a group; 0: none was lost."""
    expected_burst_packets: float
    """The same if each packet were lost independently, with the same overall probability."""
    duplicates: int
    reordered: int
    """Packets that arrived after a packet that was sent later."""
    delay_kind: DelayKind
    """What the delays are."""
    data: PacketData = field(metadata=NOT_IN_JSON)

    def basis(self) -> str:
        """What the keys were fitted to, as a part of a sentence."""
        return f"to {self.received:,} packets of {plural(self.runs, 'run')}"

    def rows(self) -> list[tuple[str, str]]:
        """What else the report has of the data: names and values."""
        bursts = [
            ("mean length of a burst", f"{self.burst_packets:.3g} packets"),
            ("if losses were independent", f"{self.expected_burst_packets:.3g} packets"),
        ]
        return [
            ("packets lost", f"{self.lost:,}"),
            *(bursts if self.lost else ()),
            ("duplicates", f"{self.duplicates:,}"),
            ("arrived after a later one", f"{self.reordered:,}"),
        ]


def fit_radio(
    files: Sequence[str | os.PathLike[str]], on_progress: Callable[[float], None] | None = None
) -> RadioFit:
    """Fit losses and delays of a radio.

    Args:
        files: of each run the packets that arrived.
        on_progress: called with the completed fraction.

    Raises:
        PalmbotsError: a file cannot be read, or they do not belong together.
    """
    if not files:
        raise PalmbotsError("--radio: 0 files; expected one for each run")
    report = on_progress or (lambda fraction: None)
    runs: list[Packets] = []
    for number, file in enumerate(files):
        report(0.7 * number / len(files))
        runs.append(read_packets(file))
    refuse_twice(one.source for one in runs)
    for one in runs:
        if one.delay_kind != runs[0].delay_kind:
            raise PalmbotsError(
                f"{one.source.name}: has {'' if one.delay_kind == 'round trip' else 'no '}"
                f"round_trip_s, unlike {runs[0].source.name}; expected the same columns in all runs"
            )
        if bool(one.gaps.size) != bool(runs[0].gaps.size):
            raise PalmbotsError(
                f"{one.source.name}: has {'an' if one.gaps.size else 'no'} index, unlike "
                f"{runs[0].source.name}; expected the same columns in all runs"
            )
    report(0.7)
    return fit_packets(runs)


def fit_packets(runs: Sequence[Packets], sources: Sequence[Source] = ()) -> RadioFit:
    """Fit losses and delays to runs with the same kind of delays.

    Args:
        runs: recordings.
        sources: their files, if these are not one for each run.
    """
    gaps = np.concatenate([one.gaps for one in runs])
    lost, bursts = int(gaps.sum()), int((gaps > 0).sum())
    counts, times = np.unique(gaps, return_counts=True)
    counts, times = counts.astype(float), times.astype(float)
    losses = LossFit(counts, times) if gaps.size else None
    estimates, fate = _losses(runs, gaps, losses)
    of_delays, model = _delays(runs)
    duplicates = sum(one.duplicates for one in runs)
    reordered = sum(one.reordered for one in runs)
    received = sum(one.received for one in runs)
    estimates = [*estimates, *_copies(received, duplicates, reordered, bool(gaps.size))]
    order = {"latency_s": 0, "jitter_s": 1, "reorder": 2}
    keys = [one for one in (*of_delays, *estimates) if one.is_key]
    keys.sort(key=lambda one: order.get(one.key.rpartition(".")[2], len(order)))
    delays = np.concatenate([one.delays_s for one in runs])
    return RadioFit(
        sources=tuple(sources or (one.source for one in runs)),
        runs=len(runs),
        received=received,
        lost=lost,
        bursts=bursts,
        burst_packets=lost / bursts if bursts else 0.0,
        expected_burst_packets=0.0 if losses is None else 1 / (1 - losses.rate),
        duplicates=duplicates,
        reordered=reordered,
        delay_kind=runs[0].delay_kind,
        estimates=(*keys, *(one for one in (*estimates, *of_delays) if not one.is_key)),
        data=_shown_data(gaps, losses, fate, delays, model),
        replay=fate_replay(runs),
    )


def _parts(runs: Sequence[Packets], of: Callable[[Packets], Floats]) -> list[Floats]:
    """What the bootstrap draws: runs, or pieces of them."""
    whole = [part for part in map(of, runs) if part.size]
    if len(whole) >= LEAST_RUNS:
        return whole
    return [part for one in whole for part in np.array_split(one, _PIECES) if part.size]


def _draws(parts: int) -> NDArray[np.int64]:
    return np.random.default_rng(0).multinomial(parts, np.full(parts, 1 / parts), size=_DRAWS)


def _losses(
    runs: Sequence[Packets], gaps: NDArray[np.int64], losses: LossFit | None
) -> tuple[list[Estimate], Floats]:
    """Loss and bursts, and the fitted parameters (ℓ, s, m in intervals)."""
    names = ("radio.loss", "radio.burst_fraction", "radio.burst_s")
    if losses is None:
        reason = "the packets have no index"
        return [Estimate(key, reason=reason) for key in names], np.zeros(3)
    parts = _parts(runs, lambda one: one.gaps.astype(float))
    sums = np.array([(part.sum(), len(part)) for part in parts]).T
    draws = _draws(len(parts))
    lost, kept = draws @ sums[0], draws @ sums[1]
    wide = np.quantile(lost / (lost + kept), (0.025, 0.975))
    if losses.gain < _LEAST_GAIN:
        total = int(gaps.sum())
        low, high = clopper_pearson(total, total + len(gaps))
        given = Estimate(names[0], losses.rate, min(low, wide[0]), max(high, wide[1]))
        reason = (
            "no packet was lost"
            if total == 0
            else "packets are lost as if each were lost independently"
        )
        others = [Estimate(key, reason=reason) for key in names[1:]]
        fate = np.array([losses.rate, 0.0, 1.0])
        return [given, *others, replace(given, key="packets_lost")], fate
    (loss, share, length) = losses.values()
    fate = np.array([loss[0], share[0], length[0]])
    # The total varies between the parts by more than the model says: what the bootstrap adds to the
    # interval of all losses is added to that of both kinds.
    factor = np.array(wide) / losses.rate
    rows = [
        Estimate(key, value, float(low * min(1, factor[0])), float(high * max(1, factor[1])))
        for key, (value, low, high) in zip(names[:2], (loss, share), strict=True)
    ]
    known = [one.interval_s for one in runs if one.interval_s is not None]
    if len(known) < len(runs):
        reason = (
            "packets were sent irregularly, or the file has no time_s: the periods last "
            f"{length[0]:.3g} packets ({length[1]:.3g} to {length[2]:.3g})"
        )
        rows.append(Estimate(names[2], reason=reason))
        return [*rows, _all_losses(losses.rate, wide)], fate
    interval_s = float(np.median(known))
    value, low, high = (interval_s * one for one in length)
    rows.append(Estimate(names[2], value, low, high))
    return [*rows, _all_losses(losses.rate, wide)], fate


def _all_losses(rate: float, wide: Floats) -> Estimate:
    return Estimate("packets_lost", rate, float(wide[0]), float(wide[1]))


def _copies(received: int, duplicates: int, reordered: int, has_index: bool) -> list[Estimate]:
    if not has_index:
        reason = "the packets have no index"
        return [Estimate(key, reason=reason) for key in ("radio.duplicate", "radio.reorder")]
    low, high = clopper_pearson(duplicates, received)
    return [
        Estimate("radio.duplicate", duplicates / received, low, high),
        Estimate("radio.reorder", reordered > 0),
    ]


def _delays(runs: Sequence[Packets]) -> tuple[list[Estimate], Callable[[Floats], Floats] | None]:
    """Latency, jitter and quantiles of the delay, and the quantiles of the model."""
    latency, jitter = "radio.latency_s", "radio.jitter_s"
    kind = runs[0].delay_kind
    why = next((one.why_no_delays for one in runs if one.why_no_delays), "")
    if why:
        rest = [Estimate("delay", reason=why)]
        return [*(Estimate(key, reason=why) for key in (latency, jitter)), *rest], None
    parts = _parts(runs, lambda one: one.delays_s)
    everything = np.concatenate(parts)
    ways = 2 if kind == "round trip" else 1
    least, middle = float(everything.min()), float(np.median(everything))
    # The median of a uniform delay is half its width, that of the sum of two is one width. Tails,
    # which the model has not, change a median little.
    width = 2 * (middle - least) / ways
    # In each draw: the least delay and the quantiles of the parts that were drawn.
    order = np.argsort(everything)
    owner = np.repeat(np.arange(len(parts)), [len(part) for part in parts])[order]
    ordered = everything[order]
    drawn = []
    for weights in _draws(len(parts)):
        mass = np.cumsum(weights[owner])
        places = np.searchsorted(mass, [0.5, *(mass[-1] * q for _, q in _QUANTILES)])
        drawn.append(ordered[np.minimum(places, len(ordered) - 1)])
    spread = np.array(drawn)
    ends = np.quantile(spread, (0.025, 0.975), axis=0).T
    # Quantiles of a bootstrap over few parts are as narrow as those of a normal distribution.
    count = len(parts)
    grown = student_t95(count - 1) / Z95 * math.sqrt(count / (count - 1))
    of_jitter = np.quantile(2 * (spread[:, 1] - spread[:, 0]), (0.025, 0.975))
    of_jitter = ways * width + grown * (of_jitter - ways * width)
    # No packet has the least delay of the model, so the latency is below the least one that was
    # seen, with 95 % by at most this.
    share = -math.expm1(math.log(0.05) / len(everything))
    below = width * (share if ways == 1 else math.sqrt(2 * share))
    too_long, too_short = (
        max(getattr(one, name) for one in runs) for name in ("too_long_s", "too_short_s")
    )
    low, high = least - below - too_long, float(ends[0, 1]) + too_short
    shortest = max(0.0, float(of_jitter[0]) - 2 * too_short)
    longest = float(of_jitter[1]) + 2 * below + too_long
    found = [
        Estimate(latency, least / ways, low / ways, high / ways)
        if kind != "delay behind the fastest"
        else Estimate(latency, reason="times of one way do not show it without a common clock"),
        Estimate(jitter, width, shortest / ways, longest / ways),
    ]
    called = kind.replace("the ", "").replace(" ", "_").replace("-", "_")
    for column, (name, q) in enumerate(_QUANTILES, 1):
        beyond = (1 - q) * len(everything)
        key = f"{called}_{name}_s".replace(".", "_")
        if beyond < _LEAST_BEYOND:
            need = round(_LEAST_BEYOND / (1 - q))
            reason = f"needs {need:,} packets; there are {len(everything):,}"
            found.append(Estimate(key, reason=reason))
        else:
            value = float(np.quantile(everything, q))
            low, high = value + grown * (ends[column] - value)
            found.append(Estimate(key, value, min(value, low), max(value, high)))

    def model(shares: Floats) -> Floats:
        if ways == 1:
            return (least if kind == "one-way delay" else 0.0) + width * shares
        half = np.minimum(shares, 1 - shares)  # the sum of two uniform delays
        side = width * np.sqrt(2 * half)
        return least + np.where(shares < 0.5, side, 2 * width - side)

    return found, model


def _shown_data(
    gaps: NDArray[np.int64],
    losses: LossFit | None,
    fate: Floats,
    delays: Floats,
    model: Callable[[Floats], Floats] | None,
) -> PacketData:
    none = np.zeros(0)
    sizes = bursts = fitted = independent = none
    if losses is not None and gaps.any():
        most = min(int(gaps.max()), 1000)
        sizes = np.unique(np.geomspace(1, most + 1, 60).round())
        bursts = np.array([(gaps >= size).sum() for size in sizes], float)
        fitted = len(gaps) * _at_least(sizes, *fate)
        independent = len(gaps) * losses.rate**sizes
    shares = 1 - np.geomspace(1, 1 / max(len(delays), 2), 200) + 1e-12
    at = np.quantile(delays, np.clip(shares, 0, 1)) if model is not None else none
    return PacketData(
        sizes, bursts, fitted, independent, at, shares if model is not None else none,
        none if model is None else model(shares),
    )  # fmt: skip


def _at_least(sizes: Floats, loss: float, share: float, length: float) -> Floats:
    """The probability that at least so many packets are lost after one that arrived."""
    kept = np.exp(-1 / (length * (1 - share)))
    state, found = np.array([1.0, 0.0]), []
    moves = np.array(
        [
            [1 - share * (1 - kept), share * (1 - kept)],
            [(1 - share) * (1 - kept), 1 - (1 - share) * (1 - kept)],
        ]
    )
    for _ in range(int(sizes.max())):
        state = state @ moves * np.array([loss, 1.0])
        found.append(state.sum())
    return np.array(found)[sizes.astype(int) - 1]
