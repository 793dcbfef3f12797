# SPDX-License-Identifier: Apache-2.0
"""Carries of a design: measurements of σ*, counts of outcomes, and how long they take."""

import time
from collections.abc import Callable

from palmbots._util.text import duration
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene
from palmbots.simulation.noise_limit import NoiseLimit, expected_carries, noise_limit
from palmbots.simulation.outcome_counts import OutcomeCounts, carry_seeds, count_outcomes
from palmbots.simulation.prepare import prepare
from palmbots.stability.angle_grid import NOISE, Objective

_PRECISE, _COARSE = 0.015, 0.03
"""Relative half-width of the interval of σ*, where it is the objective and where it is a
by-product."""
_RATE = 0.01
"""Share of drops that defines σ*."""
_SAMPLE, _MOST_SAMPLE, _SAMPLE_S = 200, 20_000, 0.2
"""Carries from which the time of the design is estimated: at least and at most this many, until
they take this long [s]."""
_USUAL_CARRY_S = 3e-4
_MOMENT_S, _LONG_S = 2.0, 60.0
REST_S = 3.0
"""About how long the certificate of a design and the counts of outcomes take."""
_QUICKER: Objective = "angle"


def measured(
    scene: Scene,
    entry: ControllerEntry | None,
    seed: int,
    objective: Objective,
    report: Callable[[float], None],
) -> NoiseLimit | None:
    """σ* of a scene; None where there is no controller, it refuses the scene, or there is no σ*."""
    if entry is None:
        return None
    try:
        return noise_limit(
            scene,
            entry,
            relative_half_width=_half_width(objective),
            seed=seed,
            on_progress=report,
        )
    except SceneError:
        return None
    except PalmbotsError as error:
        if not str(error).startswith("noise-limit"):
            raise
        return None


def _half_width(objective: Objective) -> float:
    return _PRECISE if objective == NOISE else _COARSE


def carries_of_measurement(objective: Objective) -> int:
    """How many carries `measured` takes, about."""
    return expected_carries(_RATE, _half_width(objective))


def time_line(objective: Objective, total_s: float, carry_s: float) -> str:
    """How long a design takes, and what is quicker; empty: it takes a moment."""
    if total_s <= _MOMENT_S:
        return ""
    line = f"the design takes about {_rounded(total_s)}"
    quick_s = 2 * carries_of_measurement(_QUICKER) * carry_s + REST_S
    if objective == NOISE and total_s > _LONG_S:
        line += f"; --maximize {_QUICKER}, which compares pairs without carries, "
        line += f"takes about {_rounded(quick_s)}"
    return line


def _rounded(seconds: float) -> str:
    return duration(float(f"{seconds:.2g}"))


def carry_s_of(scene: Scene, entry: ControllerEntry) -> float:
    """How long one of many carries takes on this machine."""
    try:
        prepared = prepare(scene, entry)
    except SceneError:  # the controller refuses the scene's own angles
        return _USUAL_CARRY_S
    count, spent_s = _SAMPLE, 0.0
    while spent_s < _SAMPLE_S and count < _MOST_SAMPLE:  # few carries are slower: threads start
        begin = time.monotonic()
        carry_seeds(prepared, 0, count)
        spent_s, count = time.monotonic() - begin, 3 * count
    return 3 * spent_s / count


def counted(scene: Scene, entry: ControllerEntry | None) -> OutcomeCounts | None:
    """How carries of a scene end; None where there is no controller, or it refuses the scene."""
    try:
        return None if entry is None else count_outcomes(scene, entry)
    except SceneError:
        return None
