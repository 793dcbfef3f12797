# SPDX-License-Identifier: Apache-2.0
"""The path of both robots on the floor: position, heading and curvature over arc length.

Seen from above, metres and radians: x points ahead where the path begins, y to the left of it; the
heading is anticlockwise from x, and a curvature > 0 turns left. The curve begins at s = 0 in the
origin; before it and after its end the path is straight. Arcs begin and end with clothoids, on
which the curvature κ grows evenly; so do corners of waypoints that are rounded with a radius. A
path through waypoints is otherwise a natural cubic spline, whose curvature is 0 at both ends. So κ
is continuous everywhere and wheels can follow.

With β = asin(κ d / 2) a palm stands askew to an object that reaches to another palm d away on the
same path. `palmbots.mujoco.drift_forecast` estimates the drift that follows.
"""

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from palmbots._util.optional_imports import require
from palmbots.errors import SceneError
from palmbots.scene.path_section import Path, Point

RADIUS_M, SWEEP_DEG, EASE_M, LEAD_M = 2.0, 45.0, 0.1, 0.1  # if the scene does not state them
_STEP_M = 0.002  # between two samples; its chord deviates 2 µm from a circle of 0.25 m
_FINEST, _LONGEST_M = 64, 2_000.0
SHARPEST_TURN = math.radians(170)  # of a corner that is rounded


@dataclass(frozen=True, slots=True)
class Spot:
    """A point of a path: x, y [m], heading [rad] and curvature [1/m]."""

    x: float
    y: float
    heading: float
    curvature: float


@dataclass(frozen=True)
class Curve:
    """A path as evenly spaced samples; before the first and after the last one it is straight."""

    step: float
    """Arc length between two samples [m]."""
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    heading: NDArray[np.float64]
    curvature: NDArray[np.float64]

    @property
    def length(self) -> float:
        """Length of the curved part [m]."""
        return self.step * (len(self.x) - 1)

    @property
    def sharpest(self) -> float:
        """The largest absolute curvature [1/m]."""
        return float(np.abs(self.curvature).max())

    @cached_property
    def _rows(self) -> list[tuple[float, float, float, float]]:
        """The samples as Python numbers, which are faster to read one by one."""
        columns = (self.x, self.y, self.heading, self.curvature)
        return list(zip(*(c.tolist() for c in columns), strict=True))

    def at(self, s: float) -> Spot:
        """The point at arc length `s`, of any sign."""
        rows = self._rows
        last = len(rows) - 1
        k = min(max(round(s / self.step), 0), last)
        over = s - k * self.step
        x, y, heading, bend = rows[k]
        grows = 0.0  # of the curvature, over `over`
        if 0 <= s <= self.step * last:
            near = min(max(k + (1 if over > 0 else -1), 0), last)
            grows = abs(over) / self.step * (rows[near][3] - bend)
        else:
            bend = 0.0
        cos, sin = math.cos(heading), math.sin(heading)
        side = 0.5 * bend * over * over
        turned = heading + (bend + 0.5 * grows) * over
        return Spot(x + over * cos - side * sin, y + over * sin + side * cos, turned, bend + grows)

    def nearest(self, x: float, y: float, s: float) -> float:
        """Arc length of the point of the path nearest to (x, y), near the guess `s`."""
        for _ in range(8):
            spot = self.at(s)
            cos, sin = math.cos(spot.heading), math.sin(spot.heading)
            dx, dy = x - spot.x, y - spot.y
            ahead = dx * cos + dy * sin
            aside = dy * cos - dx * sin
            change = ahead / max(0.2, 1 - spot.curvature * aside)
            s += change
            if abs(change) < 1e-10:
                break
        return s


def curve_of(path: Path, way: float, spread: float) -> Curve:
    """The curve of a path for robots that travel `way` at a distance of `spread` [m].

    Raises `SceneError` where it bends too sharply for them, or is too long.
    """
    if path.kind == "waypoints":
        assert path.waypoints_m is not None
        curve = _through(path.waypoints_m) if path.radius_m is None else _rounded(path)
        if curve.sharpest * spread > 1:
            worst = int(np.abs(curve.curvature).argmax())
            raise SceneError(
                f"task.path.waypoints_m: bends with a radius of {1 / curve.sharpest:.3g} m after "
                f"{worst * curve.step:.2f} m, too tight for robots {spread:.3g} m apart; allowed: "
                f"waypoints with radii of at least {spread:.3g} m, or "
                "corners that task.path.radius_m rounds"
            )
        return curve
    if path.kind == "straight":
        return _integrated(np.zeros(3), _STEP_M)
    radius = RADIUS_M if path.radius_m is None else path.radius_m
    if radius < spread:
        raise SceneError(
            f"task.path.radius_m: {radius:g} is too tight for robots whose wheels stand "
            f"{spread:.3g} m apart; allowed: at least {spread:.3g} (see mujoco.axle_m)"
        )
    ease = EASE_M if path.transition_m is None else path.transition_m
    sense = -1.0 if path.turn == "right" else 1.0
    knots = _arc(0.0, sense / radius, _sweep(path, way, radius), ease)
    if path.kind == "s":
        knots += _arc(knots[-1][0], -sense / radius, _sweep(path, way, radius), ease)
    if knots[-1][0] > _LONGEST_M:
        raise SceneError(
            f"task.path: is curved for {knots[-1][0]:.0f} m; allowed: at most {_LONGEST_M:g} m"
        )
    return _along(knots)


