# SPDX-License-Identifier: Apache-2.0
"""The result of a design: the palm angles, what they tolerate, and the scene's own for
comparison."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from palmbots._types import Interval
from palmbots._util.results import Result
from palmbots.scene.scene import Scene
from palmbots.simulation.noise_limit import NoiseLimit
from palmbots.stability.angle_certificate import angle_keys
from palmbots.stability.angle_grid import NOISE, QUANTITIES, Objective, Quantity
from palmbots.stability.certificates.prover import Certificate

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class OwnAngles:
    """The scene's own angles under the same conditions."""

    angles_deg: Interval | None
    """(shallow, steep); None: the two palms differ."""
    tolerance: float | None
    """None: a property fails at these angles, or the palms differ."""
    noise_limit: NoiseLimit | None
    """None: not measured, or there is no limit."""

    def name(self) -> str:
        """How reports and figures call them."""
        if self.angles_deg is None:
            return "the scene's own"
        shallow, steep = self.angles_deg
        return f"the scene's own {shallow:g}° and {steep:g}°"


@dataclass(frozen=True, repr=False)
class Design(Result):
    """The best pair of angles with its tolerance, its noise limit and a certificate."""

    scene: Scene
    """As given, with its own angles."""
    objective: Objective
    shallow_deg: float
    steep_deg: float
    tolerance: float
    """Of `quantity`, to either side, in its unit (`QUANTITIES`); the certificate proves it."""
    clearance_deg: float
    """How far the object or a palm may turn until an edge lies on a palm."""
    friction: Interval | None
    """Coefficients, the same on both palms, for which the properties hold at these angles."""
    friction_floor: float | None
    reaction_s: dict[str, float]
    """Time from leaving the zero zone to moving: own contact (d), and asked by the partner (a)."""
    reach_m: float
    """How far outward the contacts move in the worst case until the robots react."""
    region_m: Interval
    """The contacts for which everything holds."""
    noise_limit: NoiseLimit | None
    """None: not measured, or the controller has no limit at these angles."""
    own: OwnAngles
    paper_tolerance: float | None
    """The tolerance of 5° and 15° under the same conditions; None: that pair does not qualify."""
    certificate: Certificate
    map: xr.Dataset
    """Tolerance and clearance over all pairs of angles; about σ* of those that were tried."""
    designed_scene: Scene
    """The scene with the designed angles."""

    figure = "palm-angles"

    @property
    def quantity(self) -> Quantity:
        """The quantity whose tolerance is reported."""
        return "com" if self.objective == NOISE else self.objective

    @property
    def sigma_star_m_s(self) -> float | None:
        """``robot.noise_m_s`` at which 1 % of carries drop the object; None: not measured."""
        return None if self.noise_limit is None else self.noise_limit.sigma_star_m_s

    @property
    def angle_keys(self) -> dict[str, float]:
        """The scene keys to set, as in ``pb.carry("paper", overrides=best.angle_keys)``."""
        return angle_keys(self.scene, (self.shallow_deg, self.steep_deg))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What these angles cost, one sentence each."""
        return tuple(self._warnings())

    def _warnings(self) -> Iterator[str]:
        half = min(self.scene.palm_of(side).length_m for side in ("left", "right")) / 2
        if self.objective != NOISE and self.reach_m > half:
            yield (
                f"contacts leave the palm before the robots react: they may move "
                f"{1e3 * self.reach_m:.0f} mm from the pivot, but half a palm is "
                f"{1e3 * half:.0f} mm; use --maximize noise, faster palms or less noise"
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

    def headline(self) -> str:
        """The angles and what they maximise."""
        name = "noise" if self.objective == NOISE else QUANTITIES[self.quantity][4]
        return f"palm angles {self.shallow_deg:g}° and {self.steep_deg:g}° tolerate most: {name}"

    @property
    def shown_unit(self) -> str:
        """The unit in which people read the quantity; empty: it has none."""
        unit = QUANTITIES[self.quantity][2]
        return {"m": "mm", "rad": "°"}.get(unit, unit)

    def tolerance_text(self, tolerance: float) -> str:
        """A tolerance of the quantity with its unit."""
        scale, unit = QUANTITIES[self.quantity][3], self.shown_unit
        gap = "" if unit in ("", "°") else " "
        return f"±{scale * tolerance:.3g}{gap}{unit}"

    def facts(self) -> dict[str, str]:
        """Noise limit, tolerance, clearance, region, friction and certificate."""
        low, high = self.region_m
        facts = {}
        if self.noise_limit is not None:
            facts["σ*"] = limit_text(self.noise_limit)
        if self.own.noise_limit is not None:
            facts["σ* of own angles"] = limit_text(self.own.noise_limit)
        facts |= {
            "tolerance": self.tolerance_text(self.tolerance),
            "tolerance of own angles": "none: a property fails"
            if self.own.tolerance is None
            else self.tolerance_text(self.own.tolerance),
            "clearance": f"{self.clearance_deg:.2f}°",
            "contacts": f"{1e3 * low:.1f} to {1e3 * high:.1f} mm",
        }
        if self.friction is not None:
            facts["friction"] = f"{self.friction[0]:.3f} to {self.friction[1]:.3f}"
        return facts | {"certificate": self.certificate.verdict}

    def summary(self) -> dict[str, Any]:
        """The object that ``palmbots design --json`` prints."""
        mine, own = self.noise_limit, self.own.noise_limit
        return {
            "shallow_deg": self.shallow_deg,
            "steep_deg": self.steep_deg,
            "maximize": self.objective,
            "sigma_star_m_s": self.sigma_star_m_s,
            "interval": None if mine is None else list(mine.interval),
            "controller": None if mine is None else mine.controller,
            "tolerance": self.tolerance,
            "tolerance_of": self.quantity,
            "unit": QUANTITIES[self.quantity][2],
            "own": {
                "shallow_deg": None if self.own.angles_deg is None else self.own.angles_deg[0],
                "steep_deg": None if self.own.angles_deg is None else self.own.angles_deg[1],
                "sigma_star_m_s": None if own is None else own.sigma_star_m_s,
                "interval": None if own is None else list(own.interval),
                "tolerance": self.own.tolerance,
            },
            "paper_tolerance": self.paper_tolerance,
            "clearance_deg": self.clearance_deg,
            "friction": self.friction,
            "friction_floor": self.friction_floor,
            "reaction_s": self.reaction_s,
            "reach_m": self.reach_m,
            "region_m": self.region_m,
            "warnings": list(self.warnings),
            "certificate": self.certificate.data,
            "designed_scene": self.designed_scene.model_dump(),
            "scene": self.scene.model_dump(),
        }


def limit_text(limit: NoiseLimit) -> str:
    """A noise limit with its interval: "1.94 cm/s (1.92 to 1.96)"."""
    low, high = (100 * end for end in limit.interval)
    return f"{100 * limit.sigma_star_m_s:.2f} cm/s ({low:.2f} to {high:.2f})"
