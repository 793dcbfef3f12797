# SPDX-License-Identifier: Apache-2.0
"""Design of the palm angles: those that tolerate the most noise, or the largest error of a
quantity.

Every pair of angles has to have properties 0, 1 and 2 over a given uncertainty, for the contacts
that the scene's zones, speeds, latencies and tilt times imply at that pair (`reaction_region`) or
for given ones. By default the pair with the greatest σ* is chosen among them: steeper palms often
tolerate larger errors, but take longer to turn, and then carries fail. σ* includes the controller,
the palm rate and the reaction time, because it is measured in carries (`delivery_race`). The result
contains a certificate. Source: docs/theory/stability.md; paper, section 5.1 ("shallow enough that
our system would have enough time to react").
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias, TypedDict, Unpack, cast

import numpy as np

from palmbots._types import SIDES, FilePath, Interval, Overrides, Region
from palmbots._util.arguments import one_of, ordered_pair, seed_of
from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots._util.time_left import TimeLeft, announced
from palmbots.control.registry import (
    ControllerEntry,
    ControllerLike,
    refuse_reference,
    resolve,
)
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.batch import available_cores
from palmbots.simulation.noise_limit import NoiseLimit
from palmbots.stability.angle_certificate import certify_tolerance, scene_at
from palmbots.stability.angle_grid import (
    LIFT,
    NOISE,
    QUANTITIES,
    AngleGrid,
    GridLimits,
    Objective,
    Quantity,
    Uncertainty,
    evaluate,
    tolerance_at,
)
from palmbots.stability.certificates.box_from_scene import slope_interval
from palmbots.stability.clearance import outline_clearance
from palmbots.stability.delivery_race import Race, run_race
from palmbots.stability.delivery_race import expected_carries as race_carries
from palmbots.stability.design_carries import (
    REST_S,
    carries_of_measurement,
    carry_s_of,
    counted,
    measured,
    time_line,
)
from palmbots.stability.design_result import Design, OwnAngles, ReactionTimes
from palmbots.stability.interval_sets import around
from palmbots.stability.margins import friction_ranges
from palmbots.stability.plate_design import design_plate
from palmbots.stability.plate_search import PlateLimits, is_on_floor
from palmbots.stability.probed_object import uncertainty_of, with_probed
from palmbots.stability.problem import StabilityProblem, stability_problem
from palmbots.stability.reaction_region import implied_reach_m, reaction

PAPER_DEG = (5.0, 15.0)
"""The paper's palm angles (shallow, steep), for comparison."""

Range: TypeAlias = Interval | None
Hook: TypeAlias = Callable[..., None] | None

_TYPICAL_SLOPE = 4.0


class GridOptions(TypedDict, total=False):
    """The grid of angles, and of plates for ``lift``, as `palmbots.design` takes it."""

    min_angle_difference_deg: float
    """Smallest difference of the two angles; None: 5. It is assumed for all objects."""
    min_clearance_deg: float
    """Smallest clearance between outline and palms; None: 0.25."""
    angle_range_deg: Interval
    """Limits of both angles; None: -5 to 50."""
    resolution_deg: float | None
    """Spacing of the angle grid; None: 0.1 for com, otherwise 0.5."""
    nose_range_m: Interval
    """Limits of ``palm.nose_m`` for lift; None: 0.0002 to 0.001. No nose is thicker than the
    plate."""
    bevel_range_m: Interval
    """Limits of ``palm.bevel_m`` for lift; None: 0 to 0.02."""
    heel_range_m: Interval
    """Limits of ``palm.heel_m`` for lift; None: 0 to 0.02."""


