# SPDX-License-Identifier: Apache-2.0
"""Margins of one property, and ranges of both properties along each quantity.

A margin allows errors of all signs at once. It is found by bisection, since the condition is
monotone in the size of the error. A range varies one quantity and is exact (`interval_sets`).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, MaybeNaN, Side
from palmbots.stability.interval_sets import (
    VARIABLE,
    Interval,
    around,
    intersection,
    real_roots,
    shifted,
    where,
)
from palmbots.stability.linear_conditions import failing
from palmbots.stability.problem import Pair, StabilityProblem, permitted

_MOST_FRICTION = 100.0
_MOST_SLOPE = 2.0  # the tangent of 63°
_BOTH: tuple[tuple[int, Side], ...] = tuple((n, shallow) for n in (1, 2) for shallow in SIDES)
"""Properties 1 and 2, with either palm as the shallow one."""


@dataclass(frozen=True)
class Wedging:
    """The friction from which on a harder squeeze no longer frees a contact."""

    friction: MaybeNaN
    """The smallest friction, the same on both palms, at which a contact is wedged."""
    side: Side
    palm: str
    """The angle of that palm: shallow, steep, or turning between them."""
    happens: bool
    """Whether the scene's friction is that high."""


def _holds_both(problem: StabilityProblem, envelope: _core.OperatingEnvelope | None = None) -> bool:
    """Whether properties 1 and 2 hold with either palm as the shallow one."""
    envelope = envelope or problem.envelope()
    x = problem.com[0]
    for number, shallow in _BOTH:
        low, high = permitted(envelope, number, shallow, problem.angles)
        if not low <= x <= high:
            return False
    return True


def _largest(holds: Callable[[float], bool], limit: float) -> float:
    """The largest number up to a limit for which a monotone condition holds; it holds at 0."""
    if holds(limit):
        return limit
    good, bad = 0.0, limit
    while bad - good > 1e-12 + 1e-9 * good:
        middle = 0.5 * (good + bad)
        if holds(middle):
            good = middle
        else:
            bad = middle
    return good


def friction_margin(problem: StabilityProblem, number: int, shallow: Side) -> float:
    """The largest error of the coefficients, independent on both palms, that a property allows."""
    x = problem.com[0]

    def holds(error: float) -> bool:
        left, right = ((max(mu - error, 0.0), mu + error) for mu in problem.friction)
        low, high = permitted(
            problem.envelope(friction=(left, right)), number, shallow, problem.angles
        )
        return low <= x <= high

    return _largest(holds, 10.0)


def _with_errors(problem: StabilityProblem, error: float) -> Iterator[tuple[Pair, Pair]]:
    for left in (-error, 0.0, error):
        for right in (-error, 0.0, error):
            (a, b), (c, d) = problem.angles
            yield (a + left, b + left), (c + right, d + right)


def angle_margin(problem: StabilityProblem, number: int, shallow: Side) -> float:
    """The largest error of the palm angles, independent on both, that a property allows [rad]."""
    x, envelope = problem.com[0], problem.envelope()

    def holds(error: float) -> bool:
        for angles in _with_errors(problem, error):
            low, high = permitted(envelope, number, shallow, angles)
            if not low <= x <= high:
                return False
        return True

    return _largest(holds, math.radians(45))


def angle_error(problem: StabilityProblem) -> float | None:
    """The largest error of the palm angles that both properties allow [rad]; None: they fail."""
    if not _holds_both(problem):
        return None
    return min(angle_margin(problem, number, shallow) for number, shallow in _BOTH)


def com_x_range(problem: StabilityProblem) -> Interval | None:
    """The COMs along the object for which both properties hold, from the left contact vertex [m];
    None: there are none."""
    envelope = problem.envelope()
    both = intersection(permitted(envelope, n, shallow, problem.angles) for n, shallow in _BOTH)
    return None if both is None else shifted(both, problem.com_shift[0])


