# SPDX-License-Identifier: Apache-2.0
"""`feasible_contact_modes` gives the answers of `contact_modes_batch` in every state, as bits."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from palmbots.mechanics import array_arguments as columns
from sampled import sampled
from statics_oracle import random_state

# The paper's box between a shallow and a steep palm.
BOX: dict[str, Any] = {
    "width": 0.25, "com_x": 0.125, "com_y": 0.04,
    "theta_left": math.radians(5), "theta_right": math.radians(15),
    "friction_left": 0.3, "friction_right": 0.3,
}  # fmt: skip
BOTH_SLIDE = sum(1 << k for k, mode in enumerate(pb.mechanics.CONTACT_MODES) if "ST" not in mode)


def assert_same(**arguments: Any) -> NDArray[np.uint16]:
    """Compares the two functions, and returns the bits."""
    with np.errstate(all="ignore"):
        wanted = pb.contact_modes_batch(**arguments).feasible
        result = pb.feasible_contact_modes(**arguments)
    assert result.dtype == np.uint16
    assert result.shape == wanted.shape[:-1]
    np.testing.assert_array_equal(result, wanted @ (1 << np.arange(9)))
    return result


def drawn(count: int) -> list[dict[str, float]]:
    rng = np.random.default_rng(1998)
    return [random_state(rng).arguments() for _ in range(count)]


def test_random_states_agree_with_contact_modes_batch() -> None:
    states = drawn(3000)
    bits = assert_same(**{key: np.array([s[key] for s in states]) for key in states[0]})
    assert 0.2 < np.mean(bits != 0) < 0.95
    assert len(np.unique(bits)) >= 5


def test_random_contacts_agree_with_contact_modes_batch() -> None:
    """Also where the object does not reach, or is so steep that a cone edge is wedged."""
    p = np.linspace(-0.3, 0.3, 61)
    held = 0
    for state in drawn(50):
        bits = assert_same(**state | {"p_left": p[:, None], "p_right": p})
        held += np.count_nonzero(bits)
    assert held > 10_000


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.5, 1.0, 3.0])
def test_grids_agree_with_contact_modes_batch(friction: float) -> None:
    """φ on either side of θ, θ on either side of 0, and the COM beyond the contacts too."""
    theta = np.radians(np.linspace(-30, 60, 19))
    com_x = np.linspace(-0.05, 0.3, 15)
    p = np.linspace(-0.075, 0.075, 7)
    assert_same(
        width=0.25, com_x=com_x[:, None, None, None], com_y=0.04,
        theta_left=theta[:, None, None], theta_right=0.2,
        p_left=p[:, None], p_right=p,
        friction_left=friction, friction_right=0.4, slope=0.1,
    )  # fmt: skip


def test_ties_of_symmetric_states_agree_with_contact_modes_batch() -> None:
    """Where both contacts slip at one squeeze, both may slide."""
    p = np.linspace(-0.075, 0.075, 31)
    for theta in np.radians([-5, 5, 15, 40]):
        alike = BOX | {"theta_left": theta, "theta_right": theta}
        bits = assert_same(**alike, p_left=p, p_right=p)
        assert np.all(bits & BOTH_SLIDE)
        # A few ulp off the tie is within the tolerance, a thousandth is not.
        assert np.all(assert_same(**alike, p_left=p, p_right=p * (1 + 1e-15)) & BOTH_SLIDE)
        assert not np.all(assert_same(**alike, p_left=p, p_right=p * 1.001) & BOTH_SLIDE)
        near = assert_same(**alike, p_left=0.05, p_right=0.05 * (1 + np.logspace(-16, -9, 5000)))
        assert 0.1 < np.mean(near & BOTH_SLIDE != 0) < 0.9


def test_wedged_states_agree_with_contact_modes_batch() -> None:
    """Cones that contain the line to the other contact."""
    p = np.linspace(-0.2, 0.2, 41)
    arguments = BOX | {"theta_left": 0.6, "friction_left": 1.2, "p_left": p[:, None], "p_right": p}
    ends = pb.contact_modes_batch(**arguments).squeeze[..., 0, 1]
    assert np.isfinite(ends).any()
    assert np.isposinf(ends).any()
    assert_same(**arguments)


def test_cone_edges_along_the_line_of_contacts_agree_with_contact_modes_batch() -> None:
    """A right triangle of sides 3, 4 and 5, in numbers without rounding: a = 0 in the bound."""
    level = {"width": 5.0, "com_y": 0.5, "theta_left": 0.0, "theta_right": 0.0, "p_right": 0.0}
    raised = {"friction_left": 0.75, "friction_right": 0.3, "offset_right": 4.0}
    com_x = np.linspace(-1, 6, 57)
    arguments = level | raised | {"p_left": 0.0, "com_x": com_x}
    assert np.isinf(pb.contact_modes_batch(**arguments).squeeze[:, 0, 1]).all()
    bits = assert_same(**arguments)
    assert 0 < np.count_nonzero(bits) < com_x.size
    mirrored = level | {"friction_left": 0.3, "friction_right": 0.75, "offset_left": 4.0}
    assert_same(**mirrored, p_left=np.zeros(9), com_x=1.0)


def test_no_mode_balances_where_the_object_cannot_reach() -> None:
    bits = assert_same(**BOX, p_left=[0.0, 3.0, -3.0, 0.0], p_right=[0.0, 0.0, 0.0, 1.5])
    np.testing.assert_array_equal(bits != 0, [True, False, False, False])


@pytest.mark.parametrize("seed", sampled(range(30), 3))
def test_extreme_numbers_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Zeros of both signs, tiny and huge numbers, infinities and NaN.

    The core accepts them, although Python refuses impossible numbers.
    """
    monkeypatch.setattr(columns, "_refuse_impossible", lambda *_: None)
    rng = np.random.default_rng(seed)
    odd = [0.0, -0.0, 1e-320, 1e-160, 1e160, 1e308, -1e308, np.inf, -np.inf, np.nan, 0.25, 0.125]
    turns = [0.0, -0.0, np.pi / 4, np.nextafter(np.pi / 4, 1), -np.pi / 2, 2.0, -3.0, 6.2, np.nan]
    ranges: dict[str, tuple[float, float]] = {
        "width": (0.05, 0.5), "com_x": (-0.1, 0.6), "com_y": (-0.05, 0.2),
        "theta_left": (-1.5, 1.5), "theta_right": (-1.5, 1.5),
        "p_left": (-0.3, 0.3), "p_right": (-0.3, 0.3),
        "friction_left": (-0.2, 4), "friction_right": (-0.2, 4),
        "offset_left": (-0.05, 0.05), "offset_right": (-0.05, 0.05), "slope": (-1, 1),
    }  # fmt: skip
    n = 4000
    arguments: dict[str, Any] = {}
    for key, (low, high) in ranges.items():
        values = rng.uniform(low, high, n)
        which = rng.random(n) < 0.05
        values[which] = rng.choice(turns if key.startswith("theta") else odd, which.sum())
        arguments[key] = values
    assert_same(**arguments)
    for i in range(40):  # the same numbers, but only the contacts differ
        alike = {k: v if k.startswith("p_") else v[i] for k, v in arguments.items()}
        assert_same(**alike)


