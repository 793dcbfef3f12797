# SPDX-License-Identifier: Apache-2.0
"""The claims of certificates about forces, each alone, at random points of a box.

A state is held if its linear program has a solution: shares ≥ 0 of the four edges of both friction
cones that balance the weight. If it has one, it has a vertex, in which one of the edges has no
share. So the four systems of three equations that leave out one edge each decide everything:
without the left contact's lower edge, that contact slides up, and so on. Nothing here is shared
with the code under test.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
OFF_BY = 1e-9
"""Shares closer to 0 than this, in weights, decide nothing."""
CLAIMS = ("property 1", "property 2", "property 0", "property 0 turning", "no jam")


@dataclass(frozen=True)
class States:
    """Many states of two palms and an object; pairs are rows (left, right); angles in rad."""

    width: Array
    com: Array
    theta: Array
    p: Array
    friction: Array
    offset: Array
    slope: Array

    def margins(self) -> dict[tuple[int, int], Array]:
        """The least share of an edge where contact `side` (0 left) slides up (1) or down (−1), and
        the other one sticks; ≥ 0: in balance."""
        height = self.p * np.sin(self.theta) + self.offset * np.cos(self.theta)
        tilt = np.arcsin((height[1] - height[0]) / self.width)
        along = np.stack([np.cos(tilt), np.sin(tilt)])
        across = np.stack([-np.sin(tilt), np.cos(tilt)])
        places = [0 * along, self.width * along]
        com = self.com[0] * along + self.com[1] * across
        edges = {}
        for side, inward in ((0, 1.0), (1, -1.0)):
            for slide in (1, -1):
                lean = self.theta[side] + slide * np.arctan(self.friction[side])
                force = np.stack([inward * np.sin(lean), np.cos(lean)])
                edges[side, slide] = np.stack([*force, _cross(places[side], force)])
        weight = np.stack([-self.slope, -np.ones_like(self.slope)])
        wanted = -np.stack([*weight, _cross(com, weight)]).T[..., None]
        found = {}
        for side, slide in edges:
            used = [edge for key, edge in edges.items() if key != (side, -slide)]
            matrix = np.stack(used, axis=-1).transpose(1, 0, 2)
            regular = np.abs(np.linalg.det(matrix)) > 1e-12
            matrix[~regular] = np.eye(3)
            shares = np.linalg.solve(matrix, wanted)[..., 0].min(axis=-1)
            found[side, slide] = np.where(regular, shares, 0.0)  # 0 decides nothing
        return found

    def touching(self, radii: tuple[float, float]) -> "States":
        """The same states of a box with rounded contact corners, as sharp objects with contacts at
        the touching points: points of the complex plane, from the left corner of the box."""
        radius = np.array(radii)[:, None]
        centres = np.stack([0 * self.width, self.width]) + radius * [[1 + 1j], [1j - 1]]
        span = centres[1] - centres[0]
        height = self.p * np.sin(self.theta) + (self.offset + radius) * np.cos(self.theta)
        turn = np.exp(1j * np.arcsin((height[1] - height[0]) / abs(span))) * abs(span) / span
        left, right = (
            centre * turn - r * np.exp(1j * (np.pi / 2 + angle))
            for centre, r, angle in zip(centres, radii, self.theta * [[-1], [1]], strict=True)
        )
        chord = right - left
        com = ((self.com[0] + 1j * self.com[1]) * turn - left) * np.conj(chord) / abs(chord)
        return replace(self, width=abs(chord), com=np.stack([com.real, com.imag]))


def _cross(a: Array, b: Array) -> Array:
    return a[0] * b[1] - a[1] * b[0]


def failing(claim: str, states: States, shallow: int) -> Flags:
    """Where a claim certainly fails; `shallow`: the palm that is, for properties 1 and 2."""
    margins = states.margins()
    surely = {key: margin > OFF_BY for key, margin in margins.items()}
    never = {key: margin < -OFF_BY for key, margin in margins.items()}
    steep = 1 - shallow
    if claim == "property 1":  # closing: the shallow palm's contact slides up, the other one not
        return never[shallow, 1] | surely[steep, 1]
    if claim == "property 2":  # opening: the steep palm's contact slides down, the other one not
        return never[steep, -1] | surely[shallow, -1]
    loose = never[0, 1] & never[1, 1] & never[0, -1] & never[1, -1]
    if claim != "no jam":
        return loose
    jams = (never[0, 1] & never[1, 1]) | (never[0, -1] & never[1, -1])
    return jams & ~loose  # an object that nothing holds does not jam


def sampled(
    claim: str, box: dict[str, Any], rng: np.random.Generator, n: int
) -> Iterator[tuple[States, int]]:
    """Random points of the box of a certificate where the claim speaks, often at its corners, with
    the shallow palm."""
    low, high = ([_numbers(box[key][side]) for side in SIDES] for key in ANGLES)
    region = [_numbers(box["contacts_m"][side]) for side in SIDES]
    turning = [(low[i][0], high[i][1]) for i in (0, 1)]
    beyond = float(Fraction(box["beyond_m"]))
    for shallow in (0, 1):
        steep = 1 - shallow
        inward, outward = list(region), list(region)
        inward[shallow] = (region[shallow][0], min(region[shallow][1], beyond))
        outward[steep] = (max(region[steep][0], -beyond), region[steep][1])
        one = [low[i] if i == shallow else high[i] for i in (0, 1)]
        moving = [turning[i] if i == shallow else high[i] for i in (0, 1)]
        places = {
            "property 1": [(one, inward)],
            "property 2": [(one, outward)],
            "property 0": [(high, region), (low, region), (moving, inward), (moving, outward)],
        }.get(claim, [(turning, region)])
        for angles, contacts in places:
            yield _states(box, angles, contacts, rng, max(1, n // (2 * len(places)))), shallow


ANGLES = ("shallow_deg", "steep_deg")


def _states(
    box: dict[str, Any], angles: Any, contacts: Any, rng: np.random.Generator, n: int
) -> States:
    def between(ends: tuple[float, float]) -> Array:
        share = np.where(rng.random(n) < 0.5, rng.random(n), rng.integers(0, 2, n))
        return ends[0] + (ends[1] - ends[0]) * share

    def sides(key: str) -> Array:
        return np.stack([between(_numbers(box[key][side])) for side in SIDES])

    friction = sides("friction")
    if box["friction"]["common"]:
        friction[1] = friction[0]
    corners = np.array([_numbers(point) for point in box["com_m"]])
    return States(
        width=between(_numbers(box["width_m"])),
        com=(rng.dirichlet(np.full(len(corners), 0.3), n) @ corners).T,
        theta=np.radians(np.stack([between(ends) for ends in angles])),
        p=np.stack([between(ends) for ends in contacts]),
        friction=friction,
        offset=sides("offset_m"),
        slope=between(_numbers(box["slope"])),
    )


def _numbers(pair: Any) -> tuple[float, float]:
    low, high = (float(Fraction(value)) for value in pair)
    return low, high


def random_box(
    rng: np.random.Generator, radii: tuple[float, float] = (0.0, 0.0)
) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene and intervals: palms like V or Λ, with much or little friction, COM anywhere, contact
    corners with these radii."""

    def around(middle: float, size: float) -> tuple[float, float]:
        half = float(rng.uniform(0, size))
        return round(middle - half, 5), round(middle + half, 5)

    shallow = round(float(rng.uniform(-45, 25)), 3)
    steep = round(shallow + float(rng.uniform(2, 15)), 3)
    most = math.tan(math.radians(89 - max(abs(shallow), abs(steep))))
    least = math.tan(math.radians((steep - shallow) / 2))
    friction = least + (most - least) * float(rng.uniform(0.01, 0.9)) ** 2
    height = float(rng.uniform(0.05, 0.5))
    com = [0.25 * float(rng.uniform(0.1, 0.9)), height * float(rng.uniform(0.1, 0.9))]
    scene = {
        "object": {
            "box_m": [0.25, height],
            "com_m": com,
            "mass_kg": 0.1,
            "edge_radius_m": [*radii, 0, 0],
        },
        "palm": {
            "length_m": float(rng.uniform(0.02, 0.15)),
            "shallow_deg": shallow,
            "steep_deg": steep,
            "friction": friction,
        },
        "task": {"slope_deg": float(rng.choice([0.0, rng.uniform(-3, 3)]))},
    }
    given = {
        "friction": around(friction, 0.02 * friction),
        "friction_right": around(friction, 0.02 * friction),
        "com_x_m": around(com[0], 0.002),
        "shallow_deg": around(shallow, 0.3),
        "steep_deg": around(steep, 0.3),
    }
    return scene, given