def _changes(problem: StabilityProblem, **changed: Any) -> list[float]:
    """The values of the varied quantity at which a condition begins or ceases to hold."""
    changes: list[float] = []
    for number, shallow in _BOTH:
        pose = problem.pose(number, shallow)
        for form in problem.forms(number, shallow, pose.angles, **changed):
            for span in problem.spans(pose.rise):
                for value in form.values(*span):
                    changes += real_roots(value)
    return changes


def com_y_ranges(problem: StabilityProblem) -> tuple[Interval, ...]:
    """The heights of the COM above that vertex for which both properties hold [m]."""
    ranges = where(
        _changes(problem, com=(problem.com[0], VARIABLE)),
        (-10 * problem.width, 10 * problem.width),
        lambda y: _holds_both(problem.with_(com=(problem.com[0], y))),
    )
    return tuple(shifted(heights, problem.com_shift[1]) for heights in ranges)


def friction_ranges(problem: StabilityProblem) -> tuple[Interval, ...]:
    """The coefficients, the same on both palms, for which both properties hold."""
    return where(
        _changes(problem, friction=(VARIABLE, VARIABLE)),
        (0.0, _MOST_FRICTION),
        lambda mu: _holds_both(problem.with_(friction=(mu, mu))),
    )


def slope_range(problem: StabilityProblem) -> Interval | None:
    """The slopes (tangents, uphill in travel > 0) around the scene's; None: they fail there."""
    pieces = where(
        _changes(problem, slope=VARIABLE),
        (-_MOST_SLOPE, _MOST_SLOPE),
        lambda s: _holds_both(problem.with_(slope=s)),
    )
    slopes = around(pieces, problem.slope)
    if slopes is None:
        return None
    # The mechanics count s towards −x; here uphill in the direction of travel is positive.
    return slopes if problem.spec.direction > 0 else (-slopes[1], -slopes[0])


def half_length_range(problem: StabilityProblem) -> Interval | None:
    """The half-lengths of both palms, from 0 on, for which both properties hold [m]."""
    # The extremes of z are linear in the half-length; a form changes sign where one of them is k.
    changes: list[float] = []
    for number, shallow in _BOTH:
        angles = problem.palms(shallow)
        rises = [
            problem.with_(contacts=((-h, h), (-h, h))).rise(number, shallow, angles)
            for h in (0.0, 1.0)
        ]
        for form in problem.forms(number, shallow, angles):
            bad = failing(form, problem.width)
            if bad is None:
                continue
            for end in (0, 1):
                base, gain = rises[0][end], rises[1][end] - rises[0][end]
                if gain != 0:
                    changes += [(k - base) / gain for k in bad]
    steepest = max(sum(abs(math.sin(a)) for a in problem.palms(s)) for s in SIDES)
    longest = problem.width / steepest if steepest > 0 else 10.0
    pieces = where(
        changes,
        (0.0, min(10.0, longest)),
        lambda h: _holds_both(problem.with_(contacts=((-h, h), (-h, h)))),
    )
    return around(pieces, 0.0)


def wedging(problem: StabilityProblem) -> Wedging:
    """The smallest friction at which an upper edge contains the line to the other contact."""
    best: tuple[float, Side, str] = (math.inf, "left", "steep")
    for shallow in SIDES:
        # All poses, since both palms are steep during most of a carry.
        for pose in (
            problem.pose(1, shallow),
            problem.pose(2, shallow),
            *problem.poses(0, shallow),
        ):
            for index, side in enumerate(SIDES):
                # As seen from this palm, the line to the other contact rises by ±z.
                dx, dy = problem.touching(pose.angles, pose.rise[1 - index])
                rise = dy if index == 0 else -dy
                friction = math.tan(math.atan2(dx, rise) - pose.angles[index])
                if 0 < friction < best[0]:
                    names = dict(zip(problem.angles[index], ("shallow", "steep"), strict=True))
                    best = (friction, side, names.get(pose.angles[index], "turning"))
    friction, side, palm = best
    return Wedging(friction, side, palm, problem.friction[SIDES.index(side)] >= friction)
