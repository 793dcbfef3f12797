# SPDX-License-Identifier: Apache-2.0
"""The opening problem of a scene, and its solution by value iteration in the compiled core.

What remains of a carry is the separation of the robots, which noise must not drive beyond the ends
of the palms (docs/theory/optimum.md). Two sets of speeds are admissible:

``corrections``
    The robots travel at their nominal speed and add equal and opposite corrections. The carry takes
    its nominal time.
``stopping``
    Each robot has any speed from its correction backwards to nominal speed plus correction. Speed
    costs safety, so the time of the carry is optimized too.

Both describe robots that keep driving: one that stands with its brakes on has less noise or none.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

from palmbots._core import LinearFeedback as LinearFeedback
from palmbots._core import OpeningProblem as OpeningProblem
from palmbots._core import OpeningSolution as OpeningSolution
from palmbots._core import OptimalController as OptimalController
from palmbots._core import Spec as Spec
from palmbots._core import StandingFeedback as StandingFeedback
from palmbots._core import opening_problem as _opening_problem
from palmbots._core import solve_opening as _solve_opening
from palmbots._util.arguments import one_of
from palmbots.errors import SceneError
from palmbots.scene.recorded_traces import refuse_traces
from palmbots.scene.scene import Scene
from palmbots.scene.spec import refuse_low_noses, refuse_rounded_contacts

Speeds = Literal["corrections", "stopping"]
SPEEDS: tuple[str, ...] = get_args(Speeds)

_MOST_PRICES = 8  # the iteration converges in two or three
_PRICE_ACCURACY = 1e-2  # a relative error of this size costs less than 1e-4 of the drop rate
_LEAST_PRICE = 1e-9  # drops per metre
_NEVER = 1e-9  # drops per second
_ROUNDING_M = 1e-9  # of an outline


@dataclass(frozen=True)
class Grid:
    """How finely the state is divided (`OpeningGrid` of the core)."""

    positions: int
    """Intervals of the separation."""
    noises: int
    """Intervals of the noise, from −5 to 5 standard deviations."""
    speeds: float
    """Intervals of the commanded speed that a decision can change it by."""

    def coarser(self, name: str) -> Grid:
        """Half as many intervals of one of the three."""
        value = getattr(self, name)
        return replace(self, **{name: value / 2 if isinstance(value, float) else value // 2})


FINE = Grid(160, 80, 1.0)
COARSE = Grid(80, 40, 1.0)
"""For what needs no accuracy: a first search, the price of progress, the front."""


def refuse_unfit(scene: Scene) -> None:
    """Raise `SceneError` for a scene that the opening problem cannot describe."""
    if scene.bumps.script or scene.bumps.rate_per_m > 0 or scene.bumps.pushes:
        raise SceneError("bumps: the bound does not cover them; allowed: no bumps and no pushes")
    if scene.faults.random_reboots or any(
        fault.kind in {"reboot", "freeze"} for fault in scene.faults.script
    ):
        raise SceneError(
            "faults: a robot that reboots or freezes may stand, and the bound covers only "
            "robots that drive; allowed: other faults"
        )
    refuse_traces(scene, "the bound does")
    left, right = scene.robot_of("left"), scene.robot_of("right")
    for key, usual in (("gain", 1.0), ("gain_sd", 0.0), ("white_noise_m_per_sqrt_s", 0.0)):
        for robot in (left, right):
            if (value := getattr(robot, key)) != usual:
                raise SceneError(
                    f"robot.{key}: value is {value:g}, and the bound does not cover it; "
                    f"allowed: {usual:g}"
                )
    differ = left.noise_tau_s != right.noise_tau_s
    if differ and left.noise_m_s > 0 and right.noise_m_s > 0:
        raise SceneError(
            f"robot.noise_tau_s: {left.noise_tau_s:g} (left) and {right.noise_tau_s:g} (right) "
            "differ; allowed: the same for both robots"
        )
    if left.speed_m_s + right.speed_m_s + left.bias_m_s + right.bias_m_s <= 0:
        raise SceneError(
            "robot.bias_m_s: the pair does not travel forwards; allowed: less bias than speed"
        )
    refuse_rounded_contacts(scene)
    refuse_low_noses(scene)
    _refuse_outline(scene)


def _refuse_outline(scene: Scene) -> None:
    """Refuse an outline that can rest on a palm's tip, or flat on a palm, beyond its contacts."""
    body = scene.object
    (ox, oy), (rx, ry) = (body.vertices_m[k] for k in body.contacts)
    width = body.width_m
    along = ((rx - ox) / width, (ry - oy) / width)
    for index, (x, y) in enumerate(body.vertices_m):
        forward = (x - ox) * along[0] + (y - oy) * along[1]
        up = (y - oy) * along[0] - (x - ox) * along[1]
        if up < -_ROUNDING_M or not -_ROUNDING_M <= forward <= width + _ROUNDING_M:
            raise SceneError(
                f"object.vertices_m: vertex {index} lies below or beyond the contacts, so the "
                "object can rest on other points; allowed: outlines above and between their "
                "contacts"
            )


def opening_problem(spec: Spec, speeds: str) -> OpeningProblem:
    """The opening problem of a spec."""
    one_of("speeds", speeds, SPEEDS)
    return _opening_problem(spec, speeds)


def solve(problem: OpeningProblem, grid: Grid) -> OpeningSolution:
    """Solve it on a grid."""
    return _solve_opening(problem, grid.positions, grid.noises, grid.speeds)


def best_price(
    problem: OpeningProblem,
    grid: Grid,
    report: Callable[[Any], None] = lambda solution: None,
) -> OpeningSolution:
    """The solution with the fewest drops per metre, whatever time the carry takes.

    Its price of progress is its own rate of drops per metre (Dinkelbach's method for ratios: W.
    Dinkelbach, On nonlinear fractional programming, Management Science 13, 1967). The price stays
    in the problem.
    """
    if problem.price <= 0:
        problem.price = _LEAST_PRICE
    attempts = 0
    while True:
        solution = solve(problem, grid)
        report(solution)
        attempts += 1
        if solution.hazard < _NEVER or solution.speed <= 0:
            return solution
        price = max(solution.hazard / solution.speed, _LEAST_PRICE)
        if abs(price - problem.price) <= _PRICE_ACCURACY * price or attempts == _MOST_PRICES:
            return solution
        problem.price = price


def law_m_s(problem: OpeningProblem, tau_s: float) -> float:
    """The design law √(u L / 11 τ) [m/s], for two robots with equal noise; τ = 0: infinity.

    u is the greatest opening speed and L half of the interval of the separation.
    """
    if tau_s <= 0:
        return math.inf
    u = (problem.fastest - problem.slowest) / 2
    usable = (problem.highest - problem.lowest) / 2
    return math.sqrt(u * usable / (11 * tau_s))
