"""Contact modes and squeeze intervals against a linear program over the friction cones."""

import math

import numpy as np
import pytest

import palmbots as pb
from oracles import DOWN, MODES, STICK, UP, State, balanced_modes, random_state
from palmbots.modes import MODES as NAMES

STATES = 2000
# Squeezes (in units of the weight) closer than this are equal but for rounding.
NEAR = 1e-6


def name(mode: tuple[str, str]) -> tuple[str, str]:
    """The paper's name: up is SL on the left palm and SR on the right one."""
    left = {STICK: "ST", UP: "SL", DOWN: "SR"}
    right = {STICK: "ST", UP: "SR", DOWN: "SL"}
    return left[mode[0]], right[mode[1]]


@pytest.fixture(scope="module")
def drawn() -> tuple[list[State], pb.States]:
    rng = np.random.default_rng(1998)
    states = [random_state(rng) for _ in range(STATES)]
    columns = {key: np.array([s.arguments()[key] for s in states]) for key in states[0].arguments()}
    return states, pb.states(**columns)


@pytest.fixture(scope="module")
def balanced(drawn) -> list[set[tuple[str, str]]]:
    """The modes that balance, of each state drawn."""
    return balanced_modes(drawn[0])


def near_a_boundary(ends: np.ndarray) -> bool:
    """Whether any two ends of the squeeze intervals (almost) coincide."""
    finite = np.sort(ends[np.isfinite(ends)])
    return bool(np.any(np.diff(finite) < NEAR * (1 + np.abs(finite[1:]))))


def test_feasibility_of_all_nine_modes(drawn, balanced) -> None:
    states, found = drawn
    left_out = 0
    for i, state in enumerate(states):
        if near_a_boundary(found.squeeze[i]):
            left_out += 1
            continue
        ours = {NAMES[k] for k in np.flatnonzero(found.feasible[i])}
        theirs = {name(mode) for mode in balanced[i]}
        assert ours == theirs, state
    assert left_out < 0.02 * STATES


def test_the_states_drawn_cover_what_matters(drawn) -> None:
    states, found = drawn
    held = np.any(found.feasible, axis=1)
    assert 0.2 < held.mean() < 0.95
    above = [math.atan(s.friction[0]) > s.theta[0] for s in states]
    assert 0.2 < np.mean(above) < 0.95
    assert np.isinf(found.squeeze).any()


def test_ends_of_the_squeeze_intervals(drawn) -> None:
    states, found = drawn
    for i in range(0, STATES, 3):
        for side in (0, 1):
            low, high = found.squeeze[i, side]
            theirs = states[i].squeeze(side)
            if theirs is None:
                assert low > high, states[i]
                continue
            assert (low, high) == pytest.approx(theirs, rel=1e-6, abs=1e-8), states[i]


def test_the_mode_that_happens_is_the_one_both_balanced_and_consistent(drawn, balanced) -> None:
    """Section 3.1: of nine modes three balance, five are consistent, one is both."""
    states, found = drawn
    counted = 0
    for i, state in enumerate(states):
        ends = found.squeeze[i]
        if near_a_boundary(ends) or not np.isfinite(ends).all() or not found.feasible[i].any():
            continue
        inside = 0 < state.com[0] < state.width and abs(state.slope) < 0.05
        if not inside:
            continue
        for direction, happens in ((UP, found.closing[i]), (DOWN, found.opening[i])):
            consistent = {mode for mode in MODES if direction in mode}
            assert len(consistent) == 5
            both = balanced[i] & consistent
            if len(balanced[i]) == 3 and len(both) == 1:
                counted += 1
                assert NAMES[happens] == name(both.pop()), state
    assert counted > 0.3 * STATES


def test_paper_nine_three_five_one() -> None:
    """Figure 3(b): the left palm shallow, the palms pushed together."""
    found = pb.modes("paper", theta_left_deg=5)
    assert len(NAMES) == 9
    assert len(found.feasible) == 3
    assert len(found.consistent_closing) == 5
    assert set(found.feasible) & set(found.consistent_closing) == {("SL", "ST")}
    assert found.closing == ("SL", "ST")  # property 1
    assert found.opening == ("ST", "SL")  # property 2


