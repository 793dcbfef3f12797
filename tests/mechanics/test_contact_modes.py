# SPDX-License-Identifier: Apache-2.0
"""Contact modes and squeeze intervals against a linear program over the friction cones."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.mechanics.contact_modes import CONTACT_MODES as NAMES
from statics_oracle import DOWN, MODES, STICK, UP, State, balanced_modes, random_state

STATES = 1000
# Squeezes (in units of the weight) closer than this are equal but for rounding.
NEAR = 1e-6


def name(mode: tuple[str, str]) -> tuple[str, str]:
    """The paper's name: up is SL on the left palm and SR on the right one."""
    left = {STICK: "ST", UP: "SL", DOWN: "SR"}
    right = {STICK: "ST", UP: "SR", DOWN: "SL"}
    return left[mode[0]], right[mode[1]]


@pytest.fixture(scope="module")
def drawn() -> tuple[list[State], pb.mechanics.ContactModesBatch]:
    rng = np.random.default_rng(1998)
    states = [random_state(rng) for _ in range(STATES)]
    columns = {key: np.array([s.arguments()[key] for s in states]) for key in states[0].arguments()}
    return states, pb.contact_modes_batch(**columns)


@pytest.fixture(scope="module")
def balanced(drawn) -> list[set[tuple[str, str]]]:
    """The contact modes that balance, for each random state."""
    return balanced_modes(drawn[0])


def near_a_boundary(ends: np.ndarray) -> bool:
    """Whether any two ends of the squeeze intervals (almost) coincide."""
    finite = np.sort(ends[np.isfinite(ends)])
    return bool(np.any(np.diff(finite) < NEAR * (1 + np.abs(finite[1:]))))


def test_feasibility_of_all_nine_modes(drawn, balanced) -> None:
    states, result = drawn
    left_out = 0
    for i, state in enumerate(states):
        if near_a_boundary(result.squeeze[i]):
            left_out += 1
            continue
        ours = {NAMES[k] for k in np.flatnonzero(result.feasible[i])}
        theirs = {name(mode) for mode in balanced[i]}
        assert ours == theirs, state
    assert left_out < 0.02 * STATES


def test_random_states_cover_all_cases(drawn) -> None:
    states, result = drawn
    held = np.any(result.feasible, axis=1)
    assert 0.2 < held.mean() < 0.95
    above = [math.atan(s.friction[0]) > s.theta[0] for s in states]
    assert 0.2 < np.mean(above) < 0.95
    assert np.isinf(result.squeeze).any()


def test_ends_of_the_squeeze_intervals(drawn) -> None:
    states, result = drawn
    for i in range(0, STATES, 10):
        for side in (0, 1):
            low, high = result.squeeze[i, side]
            theirs = states[i].squeeze(side)
            if theirs is None:
                assert low > high, states[i]
                continue
            assert (low, high) == pytest.approx(theirs, rel=1e-6, abs=1e-8), states[i]


def test_occurring_mode_is_balanced_and_consistent(drawn, balanced) -> None:
    """Section 3.1: of nine contact modes three balance, five are consistent, one is both."""
    states, result = drawn
    counted = 0
    for i, state in enumerate(states):
        ends = result.squeeze[i]
        if near_a_boundary(ends) or not np.isfinite(ends).all() or not result.feasible[i].any():
            continue
        inside = 0 < state.com[0] < state.width and abs(state.slope) < 0.05
        if not inside:
            continue
        for direction, happens in ((UP, result.closing[i]), (DOWN, result.opening[i])):
            consistent = {mode for mode in MODES if direction in mode}
            assert len(consistent) == 5
            both = balanced[i] & consistent
            if len(balanced[i]) == 3 and len(both) == 1:
                counted += 1
                assert NAMES[happens] == name(both.pop()), state
    assert counted > 0.3 * STATES


def test_occurring_mode_balances_where_ends_of_intervals_coincide() -> None:
    """Level palms, no friction, contacts at the pivots, equal palms, the COM at their middle."""
    friction, theta, p = (0.0, 0.3, 0.5), (0.0, 0.1, 0.3), (-0.05, 0.0, 0.05)
    grid = np.meshgrid((0.0625, 0.125), theta, theta, friction, friction, p, p)
    keys = (f"{key}_{side}" for key in ("theta", "friction", "p") for side in ("left", "right"))
    columns = dict(zip(("com_x", *keys), grid, strict=True))
    result = pb.contact_modes_batch(width=0.25, com_y=0.04, **columns)
    for happens in (result.closing, result.opening):
        states = np.nonzero(happens >= 0)
        assert len(states[0]) > 500
        assert result.feasible[*states, happens[states]].all()


def test_counts_of_modes_in_the_paper() -> None:
    """Figure 3(b): the left palm shallow, the palms pushed together."""
    result = pb.contact_modes("paper", theta_left_deg=5)
    assert len(NAMES) == 9
    assert len(result.feasible) == 3
    assert len(result.consistent_closing) == 5
    assert set(result.feasible) & set(result.consistent_closing) == {("SL", "ST")}
    assert result.closing == ("SL", "ST")  # property 1
    assert result.opening == ("ST", "SL")  # property 2