@pytest.mark.parametrize("n", [0, 1, 2, 255, 256, 257, 511, 1023, 1025])
@pytest.mark.parametrize("key", ["p_left", "theta_right", "com_x", "friction_left"])
def test_any_number_of_states_is_accepted(n: int, key: str) -> None:
    arguments = BOX | {"p_left": 0.01, "p_right": -0.02}
    low = 0.0 if key.startswith("friction") else -0.01
    assert_same(**arguments | {key: np.linspace(low, 0.3, n)})


def test_bits_are_in_the_order_of_the_modes() -> None:
    """Figure 3(b), with the names of `modes`."""
    bits = pb.feasible_contact_modes(**BOX, p_left=0.0, p_right=0.0)
    named = tuple(mode for k, mode in enumerate(pb.mechanics.CONTACT_MODES) if bits >> k & 1)
    assert named == pb.contact_modes("paper", theta_left_deg=5).feasible


def test_arguments_broadcast() -> None:
    p = np.linspace(-0.07, 0.07, 5)
    table = assert_same(**BOX, p_left=p[:, None], p_right=p[None, :])
    assert table.shape == (5, 5)
    single = assert_same(**BOX, p_left=p[1], p_right=p[3])
    assert single.shape == ()
    assert single == table[1, 3]
    assert assert_same(**BOX, p_left=[[0.0]], p_right=0).shape == (1, 1)
    assert assert_same(**BOX, p_left=np.zeros((2, 0)), p_right=0.0).shape == (2, 0)
    # Every other one, backwards, in single precision: no matter how the numbers lie in memory.
    np.testing.assert_array_equal(
        pb.feasible_contact_modes(**BOX, p_left=p[::-2], p_right=np.float32(0.5)),
        [pb.feasible_contact_modes(**BOX, p_left=x, p_right=0.5) for x in p[::-2]],
    )


def test_possible_numbers_are_accepted() -> None:
    """The limits, and finite numbers whose sum overflows."""
    steepest = np.nextafter(math.pi / 2, 0)
    pb.contact_modes_batch(
        **BOX | {"theta_left": steepest, "friction_left": 0.0}, p_left=0.0, p_right=0.0
    )
    huge = np.full(9, 1e308)
    assert not pb.feasible_contact_modes(**BOX, p_left=huge, p_right=0.0).any()