@pytest.mark.parametrize(
    ("friction", "band"),
    [
        (0.2, (0.1019, 0.2007)),
        (0.3, (0.1084, 0.2178)),
        (0.4, (0.1128, 0.1787)),
        (0.5, (0.1160, 0.1646)),
    ],
)
def test_com_bands_of_section_7(friction: float, band: tuple[float, float]) -> None:
    """MECHANICS section 7: where properties 1 and 2 hold over the palm, left palm shallow."""
    reach = 0.075
    grid = np.linspace(-reach, reach, 31)
    left, right = np.meshgrid(grid, grid, indexing="ij")
    com = np.arange(0.09, 0.23, 0.0001)
    found = pb.states(
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
    first = (found.closing == NAMES.index(("SL", "ST"))) | (left > 0)
    second = (found.opening == NAMES.index(("ST", "SL"))) | (right < 0)
    holds = com[np.all(first & second, axis=(1, 2))]
    assert (holds[0], holds[-1]) == pytest.approx(band, abs=2e-4)
    assert np.all(np.diff(holds) < 1.5e-4)  # one band


@pytest.mark.parametrize(("friction", "low", "high"), [(0.3, -4.5, None), (0.5, None, 6.8)])
def test_golden_cases_of_phi_above_theta_steep(friction, low, high) -> None:
    """MECHANICS section 3: H at L⁺ ≥ H at R⁻ for T ≥ −4.5, or for T ≤ 6.8."""
    tangent = np.linspace(-0.9, 0.9, 37)
    rise = 0.25 * np.sin(np.arctan(tangent))
    found = pb.states(
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
    left_high, right_low = found.squeeze[:, 0, 1], found.squeeze[:, 1, 0]
    edge = low if low is not None else high
    expected = tangent >= edge if low is not None else tangent <= edge
    assert expected.all()  # it binds nowhere near
    np.testing.assert_array_equal(left_high >= right_low, expected)
    # With the palms' roles as printed in (4) and (8) the steep cone leans past the vertical here.
    assert math.atan(friction) > math.radians(15)


def test_margin_is_where_the_object_is_just_held() -> None:
    for key in ({}, {"theta_left_deg": 5.0}, {"p_left_m": 0.05, "p_right_m": -0.03}):
        found = pb.modes("paper", **key)
        base = {
            "width": 0.25,
            "com_x": 0.125,
            "com_y": 0.04,
            "theta_left": math.radians(found.theta_left_deg),
            "theta_right": math.radians(found.theta_right_deg),
            "p_left": found.p_left_m,
            "p_right": found.p_right_m,
        }
        for shrink, held in ((found.margin_rad - 1e-7, True), (found.margin_rad + 1e-7, False)):
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
    table = pb.states(**fixed, p_left=p[:, None], p_right=p[None, :])
    assert table.closing.shape == (5, 5)
    assert table.feasible.shape == (5, 5, 9)
    assert table.squeeze.shape == (5, 5, 2, 2)
    single = pb.states(**fixed, p_left=p[1], p_right=p[3])
    assert single.closing.shape == ()
    assert single.closing == table.closing[1, 3]
    np.testing.assert_array_equal(single.squeeze, table.squeeze[1, 3])
    with pytest.raises(ValueError):
        pb.states(**fixed, p_left=np.zeros(3), p_right=np.zeros(4))


def test_lengths_have_no_scale(drawn) -> None:
    """Every length × k changes nothing."""
    states, found = drawn
    keys = ("width", "com_x", "com_y", "p_left", "p_right", "offset_left", "offset_right")
    columns = {key: np.array([s.arguments()[key] for s in states]) for key in states[0].arguments()}
    scaled = pb.states(**{k: v * 4 if k in keys else v for k, v in columns.items()})
    np.testing.assert_allclose(scaled.squeeze, found.squeeze, rtol=1e-12)
    np.testing.assert_array_equal(scaled.closing, found.closing)
