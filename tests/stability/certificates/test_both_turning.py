# SPDX-License-Identifier: Apache-2.0
"""The claims about palms that turn at the same time, against linear programs and plane geometry."""

import copy
import math
from collections import Counter
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from certificate_cases import WIDE_APART, checked, numbers
from clearance_cases import lips, touches
from palmbots._types import SIDES
from palmbots.stability.certificates.obligations import BOTH_TURN
from palmbots.stability.certificates.prover import certify
from sampled import amounts
from statics_oracle import OFF_BY, STICK, State

Array = NDArray[np.float64]

# ---- oracles -------------------------------------------------------------------------------------


def squeezes(state: State) -> tuple[float, float] | None:
    """The least and the greatest squeeze with which both contacts stick; None: there is none.

    A linear program with as many equations less one as unknowns: its feasible set is a piece of the
    line start + t · direction, where no share is negative.
    """
    matrix, wanted = state.balance((STICK, STICK))
    assert matrix.shape == (3, 4)
    _, sizes, directions = np.linalg.svd(matrix)
    assert sizes[-1] > 1e-9 * sizes[0]
    start, direction = np.linalg.pinv(matrix) @ wanted, directions[-1]
    low, high = -math.inf, math.inf
    for at, by in zip(start, direction, strict=True):
        if abs(by) < 1e-12:
            if at < -OFF_BY:
                return None
        elif by > 0:
            low = max(low, -at / by)
        else:
            high = min(high, -at / by)
    if high < low - OFF_BY:
        return None
    inward = matrix[0] * np.array([1, 1, 0, 0])  # the force of the left palm along x
    rise = float(inward @ direction)
    ends = [float(inward @ start) + (t * rise if rise else 0.0) for t in (low, high)]
    return min(ends), max(ends)


def what_fails(state: State) -> set[str]:
    """The claims that do not hold in a state."""
    found = squeezes(state)
    if found is None:
        return {"0 turning"}
    names = {"jam opening": found[0] == -math.inf, "jam closing": found[1] == math.inf}
    return {name for name, jams in names.items() if jams}


def some_state(box: dict[str, Any], rng: np.random.Generator) -> State:
    """A random point of a box, often at its corners."""

    def between(low: float, high: float) -> float:
        share = rng.random() if rng.random() < 0.5 else float(rng.integers(0, 2))
        return low + (high - low) * share

    def sides(key: str) -> tuple[float, float]:
        left, right = (between(*numbers(box[key][side])) for side in SIDES)
        return left, right

    friction = sides("friction")
    if box["friction"]["common"]:
        friction = (friction[0], friction[0])
    low, high = ([numbers(box[key][side]) for side in SIDES] for key in ANGLES)
    theta = [math.radians(between(low[i][0], high[i][1])) for i in (0, 1)]
    corners = np.array([numbers(point) for point in box["com_m"]])
    com = rng.dirichlet(np.full(len(corners), 0.3)) @ corners
    return State(
        width=between(*numbers(box["width_m"])),
        com=(float(com[0]), float(com[1])),
        theta=(theta[0], theta[1]),
        p=sides("contacts_m"),
        friction=friction,
        offset=sides("offset_m"),
        slope=between(*numbers(box["slope"])),
    )


ANGLES = ("shallow_deg", "steep_deg")


def state_of(witness: dict[str, Any]) -> State:
    def sides(key: str) -> tuple[float, float]:
        left, right = numbers(witness[key][side] for side in SIDES)
        return left, right

    theta = [math.radians(angle) for angle in sides("angle_deg")]
    x, y = numbers(witness["com_m"])
    return State(
        width=float(Fraction(witness["width_m"])),
        com=(x, y),
        theta=(theta[0], theta[1]),
        p=sides("contacts_m"),
        friction=sides("friction"),
        offset=sides("offset_m"),
        slope=float(Fraction(witness["slope"])),
    )


