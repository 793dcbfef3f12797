# SPDX-License-Identifier: Apache-2.0
"""The quasistatic world: exact motion, against an independent integrator and its own laws."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import palmbots._core as _core
from integrator import SlowWorld
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from sampled import sampled

STEEP, SHALLOW = math.radians(15), math.radians(5)


def world(**keys) -> tuple[_core.Spec, _core.World]:
    """A world of the paper's scene with keys set; `__` stands for the dot in a key."""
    scene = load_scene("paper", {key.replace("__", "."): v for key, v in keys.items()})
    spec = to_spec(scene)
    return spec, _core.World(spec)


def residual(spec: _core.Spec, w: _core.World) -> float:
    """How far the contacts are from being w apart, recomputed from scratch."""
    slow = SlowWorld(spec, w.contacts, w.separation, w.palms)
    return slow.length() - spec.width


SCRIPTS = {
    "close": [(-0.02, STEEP, STEEP)],
    "open": [(0.02, STEEP, STEEP)],
    "close, open": [(-0.01, STEEP, STEEP), (0.03, STEEP, STEEP)],
    "property 1": [(0.0, SHALLOW, STEEP), (-0.02, SHALLOW, STEEP), (0.0, STEEP, STEEP)],
    "property 2": [(0.0, SHALLOW, STEEP), (0.02, SHALLOW, STEEP), (0.0, STEEP, STEEP)],
    "turn while closing": [(-0.004, SHALLOW, STEEP), (-0.004, STEEP, SHALLOW)],
    "turn both": [(0.002, SHALLOW, SHALLOW), (0.01, SHALLOW, SHALLOW), (-0.006, STEEP, STEEP)],
}
RIGS = {
    "paper": {},
    "phi below theta": {"palm__friction": 0.2},
    "phi far above theta": {"palm__friction": 0.5},
    "offset": {"palm__pivot_offset_m": 0.01},
    "uneven": {
        "palm__left": {"friction": 0.25},
        "object__com_m": [0.115, 0.06],
        "start__left_m": 0.01,
        "start__right_m": -0.015,
    },
}


@pytest.mark.parametrize(("script", "rig"), sampled(itertools.product(SCRIPTS, RIGS), 4))
def test_motion_is_that_of_an_independent_integrator(script: str, rig: str) -> None:
    keys = {"object__com_m": [0.121, 0.04], "start__left_m": 0.004} | RIGS[rig]
    spec, fast = world(**keys)
    slow = SlowWorld(spec, fast.contacts, fast.separation, fast.palms)
    for change, left, right in SCRIPTS[script]:
        assert fast.advance(change, (left, right))[0] == ""
        slow.move(change, (left, right), 2000)
        assert fast.contacts == pytest.approx(slow.p, abs=3e-5)
        assert abs(residual(spec, fast)) < 1e-15


def test_opening_with_phi_above_theta_slides_both_and_levels_the_object() -> None:
    """While the palms open, the contact to slide can alternate; then both slide."""
    spec, w = world(start__left_m=0.02)
    assert math.atan(spec.palms[0].friction) > STEEP
    end, _, left, right, _ = w.advance(0.03, (STEEP, STEEP))
    assert (end, left, right) == ("", -1, -1)
    dx, dy = w.contact_vector
    assert dy / dx == pytest.approx(0, abs=1e-12)
    assert w.contacts[0] == pytest.approx(w.contacts[1], abs=1e-12)


def test_closing_reinforces_its_own_choice() -> None:
    _, w = world(start__left_m=0.001)
    first = w.contacts
    _, _, left, right, pieces = w.advance(-0.03, (STEEP, STEEP))
    assert sorted((left, right)) == [0, 1]
    assert pieces == 1
    held = 0 if left == 0 else 1
    assert w.contacts[held] == first[held]


def test_a_tie_slides_both_equally() -> None:
    for change in (-0.02, 0.02):
        _, w = world()
        end, _, left, right, _ = w.advance(change, (STEEP, STEEP))
        assert (end, left) == ("", right)
        assert w.contacts[0] == w.contacts[1] != 0


@pytest.mark.parametrize("push", [0.001, -0.001])
def test_a_push_breaks_the_tie_as_section_4_says(push: float) -> None:
    """Gaining speed forward, the object lags: closing, the contact that lets go is the left one."""
    _, w = world()
    _, _, left, right, _ = w.advance(-0.01, (STEEP, STEEP), push)
    assert (left, right) == ((1, 0) if push > 0 else (0, 1))