def _along(knots: list[tuple[float, float]]) -> Curve:
    """The curve whose curvature is linear between these (s, κ)."""
    count = max(_FINEST, math.ceil(knots[-1][0] / _STEP_M))
    s = np.linspace(0.0, knots[-1][0], count + 1)
    corners, bends = np.array(knots).T
    return _integrated(np.interp(s, corners, bends), float(s[1]))


def _rounded(path: Path) -> Curve:
    """Straight lines between waypoints, whose corners are arcs with clothoids."""
    assert path.waypoints_m is not None
    assert path.radius_m is not None
    ease = EASE_M if path.transition_m is None else path.transition_m
    legs = np.diff(np.array(path.waypoints_m), axis=0)
    if np.hypot(*legs.T).sum() > _LONGEST_M:
        raise _too_far(float(np.hypot(*legs.T).sum()))
    knots, free = [(0.0, 0.0)], float(math.hypot(*legs[0]))
    for k, (one, two) in enumerate(itertools.pairwise(legs), start=1):
        turn = math.atan2(one[0] * two[1] - one[1] * two[0], float(one @ two))
        after = float(math.hypot(*two))
        if abs(turn) < 1e-6:
            free += after
            continue
        arc = _arc(0.0, math.copysign(1 / path.radius_m, turn), abs(turn), ease)
        used = corner_length(turn, path.radius_m, ease)
        if abs(turn) > SHARPEST_TURN or used > free or used > after:
            raise SceneError(
                f"task.path.waypoints_m[{k}]: the corner turns by {math.degrees(abs(turn)):.0f}° "
                f"and needs {used:.3g} m of both lines; allowed: turns of at most "
                f"{math.degrees(SHARPEST_TURN):.0f}°, longer lines or a smaller radius_m"
            )
        start = knots[-1][0] + free - used
        knots += [(start + s, bend) for s, bend in arc]
        free = after - used
    knots.append((knots[-1][0] + free, 0.0))
    return _along(knots)


def corner_length(turn: float, radius: float, ease: float = EASE_M) -> float:
    """How much of both lines a rounded corner takes, from the corner [m]."""
    arc = _arc(0.0, math.copysign(1 / radius, turn), abs(turn), ease)
    end = _along(arc).at(arc[-1][0])
    return end.x - end.y / math.tan(turn)


def _too_far(length: float) -> SceneError:
    return SceneError(
        f"task.path.waypoints_m: lead {length:.0f} m far; allowed: at most {_LONGEST_M:g} m"
    )


def _sweep(path: Path, way: float, radius: float) -> float:
    """The angle by which an arc turns [rad]: that of the scene, or more than the task needs (an s:
    45°)."""
    if path.angle_deg is not None:
        return math.radians(path.angle_deg)
    if path.kind == "s":
        return math.radians(SWEEP_DEG)
    if way > 2 * math.pi * radius:
        raise SceneError(
            f"task.path.angle_deg: is not set, but {way:.4g} m are more than a circle of radius "
            f"{radius:g} m; allowed: the angle of the arc, or a shorter task.distance_m"
        )
    return way / radius + min(1.0, 20 / radius)


def _arc(start: float, bend: float, sweep: float, ease: float) -> list[tuple[float, float]]:
    """(s, κ) at the corners of an arc with its clothoids, which turns by `sweep` in total.

    Where it turns by less than both clothoids would, they are cut short at a smaller curvature.
    """
    most = sweep / max(ease, 1e-9)  # of |κ|: the two clothoids alone turn by κ ease
    if abs(bend) > most:
        bend = math.copysign(most, bend)
    ease = max(ease, _STEP_M)
    flat = max(0.0, sweep / abs(bend) - ease)
    return [
        (start, 0.0),
        (start + ease, bend),
        (start + ease + flat, bend),
        (start + 2 * ease + flat, 0.0),
    ]


def _integrated(curvature: NDArray[np.float64], step: float) -> Curve:
    """A curve from its curvature: heading and place are its first and second integral."""
    simpson = require("scipy.integrate", "mujoco").cumulative_simpson
    heading = np.concatenate(([0.0], np.cumsum(0.5 * (curvature[1:] + curvature[:-1])) * step))
    x, y = (simpson(f(heading), dx=step, initial=0.0) for f in (np.cos, np.sin))
    return Curve(step, x, y, heading, curvature)


def _through(points: tuple[Point, ...]) -> Curve:
    """The natural cubic spline through points, over the length of their chords."""
    places = np.array(points)
    chords = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))))
    if chords[-1] > _LONGEST_M:
        raise _too_far(chords[-1])
    spline = require("scipy.interpolate", "mujoco").CubicSpline(chords, places, bc_type="natural")
    u = np.linspace(0.0, chords[-1], max(_FINEST, math.ceil(4 * chords[-1] / _STEP_M)) + 1)
    pace = np.hypot(*spline(u, 1).T)
    if pace.min() < 1e-3:
        raise SceneError(
            "task.path.waypoints_m: turns back on the spot; allowed: waypoints that a smooth curve "
            "can follow"
        )
    s = require("scipy.integrate", "mujoco").cumulative_simpson(pace, x=u, initial=0.0)
    even = np.linspace(0.0, s[-1], max(_FINEST, math.ceil(s[-1] / _STEP_M)) + 1)
    u = np.interp(even, s, u)
    (x, y), (dx, dy), (ddx, ddy) = (spline(u, n).T for n in (0, 1, 2))
    heading = np.unwrap(np.arctan2(dy, dx))
    bend = (dx * ddy - dy * ddx) / np.hypot(dx, dy) ** 3
    cos, sin = math.cos(heading[0]), math.sin(heading[0])
    x, y = x - x[0], y - y[0]
    return Curve(float(even[1]), cos * x + sin * y, cos * y - sin * x, heading - heading[0], bend)