@pytest.mark.parametrize(
    ("friction", "band"),
    [
        (0.2, (0.1019, 0.2007)),
        (0.3, (0.1084, 0.2178)),
        (0.4, (0.1128, 0.1787)),
        (0.5, (0.1160, 0.1646)),
    ],
)
def test_com_intervals_of_section_7(friction: float, band: tuple[float, float]) -> None:
    """The COMs for which properties 1 and 2 hold over the palm, left palm shallow."""
    reach = 0.075
    grid = np.linspace(-reach, reach, 11)
    left, right = np.meshgrid(grid, grid, indexing="ij")
    com = np.arange(0.09, 0.23, 0.0001)
    result = pb.contact_modes_batch(
        width=0.25,
        com_x=com[:, None, None],
        com_y=0.04,
        theta_left=math.radians(5),
        theta_right=math.radians(15),
        p_left=left,
        p_right=right,
        friction_left=friction,
        friction_right=friction,
    )
    first = (result.closing == NAMES.index(("SL", "ST"))) | (left > 0)
    second = (result.opening == NAMES.index(("ST", "SL"))) | (right < 0)
    holds = com[np.all(first & second, axis=(1, 2))]
    assert (holds[0], holds[-1]) == pytest.approx(band, abs=2e-4)
    assert np.all(np.diff(holds) < 1.5e-4)  # one band


@pytest.mark.parametrize(("friction", "low", "high"), [(0.3, -4.5, None), (0.5, None, 6.8)])
def test_golden_cases_of_phi_above_theta_steep(friction, low, high) -> None:
    """H at L⁺ ≥ H at R⁻ for T ≥ −4.5, or for T ≤ 6.8."""
    tangent = np.linspace(-0.9, 0.9, 37)
    rise = 0.25 * np.sin(np.arctan(tangent))
    result = pb.contact_modes_batch(
        width=0.25,
        com_x=0.125,
        com_y=0.04,
        theta_left=math.radians(5),
        theta_right=math.radians(15),
        p_left=0.0,
        p_right=rise / math.sin(math.radians(15)),
        friction_left=friction,
        friction_right=friction,
    )
    left_high, right_low = result.squeeze[:, 0, 1], result.squeeze[:, 1, 0]
    edge = low if low is not None else high
    expected = tangent >= edge if low is not None else tangent <= edge
    assert expected.all()  # it binds nowhere near
    np.testing.assert_array_equal(left_high >= right_low, expected)
    # With the palms' roles as printed in (4) and (8) the steep cone leans past the vertical here.
    assert math.atan(friction) > math.radians(15)


def test_margin_is_where_the_object_is_just_held() -> None:
    states: tuple[dict[str, Any], ...] = (
        {},
        {"theta_left_deg": 5.0},
        {"p_left_m": 0.05, "p_right_m": -0.03},
    )
    for state in states:
        result = pb.contact_modes("paper", **state)
        base = {
            "width": 0.25,
            "com_x": 0.125,
            "com_y": 0.04,
            "theta_left": math.radians(result.theta_left_deg),
            "theta_right": math.radians(result.theta_right_deg),
            "p_left": result.p_left_m,
            "p_right": result.p_right_m,
        }
        for shrink, held in ((result.margin_rad - 1e-7, True), (result.margin_rad + 1e-7, False)):
            friction = math.tan(math.atan(0.3) - shrink)
            if friction < 0:  # held without any friction
                continue
            state = State(
                width=0.25,
                com=(0.125, 0.04),
                theta=(base["theta_left"], base["theta_right"]),
                p=(base["p_left"], base["p_right"]),
                friction=(friction, friction),
            )
            assert state.feasible((STICK, STICK)) is held


def test_arguments_broadcast() -> None:
    fixed = {
        "width": 0.25, "com_x": 0.125, "com_y": 0.04, "theta_left": 0.1, "theta_right": 0.2,
        "friction_left": 0.3, "friction_right": 0.4,
    }  # fmt: skip
    p = np.linspace(-0.07, 0.07, 5)
    table = pb.contact_modes_batch(**fixed, p_left=p[:, None], p_right=p[None, :])
    assert table.closing.shape == (5, 5)
    assert table.feasible.shape == (5, 5, 9)
    assert table.squeeze.shape == (5, 5, 2, 2)
    single = pb.contact_modes_batch(**fixed, p_left=p[1], p_right=p[3])
    assert single.closing.shape == ()
    assert single.closing == table.closing[1, 3]
    np.testing.assert_array_equal(single.squeeze, table.squeeze[1, 3])


def test_result_does_not_depend_on_the_unit_of_length(drawn) -> None:
    """Scaling every length by k changes nothing."""
    states, result = drawn
    keys = ("width", "com_x", "com_y", "p_left", "p_right", "offset_left", "offset_right")
    columns = {key: np.array([s.arguments()[key] for s in states]) for key in states[0].arguments()}
    scaled = pb.contact_modes_batch(**{k: v * 4 if k in keys else v for k, v in columns.items()})
    np.testing.assert_allclose(scaled.squeeze, result.squeeze, rtol=1e-12)
    np.testing.assert_array_equal(scaled.closing, result.closing)