@pytest.mark.parametrize("rig", RIGS)
def test_steps_of_any_size_end_alike(rig: str) -> None:
    for script in SCRIPTS.values():
        _, once = world(**({"start__left_m": 0.003} | RIGS[rig]))
        _, often = world(**({"start__left_m": 0.003} | RIGS[rig]))
        for change, left, right in script:
            start = often.palms
            turning = (left, right) != pytest.approx(start)
            once.advance(change, (left, right))
            for k in range(1, 101):
                share = k / 100
                often.advance(
                    change / 100,
                    (start[0] + share * (left - start[0]), start[1] + share * (right - start[1]))
                    if k < 100
                    else (left, right),
                )
            # Summing 100 separations rounds; an instant found to 1e-3 of a piece while turning and
            # sliding on both moves a contact by its square.
            assert once.contacts == pytest.approx(often.contacts, abs=1e-7 if turning else 1e-12)


def test_whatever_happens_in_a_step_happens_in_its_order() -> None:
    """Steps of up to 15 cm and 12°, in which contacts take turns, the drive reverses and the object
    is lost: one of them against a hundred, for the end and its instant, too."""
    rng = np.random.default_rng(1)
    seen: dict[str, int] = {}
    changed = 0  # steps with another regime from some instant on
    for _ in range(250):
        keys = {
            "palm__friction": float(rng.choice([0.12, 0.2, 0.3, 0.5, 0.9, 2.0])),
            "object__com_m": [rng.uniform(0.1, 0.15), rng.uniform(0.02, 0.08)],
            "start__left_m": rng.uniform(-0.04, 0.04),
            "start__right_m": rng.uniform(-0.04, 0.04),
            "palm__pivot_offset_m": float(rng.choice([0, 0.01])),
        }
        _, once = world(**keys)
        _, often = world(**keys)
        change = rng.uniform(-0.15, 0.15)
        turns = [math.radians(rng.uniform(-12, 6)) * (rng.random() < 0.7) for _ in range(2)]
        end, fraction, *_, parts = once.advance(change, (STEEP + turns[0], STEEP + turns[1]))
        reason, when = "", 1.0
        for k in range(1, 101):
            goal = (STEEP + k / 100 * turns[0], STEEP + k / 100 * turns[1])
            reason, part, *_ = often.advance(change / 100, goal)
            if reason:
                when = (k - 1 + part) / 100
                break
        assert end == reason
        assert fraction == pytest.approx(when, abs=1e-6)
        assert once.contacts == pytest.approx(often.contacts, abs=1e-6)
        seen[end] = seen.get(end, 0) + 1
        changed += parts > 1
    assert seen[""] > 80 and seen["off-palm"] > 80
    assert changed > 50


def test_a_reversal_inside_a_step_is_found() -> None:
    """A palm turns under a contact off its pivot: the drive opens at first, then closes."""
    keys = {"start__left_m": 0.03, "palm__friction": 0.2}
    spec, once = world(**keys)
    _, often = world(**keys)
    slow = SlowWorld(spec, once.contacts, once.separation, once.palms)
    p, target = 0.03, math.radians(14.2)  # less than 1°: one look
    middle = 0.5 * (STEEP + target)
    # At half the turn the palm lets the contact down as fast as the robots close.
    down = p * math.sin(middle) * (1 - p * math.cos(middle) / spec.width)
    change = down * (target - STEEP)
    steps = 4000
    for k in range(1, steps + 1):
        often.advance(change / steps, (STEEP + k / steps * (target - STEEP), STEEP))
    result = once.advance(change, (target, STEEP))
    assert (result[0], result[-1]) == ("", 2)
    slow.move(change, (target, STEEP), steps)
    assert once.contacts == pytest.approx(often.contacts, abs=1e-12)
    assert once.contacts == pytest.approx(slow.p, abs=1e-8)


def test_no_drift_in_an_hour_of_rest_and_of_common_motion() -> None:
    for start in ({}, {"start__left_m": 0.0123456789, "start__right_m": -0.03}):
        _, w = world(**start)
        before = (w.contacts, w.separation, w.palms)
        for _ in range(360_000):  # common motion is rest to the separation
            w.advance(0.0, (STEEP, STEEP), 0.01)
        assert (w.contacts, w.separation, w.palms) == before


def test_the_contact_that_sticks_keeps_every_bit() -> None:
    _, w = world(start__left_m=0.01)
    rng = np.random.default_rng(5)
    for _ in range(20_000):
        before = w.contacts
        _, _, left, right, pieces = w.advance(float(rng.normal(0, 1e-4)), (SHALLOW, STEEP))
        if pieces > 1:  # then `motion` describes the last piece only
            continue
        for motion, old, new in zip((left, right), before, w.contacts, strict=True):
            if motion == 0:
                assert old == new
        if max(map(abs, w.contacts)) > 0.05:
            _, w = world(start__left_m=0.01)


