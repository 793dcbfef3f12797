# SPDX-License-Identifier: Apache-2.0
"""The variables of a study: what is stored of every carry, and which statistics a cell has.

One row describes a variable completely: name, unit, meaning, data type, how it is reduced to
statistics of a cell, and how these are shown. All other modules of the room, the report and the
figures iterate over the rows, so a new variable or statistic is one new row.

A column of a variable has the shape [points, controllers, seeds], or [points, controllers, seeds,
side] for a variable that each robot has. Where there is no result, `outcome` is `NOT_CARRIED` or
`MISSING`, and every other variable has its own value for "missing".
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from palmbots.simulation import batch
from palmbots.simulation.batch import DELIVERED, DROPPED, STALLED

Columns = Mapping[str, NDArray[Any]]
"""Columns of results by the name of their variable."""

NOT_CARRIED = 0
"""`outcome` of a carry that the study leaves out: its cell was refused or stopped early."""
MISSING = 255
"""`outcome` and `reason` of a carry that has no result: it was not carried yet, or its file is
lost. Zarr returns this value for a chunk that has no file."""


def _codes(first: str, names: Sequence[str | None]) -> Mapping[str, int]:
    """The number of each name; `first` is what the core's number 0 means in a study."""
    codes = {name: code for code, name in enumerate(names) if code and name}
    return {first: 0, **codes, "missing": MISSING}


OUTCOMES = _codes("not carried", batch.OUTCOMES)
REASONS = _codes("none", batch.REASONS)

EVENTS: Mapping[str, tuple[int, ...]] = {
    "carried": (DELIVERED, DROPPED, STALLED),
    "delivered": (DELIVERED,),
    "dropped": (DROPPED,),
    "stalled": (STALLED,),
}
"""Sets of outcomes that are counted, by name."""

Reduction = Literal["count", "rate", "mean", "root_mean", "rate_difference", "mean_difference"]
"""How the carries of a cell become one number.

count, rate: number of carries with an event, or its share of all carries. mean, root_mean: mean of
`Statistic.value`, or the root of that mean. rate_difference, mean_difference: the same less that
of the first controller, over the carries that both have.
"""


@dataclass(frozen=True)
class Display:
    """How a statistic is shown to people."""

    heading: str
    """Of its column in the report."""
    unit: str
    """After a number, with a leading space."""
    scale: float
    """Factor from the statistic's own unit to this one."""
    title: str = ""
    """Of its panel in a figure. Empty: figures do not draw it."""
    is_signed: bool = False
    """Whether positive numbers have a plus sign."""


@dataclass(frozen=True)
class Statistic:
    """One number of a cell, with its 95 % interval."""

    name: str
    unit: str
    meaning: str
    reduction: Reduction
    event: str = "carried"
    """The carries that are counted, or over which `value` is averaged: a key of `EVENTS`."""
    value: Callable[[Columns], NDArray[np.float64]] | None = None
    """A number of every carry [points, controllers, seeds]; for means only."""
    display: Display | None = None
    """None: the statistic is stored but not part of the report."""

    @property
    def has_interval(self) -> bool:
        """Whether the statistic has an interval."""
        return self.reduction != "count"

    @property
    def is_difference(self) -> bool:
        """Whether it compares a controller with the first one of the study."""
        return self.reduction.endswith("_difference")


@dataclass(frozen=True)
class Variable:
    """One result of every carry, as it is stored."""

    name: str
    dtype: str
    unit: str
    meaning: str
    missing: float
    """The stored value where a carry has no result."""
    by_side: bool = False
    """Whether each robot has its own value."""
    codes: Mapping[str, int] | None = None
    """The values that the variable may have, by their meaning; None: it is a number."""
    statistics: tuple[Statistic, ...] = ()

    def shape(self, carries: tuple[int, ...]) -> tuple[int, ...]:
        """The shape of the column for an array of carries."""
        return (*carries, 2) if self.by_side else carries

    def is_missing(self, column: NDArray[Any]) -> NDArray[np.bool_]:
        """Where a column has no value."""
        return np.isnan(column) if np.isnan(self.missing) else column == self.missing

    @property
    def long_name(self) -> str:
        """The meaning as an attribute of the stored array; codes are spelt out."""
        if self.codes is None:
            return self.meaning
        return ", ".join(f"{code} {name}" for name, code in self.codes.items())