def random_case(rng: np.random.Generator, *, sticky: bool) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene and intervals. Sticky palms may jam, the other ones may let the object slide."""

    def around(middle: float, size: float) -> tuple[float, float]:
        half = rng.uniform(0, size)
        return round(middle - half, 5), round(middle + half, 5)

    shallow = float(rng.uniform(-12 if sticky else -4, 9))
    steep = shallow + float(rng.uniform(3, 25))
    friction = rng.uniform(1, 12) if sticky else math.tan(math.radians((steep - shallow) / 2))
    friction *= 1 if sticky else rng.uniform(1.0, 1.8)
    scene = {
        "object": {"com_m": [0.25 * rng.uniform(0.2, 0.8), rng.uniform(0.005, 0.1)]},
        "palm": {
            "length_m": rng.uniform(0.02, 0.16),
            "shallow_deg": round(shallow, 3),
            "steep_deg": round(steep, 3),
            "pivot_offset_m": float(rng.choice([0.0, 0.01])),
        },
        "task": {"slope_deg": float(rng.choice([0.0, rng.uniform(-3, 3)]))},
    }
    given = {
        "friction": around(friction, 0.02 * friction),
        "friction_right": around(friction, 0.02 * friction),
        "com_x_m": around(scene["object"]["com_m"][0], 0.002),
        "shallow_deg": around(shallow, 0.3),
        "steep_deg": around(steep, 0.3),
        "width_m": (0.25, 0.2505),
    }
    return scene, given


# ---- the claims are true -------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("cases", amounts(24, 60))
@pytest.mark.parametrize("sticky", [False, True])
def test_verdicts_agree_with_linear_programs(sticky: bool, cases: int, tmp_path: Path) -> None:
    """What is certified to hold does so at random points of the box; a witness does not."""
    rng = np.random.default_rng(21)
    claims = ("no jam",) if sticky else ("property 0 turning", "no jam")
    verdicts: Counter[str] = Counter()
    for _ in range(cases):
        scene, given = random_case(rng, sticky=sticky)
        found = certify(scene, claims=claims, **given)
        if found.verdict == "undecided":
            verdicts["undecided"] += 1
            continue
        assert checked(found.data, tmp_path).valid
        if found.verdict == "fails":
            witness = found.data["witness"]
            assert what_fails(state_of(witness)) == {witness["claim"]}
            verdicts[witness["claim"]] += 1
            continue
        verdicts["holds"] += 1
        for _ in range(25):
            failing = what_fails(some_state(found.data["box"], rng))
            assert not failing - ({"0 turning"} if sticky else set())
    assert verdicts["holds"] > cases / 4
    assert verdicts["undecided"] < cases / 12
    expected = ("jam closing", "jam opening") if sticky else ("0 turning",)
    assert all(verdicts[name] for name in expected), verdicts


def test_random_points_outside_of_a_proved_box_fail(tmp_path: Path) -> None:
    """The oracle finds the failures that the claims exclude, a little outside of the box."""
    rng = np.random.default_rng(22)
    for name, inside, outside in (
        ("0 turning", (0.09, 0.3), (0.05, 0.08)),
        ("jam closing", (0.3, 3.7), (3.8, 6.0)),
    ):
        claims = ("property 0 turning", "no jam")
        held = certify("paper", friction=inside, region_m=(-0.001, 0.001), claims=claims).data
        assert held["verdict"] == "holds"
        assert checked(held, tmp_path).valid
        assert not any(what_fails(some_state(held["box"], rng)) for _ in range(200))
        beyond = copy.deepcopy(held["box"])
        for side in SIDES:
            beyond["friction"][side] = [str(end) for end in outside]
        failing = Counter(n for _ in range(200) for n in what_fails(some_state(beyond, rng)))
        assert failing[name] > 5


def test_verdicts_change_at_limits_in_closed_form() -> None:
    """A level object slides where the angles differ by more than φ_L + φ_R. Two contacts at equal
    palms are wedged where θ + φ > 90° on closing, and where φ − θ > 90° on opening."""
    level: dict[str, Any] = {"region_m": (0.0, 0.0)}
    for more, verdict in ((1e-6, "holds"), (-1e-6, "fails")):
        least = math.tan(math.radians(5)) + more
        found = certify("paper", claims=("property 0 turning",), friction=(least, 0.4), **level)
        assert found.verdict == verdict
        most = 1 / math.tan(math.radians(15)) - more
        found = certify("paper", claims=("no jam",), friction=(0.3, most), **level)
        assert found.verdict == verdict
        most = 1 / math.tan(math.radians(10)) - more
        angles: dict[str, Any] = {"shallow_deg": (-10.0, -10.0), "steep_deg": (0.0, 5.0)}
        found = certify("paper", claims=("no jam",), friction=(0.3, most), **angles, **level)
        assert found.verdict == verdict
        if verdict == "fails":
            assert found.data["witness"]["claim"] == "jam opening"


def test_new_claims_say_more_than_those_of_one_palm() -> None:
    """What holds while one palm turns may fail while both do."""
    assert certify(WIDE_APART, claims=("property 0",)).verdict == "holds"
    found = certify(WIDE_APART, claims=("property 0 turning",))
    assert found.verdict == "fails"
    assert what_fails(state_of(found.data["witness"])) == {"0 turning"}
    for name in BOTH_TURN:
        assert certify("paper", claims=(name,)).verdict == "holds"


@pytest.mark.parametrize("cases", amounts(12, 25))
def test_clearance_while_both_turn_is_that_of_the_outline(cases: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(23)
    verdicts: Counter[str] = Counter()
    for _ in range(cases):
        scene = lips(round(float(rng.uniform(0.015, 0.035)), 4))
        half = round(float(rng.uniform(0.002, 0.03)), 4)
        length = (0.15, round(float(rng.uniform(0.155, 0.2)), 4))
        found = certify(
            scene, claims=("clearance turning",), region_m=(-half, half), length_m=length
        )
        verdicts[found.verdict] += 1
        if found.verdict != "undecided":
            assert checked(found.data, tmp_path).valid
        if found.verdict == "holds":
            assert not touched(found.data["box"], rng, 300).any()
        elif found.verdict == "fails":
            assert touched_at(found.data["box"], found.data["witness"])
    assert verdicts["holds"] > cases / 5
    assert verdicts["fails"] > cases / 5


def touched(box: dict[str, Any], rng: np.random.Generator, n: int) -> NDArray[np.bool_]:
    """Whether palms at random angles touch, with both contacts outward or both inward."""

    def anything(low: float, high: float) -> Array:
        share = np.where(rng.random(n) < 0.5, rng.integers(0, 2, n), rng.random(n))
        return low + (high - low) * share

    outward = rng.random(n) < 0.5
    angles, p = [], []
    for side in SIDES:
        low, high = numbers(box["contacts_m"][side])
        angles.append(anything(*numbers((box["shallow_deg"][side][0], box["steep_deg"][side][1]))))
        p.append(np.where(outward, anything(0, high), anything(low, 0)))
    found = np.zeros(n, dtype=bool)
    for k in range(n):
        found[k] = _touches(box, [a[k] for a in angles], [c[k] for c in p])
    return found


def touched_at(box: dict[str, Any], witness: dict[str, Any]) -> bool:
    angles, p = (numbers(witness[key].values()) for key in ("angle_deg", "contacts_m"))
    assert p[0] * p[1] >= 0
    return _touches(box, angles, p)


def _touches(box: dict[str, Any], angles_deg: list[float], p: list[float]) -> bool:
    theta = np.radians(angles_deg)
    tilt = math.asin((p[1] * math.sin(theta[1]) - p[0] * math.sin(theta[0])) / 0.25)
    for i, side in enumerate(SIDES):
        outline = np.array([numbers((v[i], v[2])) for v in box["outline_m"]])
        half = numbers(box["half_length_m"][side])[1]
        alpha = theta[i] + (tilt if i == 0 else -tilt)
        if touches(outline, alpha, np.array(half + p[i]), np.array(half - p[i]))[0]:
            return True
    return False


# ---- why the claims are needed -------------------------------------------------------------------


@pytest.mark.parametrize(
    "controller", ["centralized", "distributed", "resilient", "silent", "shared-sign"]
)
def test_controllers_on_the_robots_turn_both_palms_at_once(controller: str) -> None:
    """In more than 5 % of the ticks; contacts of opposite signs are then close to one pivot."""
    traces = [pb.carry("paper", controller, seed=seed).trace for seed in range(20)]
    palms, contacts = (
        np.concatenate([trace[key] for trace in traces if trace is not None])
        for key in ("palm", "contact")
    )
    both_turn = np.all((palms > np.radians(5.01)) & (palms < np.radians(14.99)), axis=1)
    left, right = contacts[both_turn].T
    opposite = np.where(left * right < 0, np.minimum(abs(left), abs(right)), 0.0)
    assert (both_turn.mean() > 0.05) == (controller != "centralized")
    assert opposite.max(initial=0.0) < 0.01
