# SPDX-License-Identifier: Apache-2.0
"""Forces and margin of a contact mode, with any number of contacts.

Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. The forces
that balance the weight in a contact mode are the shares s ≥ 0 of the edges of the friction cones
(`mechanics/wrench_cone.hpp`) with Σ s · wrench = load. These shares are a polyhedron. An extreme
value of a force is at one of its corners, where at most three independent edges have shares, or
grows without limit along one of its directions, in which at most four edges balance one another.
Both are enumerated. Source: docs/theory/contacts.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import MaybeNaN

Array = NDArray[np.float64]
Range = tuple[MaybeNaN, MaybeNaN]
Support = tuple[int, float, float, float, float, float]
"""Side of the tangent (0: as on the left palm), point from the COM [m], normal into the object,
friction coefficient."""

_STICK, _UP, _DOWN, _LEAVE = 0, 1, -1, 2
_TOLERANCES = (1e-8, 1e-6, 1e-4, 1e-2)  # weights
_INDEPENDENT = 1e-9  # least singular value of independent wrenches
_CARRIES = 1e-5  # weights; a contact with less carries nothing
_STEP = math.radians(0.5)  # in which a margin is looked for
_STEEPEST = math.radians(89)
_EXACT = 1e-9  # rad, of a margin


@dataclass(frozen=True, slots=True)
class ContactForce:
    """The force of one contact on the object in one contact mode, in units of the weight.

    Both components are ranges (least, greatest), because several forces may balance the weight. An
    end is infinite where the contacts can press against each other without limit.
    """

    normal: Range
    friction: Range
    """Along the surface, positive to the left for someone who stands on it."""


@dataclass(frozen=True, slots=True)
class ConsistentMode:
    """A contact mode that is kinematically possible and in balance. Lists are in the order of the
    contacts."""

    motions: tuple[str, ...]
    """ST, SL, SR or BR for each contact."""
    forces: tuple[ContactForce, ...]
    margin_deg: MaybeNaN
    """The mode stays consistent as long as the friction angle of each surface changes by less than
    this, each in its own direction; infinite: no change ends it."""
    at_limit: tuple[str, ...] | None
    """What the forces permit at the end of the margin: a contact that is SL or SR there, but not in
    `motions`, is at the edge of its friction cone, and one that is BR carries nothing. The
    inequality that decides is the one for this contact. None: the margin is infinite."""


def _wrenches(supports: Sequence[Support], motions: Sequence[int]) -> tuple[Array, Array, Array]:
    """Of each edge: its wrench per unit of normal force, its contact, and its friction."""
    reach = max((math.hypot(x, y) for _, x, y, *_ in supports), default=0.0) or 1.0
    columns, contacts, frictions = [], [], []
    for i, ((side, x, y, nx, ny, friction), motion) in enumerate(
        zip(supports, motions, strict=True)
    ):
        left = (-ny, nx)  # for someone who stands on the surface
        up = 1.0 if side == 0 else -1.0
        for edge in (_UP, _DOWN):
            if motion not in (edge, _STICK):
                continue
            along = -edge * up * friction
            fx, fy = nx + along * left[0], ny + along * left[1]
            columns.append((fx, fy, (x * fy - y * fx) / reach))
            contacts.append(i)
            frictions.append(along)
    return np.array(columns).reshape(-1, 3).T, np.array(contacts, int), np.array(frictions)


def _corners(edges: Array, slope: float) -> Array:
    """The corners of the polyhedron of shares, one a row. There are some: the mode is in balance up
    to rounding, which a triple of nearly dependent edges magnifies."""
    load = np.array([slope, 1.0, 0.0])
    for tolerance in _TOLERANCES:
        found = list(_corners_within(edges, load, tolerance))
        if found:
            return np.array(found)
    return np.zeros((1, edges.shape[1]))


def _corners_within(edges: Array, load: Array, tolerance: float) -> Iterator[Array]:
    n = edges.shape[1]
    for size in range(1, min(3, n) + 1):
        for chosen in combinations(range(n), size):
            some = edges[:, chosen]
            if np.linalg.svd(some, compute_uv=False)[-1] <= _INDEPENDENT:
                continue
            shares = np.linalg.lstsq(some, load)[0]
            off = float(np.abs(some @ shares - load).max())
            if off <= tolerance * (1 + np.abs(shares).max()) and shares.min() >= -tolerance:
                found = np.zeros(n)
                found[list(chosen)] = np.maximum(shares, 0.0)
                yield found


def _directions(edges: Array) -> Iterator[Array]:
    """The directions in which the polyhedron of shares is endless."""
    n = edges.shape[1]
    for size in range(2, min(4, n) + 1):
        for chosen in combinations(range(n), size):
            _, sizes, rows = np.linalg.svd(edges[:, chosen])
            rank = int(np.count_nonzero(sizes > _INDEPENDENT))
            if rank != size - 1:
                continue
            null = rows[-1] if rows[-1].sum() > 0 else -rows[-1]
            if null.min() >= -_INDEPENDENT:
                found = np.zeros(n)
                found[list(chosen)] = np.maximum(null, 0.0)
                yield found


def contact_forces(
    supports: Sequence[Support], motions: Sequence[int], slope: float
) -> tuple[ContactForce, ...]:
    """The ranges of the forces in a contact mode that is in balance."""
    edges, contacts, frictions = _wrenches(supports, motions)
    corners = _corners(edges, slope)
    endless = np.array(list(_directions(edges))).reshape(-1, edges.shape[1])

    def extent(weights: Array) -> Range:
        values, growth = corners @ weights, endless @ weights
        return (
            -math.inf if (growth < -_INDEPENDENT).any() else float(values.min()) + 0.0,
            math.inf if (growth > _INDEPENDENT).any() else float(values.max()) + 0.0,
        )

    own = [contacts == i for i in range(len(supports))]
    return tuple(ContactForce(extent(1.0 * k), extent(k * frictions)) for k in own)


def _at_angles(supports: Sequence[Support], changes: Sequence[float]) -> list[Support]:
    """The supports with other friction angles, kept from 0° to 89°."""
    return [
        (
            *one[:5],
            math.tan(min(max(math.atan(one[5]) + by, 0.0), max(_STEEPEST, math.atan(one[5])))),
        )
        for one, by in zip(supports, changes, strict=True)
    ]


def _first_end(holds: Callable[[float], bool], most: float) -> float:
    """The first change [rad] up to `most` at which something no longer holds; inf: none."""
    low = 0.0
    while low < most:
        high = min(low + _STEP, most)
        if not holds(high):
            while high - low > _EXACT:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if holds(middle) else (low, middle)
            return low
        low = high
    return math.inf


def margin_of(
    supports: Sequence[Support], motions: Sequence[int], slope: float, surfaces: Sequence[str]
) -> tuple[float, list[Support] | None]:
    """The margin [rad] of a contact mode, and the supports with the friction at its end.

    Args:
        supports: the contacts.
        motions: the mode.
        slope: the sideways specific force.
        surfaces: that of each contact; contacts of one surface have one friction.
    """
    names = sorted(
        {name for name, motion in zip(surfaces, motions, strict=True) if motion != _LEAVE}
    )
    # More friction permits all forces that less of it does, so where all contacts of a surface
    # stick, only less of it can end the mode.
    senses = [
        (-1.0,)
        if all(m in (_STICK, _LEAVE) for m, s in zip(motions, surfaces, strict=True) if s == name)
        else (-1.0, 1.0)
        for name in names
    ]
    least, at = math.inf, None
    for chosen in product(*senses):
        sense = dict(zip(names, chosen, strict=True))

        def changed(by: float, sense: dict[str, float] = sense) -> list[Support]:
            return _at_angles(supports, [by * sense.get(name, 0.0) for name in surfaces])

        def holds(by: float) -> bool:
            missing = _core.imbalance(changed(by), list(motions), slope)
            return missing <= _core.wrench_tolerance

        end = _first_end(holds, min(least, _STEEPEST))
        if end < least:
            least, at = end, changed(end)
    return least, at


def loaded_edges(supports: Sequence[Support], motions: Sequence[int], slope: float) -> list[int]:
    """How each contact can be loaded: as its motion would be if its force lies on one edge, and as
    if it left if it carries nothing."""
    edges, contacts, frictions = _wrenches(supports, motions)
    most = _corners(edges, slope).max(axis=0)
    found = []
    for i, (support, motion) in enumerate(zip(supports, motions, strict=True)):
        carrying = frictions[(contacts == i) & (most > _CARRIES)]
        if carrying.size == 0:
            found.append(_LEAVE)
        elif motion != _STICK or carrying.size == 2:
            found.append(motion)
        else:
            slides_left = carrying[0] < 0
            found.append(_UP if slides_left == (support[0] == 0) else _DOWN)
    return found