def is_carried(outcome: NDArray[Any]) -> NDArray[np.bool_]:
    """Where a column of outcomes holds the result of a carry."""
    return (outcome != NOT_CARRIED) & (outcome != MISSING)


def _mean_square(columns: Columns) -> NDArray[np.float64]:
    rms = columns["contact_rms_m"].astype(np.float64)
    return np.mean(rms * rms, axis=-1)


def _larger(name: str) -> Callable[[Columns], NDArray[np.float64]]:
    return lambda columns: columns[name].max(axis=-1).astype(np.float64)


def _both(name: str) -> Callable[[Columns], NDArray[np.float64]]:
    return lambda columns: columns[name].astype(np.float64).sum(axis=-1)


def _number(name: str) -> Callable[[Columns], NDArray[np.float64]]:
    return lambda columns: columns[name].astype(np.float64)


_NO_COUNT = 2**32 - 1

_ROWS = (
    Variable(
        "outcome", "u1", "1", "how the carry ended", MISSING, codes=OUTCOMES,
        statistics=(
            Statistic("carries", "1", "number of carries", "count"),
            Statistic(
                "drop_rate", "1", "share of carries that dropped the object", "rate", "dropped",
                display=Display("dropped", " %", 100, title="drop rate"),
            ),
            Statistic(
                "stall_rate", "1", "share of carries that neither arrived nor dropped in time",
                "rate", "stalled",
            ),
            Statistic(
                "drop_rate_difference", "1",
                "drop rate less that of the first controller, over the same scenes and seeds",
                "rate_difference", "dropped",
                display=Display("dropped more than {first}", " %", 100, is_signed=True),
            ),
        ),
    ),
    Variable("reason", "u1", "1", "why the object was dropped", MISSING, codes=REASONS),
    Variable(
        "time_s", "<f8", "s", "time at which the carry ended", np.nan,
        statistics=(
            Statistic(
                "mean_time_s", "s", "mean time of the delivered carries", "mean", "delivered",
                value=_number("time_s"),
            ),
        ),
    ),
    Variable(
        "contact_rms_m", "<f4", "m", "root mean square of the contact coordinate", np.nan,
        by_side=True,
        statistics=(
            Statistic(
                "rms_m", "m", "root mean square of both contact coordinates over all carries",
                "root_mean", value=_mean_square,
                display=Display("contact rms", " mm", 1e3, title="contact rms"),
            ),
            Statistic(
                "square_difference", "m2",
                "mean square of the contact coordinates less that of the first controller, over "
                "the same scenes and seeds",
                "mean_difference", value=_mean_square,
            ),
        ),
    ),
    Variable(
        "contact_peak_m", "<f4", "m", "largest absolute contact coordinate", np.nan, by_side=True,
        statistics=(
            Statistic(
                "mean_peak_m", "m", "mean of the larger peak of the two contacts", "mean",
                value=_larger("contact_peak_m"),
            ),
        ),
    ),
    Variable(
        "waiting_s", "<f4", "s", "time that a robot waited for messages", np.nan, by_side=True,
        statistics=(
            Statistic(
                "mean_waiting_s", "s", "mean time waited for messages, both robots together",
                "mean", value=_both("waiting_s"),
            ),
        ),
    ),
    Variable(
        "corrections", "<u4", "1", "number of corrections", _NO_COUNT,
        statistics=(
            Statistic(
                "mean_corrections", "1", "mean number of corrections", "mean",
                value=_number("corrections"),
            ),
        ),
    ),
    Variable(
        "messages", "<u4", "1", "number of messages sent", _NO_COUNT,
        statistics=(
            Statistic(
                "mean_messages", "1", "mean number of messages sent", "mean",
                value=_number("messages"),
            ),
        ),
    ),
)  # fmt: skip

VARIABLES: Mapping[str, Variable] = {row.name: row for row in _ROWS}
"""The variables by name, in the order in which the hash of all results takes them."""

STATISTICS: Mapping[str, Statistic] = {
    statistic.name: statistic for row in _ROWS for statistic in row.statistics
}
"""The statistics of a cell by name."""
