# SPDX-License-Identifier: Apache-2.0
"""The result of a design: palm angles or a plate, what they tolerate, and the scene's own for
comparison."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from palmbots._types import Interval
from palmbots._util.confidence_intervals import rate_text
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, quiet, verdict
from palmbots._util.results import Result
from palmbots.scene.scene import Scene
from palmbots.scene.sides import on_every_side
from palmbots.simulation.noise_limit import NoiseLimit
from palmbots.simulation.outcome_counts import OutcomeCounts
from palmbots.stability.analysis import Analysis
from palmbots.stability.angle_certificate import angle_keys
from palmbots.stability.angle_grid import LIFT, NOISE, QUANTITIES, Lift, Objective, Quantity
from palmbots.stability.certificates.prover import Certificate
from palmbots.stability.plate_search import KEYS
from palmbots.stability.tightest_margins import RankedMargin

if TYPE_CHECKING:
    import xarray as xr


NOISE_FACTOR = 3.0
"""With their own noise, plates whose margins suffice do not differ measurably."""


@dataclass(frozen=True)
class Plate:
    """A plate with two angles, its margins, and how jobs with it end."""

    nose_m: float
    bevel_m: float
    heel_m: float
    shallow_deg: float
    steep_deg: float
    margins: tuple[RankedMargin, ...]
    """The margins of `palmbots.analyze`, the tightest first; empty: the plate does not qualify."""
    refusal: str
    """Why it does not qualify; empty: it does."""
    counts: OutcomeCounts | None
    """How jobs end; None: there is no controller, or it or the scene refuses them."""
    noisy: OutcomeCounts | None
    """The same with `NOISE_FACTOR` times the noise."""

    @derived
    def least_margin(self) -> float | None:
        """The tightest margin, relative to what the scene uses up of it; None: the plate does not
        qualify."""
        return next((one.times for one in self.margins if one.times is not None), None)

    def sizes(self) -> dict[str, float]:
        """The scene keys of the plate and their values."""
        return {key: getattr(self, key.removeprefix("palm.")) for key in KEYS}

    def text(self) -> str:
        """Its sizes and angles."""
        lengths = {"nose": self.nose_m, "bevel": self.bevel_m, "heel": self.heel_m}
        parts = ", ".join(f"{name} {1e3 * value:g} mm" for name, value in lengths.items())
        return f"{parts}, {self.shallow_deg:g}° and {self.steep_deg:g}°"


@dataclass(frozen=True)
class PlateDesign:
    """The plate and angles whose tightest margin is largest, and the scene's own for comparison."""

    best: Plate
    own: Plate
    """The scene's own plate; that of the left palm, if the palms differ."""
    analysis: Analysis = field(metadata=NOT_IN_JSON)
    """Of the designed scene."""

    @derived
    def fails_more(self) -> bool:
        """Whether simulated jobs fail measurably more often than with the scene's own plate."""
        mine, own = self.best.counts, self.own.counts
        if mine is None or own is None:
            return False
        return mine.failure_interval[0] > own.failure_interval[1]

    def lines(self) -> Iterator[Item]:
        """The plate, its margins beside those of the scene's own, and simulated jobs."""
        mine, own = self.best, self.own
        yield Line(verdict(not self.fails_more, "DESIGNED", "FAILS"), bold(f"  {mine.text()}"))
        if self.fails_more:
            yield "simulated jobs fail more often than with the scene's own plate"
        least = f"tightest margin {_times(mine.least_margin)}"
        if own.refusal:
            yield f"{least}; the scene's own plate does not qualify: {own.refusal}"
        elif mine.sizes() == own.sizes():
            yield f"{least}: the scene's own plate; no other plate that was tried has a larger one"
        else:
            yield f"{least} instead of {_times(own.least_margin)} with {own.text()}"
        heads = ("designed", "the scene's own")
        yield Table(list(self._rows()), ("", *heads), right=heads)
        if mine.counts is not None:
            yield quiet(
                f"margins: relative to what the scene uses up; jobs: {mine.counts.carries:,} with "
                f"{mine.counts.controller}, seeds from 0; 95 %"
            )
        yield "tightest with the designed plate:"
        for number, margin in enumerate(mine.margins[:3], 1):
            yield Line(f"{number}. {margin.sentence()}", indent=2)

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        # A quantity has several margins where several parts limit it: the least one is shown.
        tables = [
            {one.quantity: one.times for one in reversed(plate.margins) if one.times is not None}
            for plate in (self.best, self.own)
        ]
        for name in sorted(tables[0], key=lambda name: tables[0][name]):
            yield f"  {name}", _times(tables[0][name]), _times(tables[1].get(name))
        if self.best.counts is not None:
            best, own = self.best, self.own
            yield "  jobs that fail", failures_text(best.counts), failures_text(own.counts)
            name = f"  {NOISE_FACTOR:g} × noise"
            yield name, failures_text(best.noisy), failures_text(own.noisy)


