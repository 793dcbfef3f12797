# SPDX-License-Identifier: Apache-2.0
"""Controllers compared over a swept scene key, with the same seeds (section 5.3 of the paper)."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palmbots._types import Interval, MaybeNaN, Overrides
from palmbots._util.arguments import seed_of, show
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import Z95, rate_interval, rate_text
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Table, quiet, unit_of
from palmbots._util.results import Result
from palmbots._util.text import format_number, plural
from palmbots.control.registry import ControllerLike, resolve, shipped_names
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.variations import have_equal_carries, with_values, without_effect
from palmbots.simulation.batch import DELIVERED, DROPPED
from palmbots.simulation.outcome_counts import carry_seeds
from palmbots.simulation.prepare import Prepared, check_precision, prepare
from palmbots.simulation.worlds import DEFAULT_WORLD, world_entry
from palmbots.wire import PACKET_SIZE

if TYPE_CHECKING:
    import xarray as xr

_RADIO_BITS_S = 250_000  # of a small packet radio, for example IEEE 802.15.4
_LONGEST_HEAD = 17
DEFAULT_SWEEP = "radio.latency_s"
DEFAULT_VALUES = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)


@dataclass(frozen=True, slots=True)
class Row:
    """One controller at one value of the swept key. Intervals are 95 %; with a single carry those
    of means are NaN."""

    controller: str
    key: str
    value: float
    n: int
    """Number of carries."""
    drop_rate: float
    interval: Interval
    """Wilson's; where none or all were dropped, the exact one-sided bound."""
    stall_rate: float
    stall_interval: Interval
    """As `interval`."""
    rms_m: float
    """Root mean square of both contact coordinates; of a dropped carry until the drop."""
    rms_interval_m: tuple[MaybeNaN, MaybeNaN]
    messages_per_m: MaybeNaN
    """Messages sent by all robots and the station."""
    messages_interval_per_m: tuple[MaybeNaN, MaybeNaN]
    bytes_per_s: MaybeNaN
    """The same as packets of 32 bytes; the data rate of a radio limits it."""
    corrections: float
    """Mean number of corrections per carry."""

    def cells(self) -> tuple[str, ...]:
        """Value, drop rate, contacts and messages, for people."""
        half = 0.5 * (self.rms_interval_m[1] - self.rms_interval_m[0])
        spread = "" if math.isnan(half) else f" ± {1e3 * half:.1f}"
        return (
            format_number(self.value),
            rate_text(round(self.drop_rate * self.n), self.n),
            f"{1e3 * self.rms_m:.1f}{spread}",
            f"{self.messages_per_m:.0f}",
            f"{self.bytes_per_s:.0f}",
        )


@dataclass(frozen=True, slots=True)
class Refusal:
    """A controller that refuses the scene at one value of the swept key, and why."""

    controller: str
    value: float
    reason: str