@command(
    order=60,
    example="palmbots design --friction 0.3 0.4 --region palm --out out",
    progress="designing",
    failure=(
        "is_sound",
        "the tolerance could not be certified, or a designed plate fails more often",
    ),
    maximize=Option(metavar="NAME"),
    friction=Option(),
    probe=Option("--from", metavar="PROBE"),
    common_friction=Option("--common-friction/--independent-friction"),
    com_y_m=Option(),
    slope_deg=Option(),
    region_m=Option("--region", metavar="implied|palm|LOW,HIGH"),
    grid=Option(),
)
def design(
    scene: SceneLike = "paper",
    *,
    maximize: str | None = None,
    controller: ControllerLike | None = "distributed",
    friction: Range = None,
    common_friction: bool = False,
    com_y_m: Range = None,
    slope_deg: Range = None,
    region_m: Region = "implied",
    probe: FilePath | None = None,
    seed: int = 0,
    overrides: Overrides = None,
    on_progress: Hook = None,
    on_line: Hook = None,
    **grid: Unpack[GridOptions],
) -> Design:
    """Find and certify the most noise-tolerant palm angles.

    `maximize` selects another quantity, whose permitted error is maximized instead of the noise.
    For a job on the floor, the command also designs the plate of the palms.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        maximize: ``noise``, ``lift``, or a tolerance: com, friction, slope, acceleration, region or
            angle; None: lift for a job on the floor, otherwise noise. ``noise`` is the speed noise
            at which 1 % of carries drop the object (σ*); a tolerance is the error of one of
            `QUANTITIES`. ``lift`` finds the nose, bevel and heel of the palms and the angles at
            which the tightest margin of `analyze` is largest, and simulates jobs with them.
        controller: the shipped controller whose σ* is measured, or that does the simulated jobs;
            None: no σ*, no jobs. ``noise`` needs one.
        friction: friction coefficient; None: as in the scene.
        common_friction: use one friction for both palms, or one for each. With one for both, it
            may be any of the interval.
        com_y_m: height of the COM above the contacts; None: as in the scene.
        slope_deg: slope of the floor, uphill > 0; None: as in the scene. Uphill refers to
            the direction of travel; the limits are -45 and 45.
        region_m: contact coordinates: what the scene implies, the whole palm, or an interval [m].
            The properties have to hold for them; the scene implies others at each pair of angles.
        probe: file of palmbots probe with intervals of COM and friction; None: as in the scene.
        seed: random seed of the carries.
        overrides: scene keys to set.
        on_progress: called with the completed fraction, which follows the time on this machine.
        on_line: called with a line about how long the design takes, as soon as it is known.
        grid: as `palmbots.stability.GridOptions` describes it.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: an argument is out of range, no pair of angles qualifies, or the controller
            refuses all of them.
        MissingExtra: python-flint is not installed.
    """
    chosen, touched = with_probed(load_scene(scene, overrides), probe, common_friction)
    if maximize is None:
        maximize = LIFT if is_on_floor(chosen) else NOISE
    one_of("maximize", maximize, (NOISE, LIFT, *QUANTITIES))
    objective = cast("Objective", maximize)
    entry = _entry(controller, objective)
    seed = seed_of(seed)
    report, say = on_progress or (lambda fraction: None), on_line or (lambda line: None)
    quantity: Quantity = "com" if objective in (NOISE, LIFT) else objective
    own_deg = _own_angles(chosen)
    limits = _limits(grid, objective, own_deg)
    if maximize == LIFT:
        given = (friction, com_y_m, slope_deg, probe, None if region_m == "implied" else region_m)
        if common_friction or any(one is not None for one in given):
            raise PalmbotsError(
                "friction, com_y_m, slope_deg, region_m, from: allowed with lift: no value; the "
                "margins are those of the scene for contacts anywhere on the palms"
            )
        announcing = announced(report, say, "the design")
        return design_plate(chosen, entry, PlateLimits.of(grid, limits), own_deg, announcing)
    problem = _problem(chosen, region_m)
    uncertainty = Uncertainty(
        _frictions(problem, friction, common_friction),
        common_friction,
        None if com_y_m is None else ordered_pair("com_y_m", com_y_m, -10, 10),
        None if slope_deg is None else _floats(slope_interval(chosen, slope_deg)),
    )
    uncertainty = uncertainty_of(touched, uncertainty, friction is not None).counted_from(
        problem.com_shift
    )
    implied = None
    is_implied = isinstance(region_m, str) and region_m == "implied"
    if is_implied:
        radians = np.radians(limits.angles_deg())
        implied = reaction(chosen, *np.meshgrid(radians, radians, indexing="ij"))
        problem = problem.with_(beyond=implied.beyond_m)
    require("flint", "certify")  # of the certificate: missed before the work, not after it
    left = TimeLeft(report, ("own", "race", "designed", "rest"))
    found = evaluate(problem, quantity, limits, uncertainty, implied)
    of_race = race_carries(found) if objective == NOISE else 0
    if entry is not None:
        carry_s = carry_s_of(chosen, entry)
        expected_s = carries_of_measurement(objective) * carry_s
        left.expect(own=expected_s, race=of_race * carry_s, designed=expected_s, rest=REST_S)
        if line := time_line(objective, left.total_s, carry_s):
            say(line)

    own_limit = measured(chosen, entry, seed, objective, left.begin("own"))
    if own_limit is not None:
        own_s = left.spent_s()
        carry_s = own_s / (own_limit.pilot_carries + own_limit.carries)
        left.expect(race=of_race * carry_s, designed=own_s)
    row, column, race = *found.best(), None
    if objective == NOISE and entry is not None:
        race = _race(chosen, entry, found, own_deg, own_limit, seed, left.begin("race"))
        row, column = race.best
    pair_deg = (float(found.degrees[row]), float(found.degrees[column]))
    designed = scene_at(chosen, pair_deg)
    limit = measured(designed, entry, seed, objective, left.begin("designed"))
    left.begin("rest")

    pair = (math.radians(pair_deg[0]), math.radians(pair_deg[1]))
    times = reaction(chosen, *pair)
    answer = problem.with_(angles=(pair, pair))
    if found.reach_m is not None:
        reach = float(found.reach_m[row, column])
        answer = answer.with_(contacts=((-reach, reach), (-reach, reach)))
    interval = _friction_interval(answer, uncertainty.friction)
    certificate, tolerance = certify_tolerance(
        chosen, answer, quantity, float(found.tolerance[row, column]), pair_deg, uncertainty
    )
    own_tolerance = None
    if own_deg is not None:
        at_own = reaction(chosen, *np.radians(own_deg)) if is_implied else None
        own_tolerance = tolerance_at(problem, quantity, own_deg, uncertainty, at_own)
    counts, own_counts = counted(designed, entry), counted(chosen, entry)
    report(1.0)
    return Design(
        scene=chosen,
        maximize=objective,
        shallow_deg=pair_deg[0],
        steep_deg=pair_deg[1],
        tolerance=tolerance,
        clearance_deg=float(found.clearance_deg[row, column]),
        friction=interval,
        friction_floor=interval[0] if interval else None,
        reaction_s=ReactionTimes(float(times.own_s), float(times.asked_s)),
        reach_m=float(times.reach_m),
        region_m=answer.contacts[0],
        noise_limit=limit,
        counts=counts,
        words=entry.spelled if entry is not None else "",
        own=OwnAngles(
            own_deg,
            own_tolerance,
            own_limit,
            _clearance_deg(problem, chosen if is_implied else None),
            own_counts,
        ),
        paper_tolerance=found.tolerance_at(*PAPER_DEG),
        certificate=certificate,
        map=found.dataset(quantity, limits, None if race is None else race.sigma_m_s),
        designed_scene=designed,
    )