def _times(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


@dataclass(frozen=True)
class OwnAngles:
    """The scene's own angles under the same conditions."""

    angles_deg: Interval | None
    """(shallow, steep); None: the two palms differ."""
    tolerance: float | None
    """None: a property fails at these angles, the plate does not qualify, or the palms differ."""
    noise_limit: NoiseLimit | None = field(metadata=NOT_IN_JSON)
    """None: not measured, or there is no limit."""
    clearance_deg: float
    """As of the designed angles."""
    counts: OutcomeCounts | None
    """As of the designed angles."""

    @derived
    def sigma_star_m_s(self) -> float | None:
        """As of the designed angles."""
        return None if self.noise_limit is None else self.noise_limit.sigma_star_m_s

    @derived
    def interval(self) -> Interval | None:
        """The 95 % interval of `sigma_star_m_s`."""
        return None if self.noise_limit is None else self.noise_limit.interval

    def name(self) -> str:
        """How reports and figures call them."""
        if self.angles_deg is None:
            return "the scene's own"
        shallow, steep = self.angles_deg
        return f"the scene's own {shallow:g}° and {steep:g}°"


@dataclass(frozen=True)
class ReactionTimes:
    """Times from leaving the zero zone to moving [s]."""

    own: float
    """For the own contact (d)."""
    asked: float
    """Asked by the partner (a)."""


@dataclass(frozen=True, repr=False)
class Design(Result):
    """The best pair of angles with its tolerance, its noise limit and a certificate."""

    lines_of = "palmbots.stability.design_lines:design_lines"

    scene: Scene
    """As given, with its own angles."""
    maximize: Objective
    shallow_deg: float
    steep_deg: float
    tolerance: float
    """The tolerance of `quantity` to either side, in its unit (`QUANTITIES`); the certificate, if
    there is one, proves it. With lift: the tightest margin, relative to what the scene uses up
    of it."""
    clearance_deg: float
    """How far the object or a palm may turn until an edge lies on a palm."""
    friction: Interval | None
    """Coefficients, the same on both palms, for which the properties hold at these angles."""
    friction_floor: float | None
    reaction_s: ReactionTimes
    """How long the robots take to react."""
    reach_m: float
    """How far outward the contacts move in the worst case until the robots react."""
    region_m: Interval
    """The contacts for which everything holds."""
    noise_limit: NoiseLimit | None = field(metadata=NOT_IN_JSON)
    """None: not measured, or the controller has no limit at these angles."""
    counts: OutcomeCounts | None
    """How carries of this scene, with its own noise, end at the designed angles; None: there is no
    controller, or it refuses them."""
    own: OwnAngles
    """The same for the angles of the scene."""
    paper_tolerance: float | None
    """The tolerance of 5° and 15° under the same conditions; None: that pair does not qualify."""
    certificate: Certificate | None
    """The proof, without clearance if a contact vertex is rounded; None: a plate was designed."""
    map: xr.Dataset = field(metadata=NOT_IN_JSON)
    """Tolerance and clearance over all pairs of angles; about σ* of those that were tried."""
    designed_scene: Scene
    """The scene with the designed angles, and with the designed plate."""
    plate: PlateDesign | None = None
    """The designed plate with all margins; None: only angles were designed."""
    words: str = field(default="", metadata=NOT_IN_JSON)
    """Those that name the controller on a command line."""

    figure = "palm-angles"

    @derived
    def quantity(self) -> Quantity | Lift:
        """The quantity whose tolerance is reported."""
        return "com" if self.maximize == NOISE else self.maximize

    @derived
    def unit(self) -> str:
        """The unit of the tolerance."""
        return "" if self.quantity == LIFT else QUANTITIES[self.quantity][2]

    @derived
    def controller(self) -> str | None:
        """The controller whose noise limit was measured."""
        return None if self.noise_limit is None else self.noise_limit.controller

    @derived
    def sigma_star_m_s(self) -> float | None:
        """``robot.noise_m_s`` at which 1 % of carries drop the object; None: not measured."""
        return None if self.noise_limit is None else self.noise_limit.sigma_star_m_s

    @derived
    def interval(self) -> Interval | None:
        """The 95 % interval of `sigma_star_m_s`."""
        return None if self.noise_limit is None else self.noise_limit.interval

    @property
    def is_certified(self) -> bool:
        """Whether the certificate proves the tolerance."""
        return self.certificate is not None and self.certificate.holds

    @property
    def is_sound(self) -> bool:
        """Whether the design does what it has to: the certificate proves the tolerance, or no more
        jobs fail with the plate than with the scene's own."""
        return self.is_certified if self.plate is None else not self.plate.fails_more

    @property
    def angle_keys(self) -> dict[str, float]:
        """The scene keys to set, as in ``pb.carry("paper", overrides=best.angle_keys)``; with lift
        also those of the plate."""
        if self.plate is not None:
            return on_every_side(self.scene, self.plate.best.sizes())
        return angle_keys(self.scene, (self.shallow_deg, self.steep_deg))

    @derived
    def is_better_here(self) -> bool | None:
        """Whether the scene fails measurably less often with the designed angles than with its own,
        at its own noise; None: not tried."""
        if self.counts is None or self.own.counts is None:
            return None
        return self.counts.failure_interval[1] < self.own.counts.failure_interval[0]

    @derived
    def warnings(self) -> tuple[str, ...]:
        """What these angles cost, one sentence each."""
        return tuple(self._warnings())

    def _warnings(self) -> Iterator[str]:
        half = min(self.scene.palm_of(side).reach_m for side in ("left", "right"))
        if self.maximize != NOISE and self.reach_m > half:
            yield (
                f"contacts leave the palm before the robots react: they may move "
                f"{1e3 * self.reach_m:.0f} mm from the pivot, but half a palm is "
                f"{1e3 * half:.0f} mm (palm.rate_deg_s, robot.noise_m_s)"
            )
        mine, own = self.noise_limit, self.own.noise_limit
        if mine is not None and own is not None and mine.interval[1] < own.interval[0]:
            yield (
                f"these angles tolerate less noise than the scene's own: σ* is "
                f"{limit_text(mine)} instead of {limit_text(own)}"
            )
        noise = self.scene.robot.noise_m_s
        if mine is not None and noise > mine.interval[1]:
            yield (
                f"robot.noise_m_s is {noise:g}, but more than 1 % of carries drop the object above "
                f"{mine.sigma_star_m_s:.3g} m/s"
            )

    @property
    def shown_unit(self) -> str:
        """The unit in which people read the quantity; empty: it has none."""
        return {"m": "mm", "rad": "°"}.get(self.unit, self.unit)

    def tolerance_text(self, tolerance: float) -> str:
        """A tolerance of the quantity with its unit."""
        if self.quantity == LIFT:
            return f"{tolerance:.3g}"
        scale, unit = QUANTITIES[self.quantity][3], self.shown_unit
        gap = "" if unit in ("", "°") else " "
        return f"±{scale * tolerance:.3g}{gap}{unit}"


def limit_text(limit: NoiseLimit) -> str:
    """A noise limit with its interval: "1.94 cm/s (1.92 to 1.96)"."""
    low, high = (100 * end for end in limit.interval)
    return f"{100 * limit.sigma_star_m_s:.2f} cm/s ({low:.2f} to {high:.2f})"


def failures_text(counts: OutcomeCounts | None) -> str:
    """The share of carries that do not deliver; None: they are refused."""
    return (
        "refused" if counts is None else rate_text(counts.dropped + counts.stalled, counts.carries)
    )