_COLUMNS = ("drop_rate", "stall_rate", "rms_m", "messages_per_m", "bytes_per_s", "corrections")
_INTERVALS = {
    "interval": "drop_rate_interval",
    "stall_interval": "stall_rate_interval",
    "rms_interval_m": "rms_interval_m",
    "messages_interval_per_m": "messages_interval_per_m",
}


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """Rows for every controller and value, with the same seeds throughout."""

    scene: Scene
    key: str
    seed: int
    world: str
    rows: tuple[Row, ...]
    refusals: tuple[Refusal, ...] = field(default=(), metadata=NOT_IN_JSON)
    """Controllers have no row where they refuse the scene."""

    figure = "sweep"

    @derived
    def refused(self) -> tuple[str, ...]:
        """The refusals as lines, ``KEY = VALUE: REASON``."""
        return tuple(f"{self.key} = {r.value:g}: {r.reason}" for r in self.refusals)

    def lines(self) -> Iterator[Item]:
        """One row for each controller and value, and what was refused."""
        rows = self.rows
        carries = plural(rows[0].n, "carry") if rows else "no carry"
        place = "" if self.world == DEFAULT_WORLD else f" in the {self.world} world"
        yield f"{carries} per value and controller{place}, seeds from {self.seed}; intervals: 95 %"
        section, _, name = self.key.rpartition(".")
        is_long = len(self.key) > _LONGEST_HEAD and section  # takes two lines
        key_head = f"{section}.\n{name}" if is_long else self.key
        heads = (key_head, "dropped", "contact\nrms [mm]", "messages\nper m", "B/s")
        cells = [("" if same else row.controller, *row.cells()) for same, row in _marked(rows)]
        yield Table(cells, ("controller", *heads), right=heads, gap=2)
        if stalled := sum(round(row.stall_rate * row.n) for row in rows):
            yield f"{plural(stalled, 'carry')} stalled: neither delivered nor dropped in time"
        busiest = max((row.bytes_per_s for row in rows), default=0.0)
        if busiest > 0:
            yield quiet(
                f"B/s: bytes on the air in packets of {PACKET_SIZE} bytes; at most "
                f"{8e2 * busiest / _RADIO_BITS_S:.1f} % of a {_RADIO_BITS_S // 1000} kbit/s radio"
            )
        yield from self.refusal_lines()

    def refusal_lines(self) -> list[str]:
        """One line for each reason of a refusal, with all values to which it applies.

        Reasons that differ only in their numbers count as one; the line quotes the first.
        """
        groups: dict[tuple[str, str], list[tuple[str, str]]] = defaultdict(list)
        for one in self.refusals:
            template = re.sub(r"[-+\d.e]+", "", one.reason)
            groups[one.controller, template].append((format_number(one.value), one.reason))
        lines = []
        for (controller, _), found in groups.items():
            values = ", ".join(value for value, _ in found)
            first_value, first = found[0]
            at_first = f"at {first_value}: " if len({reason for _, reason in found}) > 1 else ""
            lines.append(f"{controller} refuses {self.key} = {values}: {at_first}{first}")
        return lines

    def to_xarray(self) -> xr.Dataset:
        """The rows over the dimensions ``controller`` and ``value``; NaN where one was refused.

        Intervals have the further dimension ``end``, with the entries ``low`` and ``high``.
        """
        import xarray as xr

        carries = self.rows[0].n if self.rows else 0
        cells = [(r.controller, r.value) for r in (*self.rows, *self.refusals)]
        controllers = list(dict.fromkeys(name for name, _ in cells))
        values = sorted({value for _, value in cells})
        shape = (len(controllers), len(values))
        found = {(row.controller, row.value): row for row in self.rows}
        dims = ("controller", "value")

        def column(field: str, *more: int) -> NDArray[np.float64]:
            array = np.full((*shape, *more), np.nan)
            for (name, value), row in found.items():
                array[controllers.index(name), values.index(value)] = getattr(row, field)
            return array

        variables: dict[str, Any] = {
            name: (dims, column(name), {"units": unit_of(name)}) for name in _COLUMNS
        }
        variables |= {
            name: ((*dims, "end"), column(field, 2)) for field, name in _INTERVALS.items()
        }
        return xr.Dataset(
            variables,
            coords={"controller": controllers, "value": values, "end": ["low", "high"]},
            attrs={
                "key": self.key,
                "seed": self.seed,
                "carries": carries,
                "world": self.world,
            },
        )

    def to_dataframe(self) -> Any:
        """One line per row as a `pandas.DataFrame`, interval ends in columns of their own.

        Raises:
            PalmbotsError: pandas is not installed.
        """
        frame: Any = require("pandas", "study").DataFrame
        lines = []
        for row in self.rows:
            line: dict[str, Any] = {}
            for f in fields(row):
                entry = getattr(row, f.name)
                if f.name in _INTERVALS:
                    line[f"{f.name}_low"], line[f"{f.name}_high"] = entry
                else:
                    line[f.name] = entry
            lines.append(line)
        return frame(lines)


def _marked(rows: Sequence[Row]) -> list[tuple[bool, Row]]:
    """Each row, and whether it has the controller of the row before."""
    before = [None, *(row.controller for row in rows)]
    return [(row.controller == one, row) for row, one in zip(rows, before, strict=False)]