motions = st.lists(
    st.tuples(
        st.floats(-0.01, 0.01),
        st.sampled_from([SHALLOW, STEEP, math.radians(8)]),
        st.sampled_from([SHALLOW, STEEP, math.radians(12)]),
        st.floats(-0.05, 0.05),
    ),
    max_size=12,
)
rigs = st.fixed_dictionaries(
    {
        "palm.friction": st.sampled_from([0.15, 0.2, 0.26, 0.3, 0.5, 0.8]),
        "palm.right": st.fixed_dictionaries({"friction": st.sampled_from([0.2, 0.3, 0.45])}),
        "palm.pivot_offset_m": st.sampled_from([0.0, 0.01]),
        "start.left_m": st.floats(-0.03, 0.03),
        "start.right_m": st.floats(-0.03, 0.03),
        "object.com_m": st.tuples(st.floats(0.1, 0.15), st.floats(0.02, 0.1)).map(list),
        "task.slope_deg": st.sampled_from([0.0, 1.0]),
    }
)


# A contact right at the pivot of a palm that turns: which way it goes is a rounding error.
AT_THE_PIVOT = {
    "palm.friction": 0.15,
    "palm.right": {"friction": 0.2},
    "start.left_m": -2e-24,
    "object.com_m": [0.1008, 0.078125],
    "task.slope_deg": 1.0,
}


@settings(max_examples=150)
@given(rigs, motions)
@example(AT_THE_PIVOT, [(7e-257, SHALLOW, STEEP, -0.03125)])
@example(AT_THE_PIVOT, [(1e-30, SHALLOW, STEEP, -0.03125)])
def test_the_loop_stays_closed_and_work_is_bounded(keys, script) -> None:
    spec = to_spec(load_scene("paper", keys))
    w = _core.World(spec)
    for change, left, right, push in script:
        end, fraction, *_, pieces = w.advance(change, (left, right), push)
        assert abs(residual(spec, w)) < 1e-14
        assert pieces < 60
        assert 0 <= fraction <= 1
        if end:
            assert fraction <= 1
            break
        assert w.check() == ""


class TestEnds:
    """Every end of a carry, named and located."""

    def test_off_palm(self) -> None:
        _, w = world(start__left_m=0.03)
        end, fraction, *_ = w.advance(-0.1, (STEEP, STEEP))
        assert end == "off-palm"
        assert max(w.contacts) == pytest.approx(0.075, abs=1e-12)
        assert max(w.contacts) <= 0.075
        _, again = world(start__left_m=0.03)
        assert again.advance(-0.1 * fraction * 0.999999, (STEEP, STEEP))[0] == ""

    def test_sliding(self) -> None:
        """With little friction the object slides down on both palms once they differ in angle."""
        _, w = world(palm__friction=0.06)
        end, fraction, *_ = w.advance(0.0, (SHALLOW, STEEP))
        assert end == "sliding"
        # Property 0: θ_steep − θ_shallow ≤ 2 φ for a level, centred object.
        angle = STEEP + fraction * (SHALLOW - STEEP)
        assert STEEP - angle == pytest.approx(2 * math.atan(0.06), abs=1e-9)

    def test_jammed(self) -> None:
        """Both friction cones contain the line between the contacts: no squeeze frees a contact.

        A scene refuses palms with θ + φ ≥ 90°, without which this cannot be, so the spec is made by
        hand.
        """
        spec, _ = world()
        palms = spec.palms
        for palm in palms:
            palm.friction = 5.0
        spec.palms = palms
        w = _core.World(spec)
        before = w.contacts
        assert w.advance(-0.001, (STEEP, STEEP))[:2] == ("jammed", 0.0)
        assert w.contacts == before
        assert _core.World(spec).advance(0.001, (STEEP, STEEP))[0] == ""

    @pytest.mark.parametrize("slope_deg", [0.0, 0.5, -0.5])
    def test_tipping(self, slope_deg: float) -> None:
        """A tall object whose COM comes past its left contact as the right one is lifted.

        On a slope it is the line of gravity that passes the contact, not the vertical.
        """
        tall = [[0, 0], [0.25, 0], [0.25, 0.5], [0, 0.5]]
        _, w = world(
            object__vertices_m=tall,
            object__com_m=[0.01, 0.3],
            palm__friction=0.5,
            task__slope_deg=slope_deg,
        )
        assert w.check() == ""
        turn = math.atan(0.01 / 0.3) - math.radians(slope_deg)  # the COM is above the contact
        lift = 0.25 * math.sin(turn) / math.sin(STEEP)
        assert w.shift(1, lift - 1e-6) in ("", "sliding")
        assert w.shift(1, 2e-6) == "tipping"

    def test_held_where_it_starts(self) -> None:
        assert world()[1].check() == ""


def test_a_bump_shifts_one_contact_and_the_robots_give_way() -> None:
    spec, w = world(start__left_m=0.01)
    assert w.shift(1, 0.012) == ""
    assert w.contacts == (0.01, 0.012)
    assert abs(residual(spec, w)) < 1e-15
    assert w.shift(1, 0.2) == "off-palm"
