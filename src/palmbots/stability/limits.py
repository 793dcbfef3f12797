"""How far each quantity may go: margins of one property, ranges of both.

Margins allow errors in every direction at once and are found by bisection on a condition that is
monotone in the size of the error; ranges move one quantity alone and are exact (`ranges.py`).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from palmbots import _core
from palmbots.sections import SIDES, Side
from palmbots.stability.forms import Form, failing
from palmbots.stability.ranges import VARIABLE, Interval, around, intersection, real_roots, where
from palmbots.stability.situation import Pair, Situation, permitted

__all__ = [
    "Wedging",
    "angle_error",
    "angle_margin",
    "com_x_range",
    "com_y_ranges",
    "friction_margin",
    "friction_ranges",
    "half_length_range",
    "slope_range",
    "wedging",
]

_MOST_FRICTION = 100.0
_MOST_SLOPE = 2.0  # the tangent of 63°
_BOTH: tuple[tuple[int, Side], ...] = tuple((n, shallow) for n in (1, 2) for shallow in SIDES)
"""Properties 1 and 2, with either palm as the shallow one."""


@dataclass(frozen=True)
class Wedging:
    """Where squeezing harder frees a contact no more."""

    friction: float
    """The least friction (alike on both palms) at which a contact of the region is wedged."""
    side: Side
    palm: str
    """The angle of that palm: shallow, steep, or turning between them."""
    happens: bool
    """Whether the scene's own friction is that high."""


def _holds_both(at: Situation, envelope: _core.Envelope | None = None) -> bool:
    """Properties 1 and 2 with either palm as the shallow one."""
    envelope = envelope or at.envelope()
    x = at.com[0]
    for number, shallow in _BOTH:
        low, high = permitted(envelope, number, shallow, at.angles)
        if not low <= x <= high:
            return False
    return True


def _largest(holds: Callable[[float], bool], limit: float) -> float:
    """The largest number up to a limit for which a monotone condition holds; it does at 0."""
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


def friction_margin(at: Situation, number: int, shallow: Side) -> float:
    """The largest error of both coefficients, each its own way, that a property bears."""
    x = at.com[0]

    def holds(error: float) -> bool:
        left, right = ((max(mu - error, 0.0), mu + error) for mu in at.friction)
        low, high = permitted(at.envelope(friction=(left, right)), number, shallow, at.angles)
        return low <= x <= high

    return _largest(holds, 10.0)


def _with_errors(at: Situation, error: float) -> Iterator[tuple[Pair, Pair]]:
    for left in (-error, 0.0, error):
        for right in (-error, 0.0, error):
            (a, b), (c, d) = at.angles
            yield (a + left, b + left), (c + right, d + right)


def angle_margin(at: Situation, number: int, shallow: Side) -> float:
    """The largest error of both palm angles, each its own way, that a property bears [rad]."""
    x, envelope = at.com[0], at.envelope()

    def holds(error: float) -> bool:
        for angles in _with_errors(at, error):
            low, high = permitted(envelope, number, shallow, angles)
            if not low <= x <= high:
                return False
        return True

    return _largest(holds, math.radians(45))


def angle_error(at: Situation) -> float | None:
    """The largest error of both palm angles that both properties bear [rad]; None: none."""
    if not _holds_both(at):
        return None
    return min(angle_margin(at, number, shallow) for number, shallow in _BOTH)


def com_x_range(at: Situation) -> Interval | None:
    """The COMs along the object for which both properties hold [m]; None: none."""
    envelope = at.envelope()
    return intersection(permitted(envelope, n, shallow, at.angles) for n, shallow in _BOTH)


def _all_forms(at: Situation, **changed: Any) -> Iterator[tuple[Form, float, float]]:
    """Every form of both properties, with the two extreme spans at which it counts."""
    for number, shallow in _BOTH:
        pose = at.pose(number, shallow)
        for form in at.forms(number, shallow, pose.angles, **changed):
            for dy in pose.rise:
                yield form, math.sqrt((at.width - dy) * (at.width + dy)), dy


def _changes(at: Situation, **changed: Any) -> list[float]:
    """The values of the exchanged quantity at which something begins or ceases to hold."""
    found: list[float] = []
    for form, dx, dy in _all_forms(at, **changed):
        found += real_roots(form.at(dx, dy))
        for p, q in form.void:
            found += real_roots(p * dx + q * dy)
    return found


def com_y_ranges(at: Situation) -> tuple[Interval, ...]:
    """The heights of the COM for which both properties hold [m]."""
    return where(
        _changes(at, com=(at.com[0], VARIABLE)),
        (-10 * at.width, 10 * at.width),
        lambda y: _holds_both(at.with_(com=(at.com[0], y))),
    )


def friction_ranges(at: Situation) -> tuple[Interval, ...]:
    """The coefficients, alike on both palms, for which both properties hold."""
    return where(
        _changes(at, friction=(VARIABLE, VARIABLE)),
        (0.0, _MOST_FRICTION),
        lambda mu: _holds_both(at.with_(friction=(mu, mu))),
    )


def slope_range(at: Situation) -> Interval | None:
    """The tangents of the slope, uphill in travel positive, around the scene's; None: none."""
    pieces = where(
        _changes(at, slope=VARIABLE),
        (-_MOST_SLOPE, _MOST_SLOPE),
        lambda s: _holds_both(at.with_(slope=s)),
    )
    found = around(pieces, at.slope)
    if found is None:
        return None
    # The mechanics' s points to −x; uphill in travel is positive here.
    return found if at.spec.direction > 0 else (-found[1], -found[0])


def half_length_range(at: Situation) -> Interval | None:
    """The half-lengths of both palms, from 0 on, for which both properties hold [m]."""
    """From z extremes that are linear in the half-length to the k at which a form changes sign."""
    found: list[float] = []
    for number, shallow in _BOTH:
        angles = at.palms(shallow)
        rises = [
            at.with_(contacts=((-h, h), (-h, h))).rise(number, shallow, angles) for h in (0.0, 1.0)
        ]
        for form in at.forms(number, shallow, angles):
            bad = failing(form, at.width)
            if bad is None:
                continue
            for end in (0, 1):
                base, gain = rises[0][end], rises[1][end] - rises[0][end]
                if gain != 0:
                    found += [(k - base) / gain for k in bad]
    steepest = max(sum(abs(math.sin(a)) for a in at.palms(s)) for s in SIDES)
    longest = at.width / steepest if steepest > 0 else 10.0
    pieces = where(
        found,
        (0.0, min(10.0, longest)),
        lambda h: _holds_both(at.with_(contacts=((-h, h), (-h, h)))),
    )
    return around(pieces, 0.0)


def wedging(at: Situation) -> Wedging:
    """The least friction at which an upper edge contains the line to the other contact."""
    best: tuple[float, Side, str] = (math.inf, "left", "steep")
    for shallow in SIDES:
        # All poses that the palms pass through: most of a carry both are steep.
        for pose in (at.pose(1, shallow), at.pose(2, shallow), *at.poses(0, shallow)):
            for index, side in enumerate(SIDES):
                # The line to the other contact, seen from this palm, rises by ±z.
                rise = pose.rise[1] if index == 0 else -pose.rise[0]
                across = math.sqrt((at.width - rise) * (at.width + rise))
                friction = math.tan(math.atan2(across, rise) - pose.angles[index])
                if 0 < friction < best[0]:
                    names = dict(zip(at.angles[index], ("shallow", "steep"), strict=True))
                    best = (friction, side, names.get(pose.angles[index], "turning"))
    friction, side, palm = best
    return Wedging(friction, side, palm, at.friction[SIDES.index(side)] >= friction)