@command(
    order=70,
    example="palmbots compare --sweep robot.noise_m_s --values 0.01,0.02,0.03",
    progress="comparing",
    figure="compare.png",
    key=Option("--sweep", metavar="KEY"),
    values=Option(metavar="A,B,…"),
    controllers=Option(metavar="A,B,…"),
    carries=Option("--carries -n", least=1, most=10**8),
)
def compare(
    scene: SceneLike = "paper",
    *,
    key: str = DEFAULT_SWEEP,
    values: Sequence[float] | None = None,
    controllers: Sequence[ControllerLike] | None = None,
    carries: int = 200,
    seed: int = 0,
    world: str = "quasistatic",
    precision: str = "double",
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> Comparison:
    """Compare controllers over a numeric scene key.

    The default key is the radio latency.

    Args:
        scene: as in `palmbots.carry`.
        key: vary this numeric scene key. Examples are ``radio.latency_s`` and ``object.com_m[0]``.
        values: values of the key; None: latencies.
        controllers: controllers to compare; None: all shipped. They are named as in
            `palmbots.carry`. One in Python runs about 1000 times slower, so lower `carries` with
            it.
        carries: carries per controller and value. All have the seeds seed, seed + 1, …
        seed: the first seed.
        world: as in `palmbots.carry`. The carries of a world that Python steps run in one process
            per processor, and take about a second each.
        precision: ``double`` or ``float``.
        overrides: further scene keys to set.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: a scene cannot be read or is invalid, or no carry depends on the key.
        PalmbotsError: another argument is not allowed, or no controller takes any of the scenes.
    """
    entries = [resolve(c) for c in (shipped_names() if controllers is None else controllers)]
    _each_once("controllers", [entry.name for entry in entries])
    place = world_entry(world)
    check_precision(place, precision)
    seed = seed_of(seed)
    if not isinstance(key, str):
        raise SceneError(f"sweep: {show(key)} is not a key; allowed: a dotted key")
    if values is None:
        if key != DEFAULT_SWEEP:
            raise PalmbotsError(f"values: none given; allowed: numbers for {key}")
        values = DEFAULT_VALUES
    base = load_scene(scene, overrides)
    scenes = [
        with_values(base, [key], [value], called="sweep:", curved=place.supports_curved)
        for value in values
    ]
    _each_once("values", values)
    if len(scenes) > 1 and not place.is_stepped and have_equal_carries(scenes):
        raise without_effect("sweep:", key, place.name)
    rows, refusals = [], []
    cells = [(e, v, s) for e in entries for v, s in zip(values, scenes, strict=True)]
    for i, (entry, value, at) in enumerate(cells):

        def report(fraction: float, i: int = i) -> None:
            if on_progress is not None:
                on_progress((i + fraction) / len(cells))

        try:
            prepared = prepare(at, entry, place)
        except SceneError as error:
            refusals.append(Refusal(entry.name, value, str(error)))
        else:
            rows.append(_cell(prepared, key, value, carries, seed, precision, report))
        report(1.0)
    found = Comparison(
        scene=base, key=key, seed=seed, world=place.name, rows=tuple(rows), refusals=tuple(refusals)
    )
    if not rows:
        raise PalmbotsError(found.refusal_lines()[0])
    return found


def _each_once(what: str, given: Sequence[object]) -> None:
    """Raise `PalmbotsError` for an empty list, or for an entry that is given twice."""
    if len(given) == 0:
        raise PalmbotsError(f"{what}: none given; allowed: at least one")
    for i, one in enumerate(given):
        if one in given[:i]:
            raise PalmbotsError(f"{what}: {show(one)} is given twice; allowed: each one once")


def _cell(
    prepared: Prepared,
    key: str,
    value: float,
    n: int,
    seed: int,
    precision: str,
    report: Callable[[float], None],
) -> Row:
    run = carry_seeds(prepared, seed, n, precision, report)
    dropped = int(np.count_nonzero(run["outcome"] == DROPPED))
    delivered = int(np.count_nonzero(run["outcome"] == DELIVERED))
    square, low, high = _ratio(np.mean(run["contact_rms_m"] ** 2, axis=1), np.ones(n))
    sent = run["messages"].astype(float)
    messages, *messages_interval = _ratio(sent, run["distance_m"])
    return Row(
        controller=prepared.controller.name,
        key=key,
        value=value,
        n=n,
        drop_rate=dropped / n,
        interval=rate_interval(dropped, n),
        stall_rate=(n - dropped - delivered) / n,
        stall_interval=rate_interval(n - dropped - delivered, n),
        rms_m=math.sqrt(square),
        rms_interval_m=(math.sqrt(low), math.sqrt(high)),
        messages_per_m=messages,
        messages_interval_per_m=(messages_interval[0], messages_interval[1]),
        bytes_per_s=PACKET_SIZE * _ratio(sent, run["time_s"])[0],
        corrections=float(np.mean(run["corrections"])),
    )


def _ratio(of: NDArray[Any], to: NDArray[Any]) -> tuple[float, float, float]:
    """The ratio of two sums over carries and its 95 % interval, from the scatter of the carries.

    The low end is not below 0. A single carry gives the ratio alone, with an interval of NaN.
    """
    total = float(np.sum(to))
    if total <= 0:  # no carry advanced
        return 0.0, 0.0, 0.0
    n, ratio = len(of), float(np.sum(of)) / total
    if n == 1:  # no scatter is known
        return ratio, math.nan, math.nan
    half = Z95 * float(np.std(of - ratio * to, ddof=1)) * math.sqrt(n) / total
    return ratio, max(ratio - half, 0.0), ratio + half
