# SPDX-License-Identifier: Apache-2.0
"""The controllers `optimal` and `optimal-stopping`: references with full information.

Their wheels follow the solution of the opening problem, and their palms bring the difference of the
contacts to zero (`optimum/optimal_team.hpp`). They read the state of the quasistatic world, so no
robot can run them. They show how near the bound a controller can come.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

from palmbots.control.registry import ControllerEntry
from palmbots.optimum.opening import (
    COARSE,
    FINE,
    OpeningProblem,
    OptimalController,
    Spec,
    best_price,
    law_m_s,
    opening_problem,
    solve,
)

_RESOLVED = 0.8
"""Least noise of a policy, as a fraction of the design law. At less noise all drop rates are so
small that rounding would decide."""


_FIELDS = (
    "lowest", "highest", "start", "slowest", "fastest", "change", "bias", "noise", "memory",
    "period", "duration", "distance", "most",
)  # fmt: skip


def _optimal(spec: Spec) -> OptimalController:
    return _controller(spec, "corrections")


def _optimal_stopping(spec: Spec) -> OptimalController:
    return _controller(spec, "stopping")


def _controller(spec: Spec, speeds: str) -> OptimalController:
    problem = opening_problem(spec, speeds)
    tau = max(robot.noise_tau for robot in spec.robots)
    if tau > 0:  # the law is for each of two robots with equal noise
        problem.noise = max(problem.noise, _RESOLVED * math.sqrt(2) * law_m_s(problem, tau))
    if speeds == "stopping":
        # One robot stays as fast as it can be: only the other one changes the opening speed.
        problem.change = problem.period * min(robot.acceleration for robot in spec.robots)
    return _policy(tuple(getattr(problem, name) for name in _FIELDS), speeds == "stopping")


@lru_cache(maxsize=16)
def _policy(values: tuple[Any, ...], may_stop: bool) -> OptimalController:
    """The policy of the problem with these fields."""
    problem = OpeningProblem()
    for name, value in zip(_FIELDS, values, strict=True):
        setattr(problem, name, value)
    if may_stop:
        best_price(problem, COARSE)  # the price stays in the problem
    grid = FINE.coarser("noises") if may_stop else FINE
    return OptimalController(solve(problem, grid).policy, may_stop)


def _entry(name: str, description: str, maker: Any) -> ControllerEntry:
    return ControllerEntry(
        name,
        f"reference with full information: {description}",
        uses_radio=False,
        policy_maker=maker,
        preparation="the least drop rate for every state of the pair",
    )


OPTIMAL = _entry("optimal", "the fewest drops with corrections only", _optimal)
OPTIMAL_STOPPING = _entry(
    "optimal-stopping", "the fewest drops where robots may stop", _optimal_stopping
)