def _entry(controller: ControllerLike | None, objective: Objective) -> ControllerEntry | None:
    if controller is None:
        if objective == NOISE:
            raise PalmbotsError("controller: value is null; allowed with noise: a controller")
        return None
    entry = resolve(controller)
    refuse_reference(entry, "a design")
    if entry.is_python:
        raise PalmbotsError(
            f"controller: {entry.name} is in Python, and a design takes several hundred thousand "
            "carries; allowed: a shipped controller or a policy file"
        )
    return entry


def _limits(given: GridOptions, objective: Objective, own_deg: Interval | None) -> GridLimits:
    for name in given:
        one_of("design", name, tuple(GridOptions.__annotations__))
    resolution_deg = given.get("resolution_deg")
    if resolution_deg is None:
        resolution_deg = 0.1 if objective == "com" else 0.5
    return GridLimits(
        given.get("angle_range_deg", (-5.0, 50.0)),
        resolution_deg,
        given.get("min_angle_difference_deg", 5.0),
        given.get("min_clearance_deg", 0.25),
        own_deg or () if objective == NOISE else (),
    )


def _own_angles(scene: Scene) -> Interval | None:
    left, right = ((p.shallow_deg, p.steep_deg) for p in map(scene.palm_of, SIDES))
    return left if left == right else None


def _clearance_deg(problem: StabilityProblem, implying: Scene | None) -> float:
    """The clearance at the scene's own angles, for the contacts that a scene implies if given."""
    if implying is not None:
        reach = implied_reach_m(implying)
        problem = problem.with_(contacts=((-reach, reach), (-reach, reach)))
    return math.degrees(outline_clearance(problem).rotation_margin.margin)


def _race(
    scene: Scene,
    entry: ControllerEntry,
    grid: AngleGrid,
    own_deg: Interval | None,
    own_limit: NoiseLimit | None,
    seed: int,
    report: Callable[[float], None],
) -> Race:
    start = (scene.robot.noise_m_s or 0.01, _TYPICAL_SLOPE)
    if own_limit is not None:
        start = (own_limit.sigma_star_m_s, own_limit.slope)
    return run_race(
        scene,
        entry,
        grid,
        None if own_deg is None else grid.place_of(*own_deg),
        start,
        seed=seed,
        threads=available_cores(),
        report=report,
    )


def _problem(scene: Scene, region_m: Region) -> StabilityProblem:
    # The implied region differs from pair to pair of angles: `evaluate` takes it.
    if isinstance(region_m, str) and region_m == "implied":
        region_m = "palm"
    return stability_problem(scene, region_m)


def _floats(ends: tuple[Any, Any]) -> Interval:
    return float(ends[0]), float(ends[1])


def _frictions(
    problem: StabilityProblem, friction: Interval | None, common: bool
) -> tuple[Interval, Interval]:
    """The intervals of both palms."""
    if friction is not None:
        interval = ordered_pair("friction", friction, 0, 100)
        return interval, interval
    left, right = problem.friction
    if common and left != right:
        raise PalmbotsError(
            "common_friction: the scene's palms have different coefficients, "
            f"{left:g} and {right:g}; give the interval of a common one as friction, or choose "
            "independent friction"
        )
    return (left, left), (right, right)


def _friction_interval(
    problem: StabilityProblem, frictions: tuple[Interval, Interval]
) -> Interval | None:
    middle = sum(end for pair in frictions for end in pair) / 4
    return around(friction_ranges(problem.with_(friction=(middle, middle))), middle)


def with_angles(scene: Scene, result: Design) -> Scene:
    """The scene with the designed angles on both palms."""
    return scene_at(scene, (result.shallow_deg, result.steep_deg))
