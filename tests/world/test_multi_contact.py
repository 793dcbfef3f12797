# SPDX-License-Identifier: Apache-2.0
"""Beyond two vertices: flush edges, tips, lifted vertices; by law and against another world."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import palmbots as pb
import palmbots._core as _core
from contact_scripts import OBJECTS
from motion_oracle import Moment, Oracle
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from sampled import amounts
from slow_world import SlowWorld

ANGLES = [-5, 0, 2, 5, 8, 15, 25]
Step = tuple[float, float, float, float]  # change of the separation, palm angles [°], push


def world(thing: Any = "paper", **keys) -> _core.World:
    return _core.World(
        to_spec(load_scene(thing, {k.replace("__", "."): v for k, v in keys.items()}))
    )


def go(w: _core.World, change: float, left_deg: float, right_deg: float, parts: int = 1):
    start, goal = w.palms, (math.radians(left_deg), math.radians(right_deg))
    for k in range(1, parts):
        left, right = (a + k / parts * (b - a) for a, b in zip(start, goal, strict=True))
        step = w.advance(change / parts, (left, right))
        if step[0]:
            return step
    return w.advance(change / parts, goal)


def kinds(w: _core.World) -> list[tuple[str, str]]:
    return [
        (("left", "right")[side], "tip" if tip else "vertex") for side, tip, _, _ in w.constraints
    ]


# --- Single cases ---------------------------------------------------------------------------------


def test_a_flush_box_slides_along_its_palm_and_comes_back_upon_its_vertices() -> None:
    """Closing: the bottom slides up the level palm, the right vertex sticks, as `modes` says."""
    w = world()
    assert go(w, 0.0, 0, 15)[0] == ""
    before = w.contacts
    end, fraction, left, right, _ = go(w, -0.02, 0, 15)
    assert (end, fraction, left, right) == ("", 1.0, 1, 0)
    assert kinds(w) == [("left", "vertex"), ("left", "tip"), ("right", "vertex")]
    assert w.contacts[0] == pytest.approx(before[0] + 0.02, abs=1e-15)
    assert w.contacts[1] == before[1]  # what sticks keeps every bit
    assert w.lift == (0.0, 0.0) and w.contact_events == 1
    assert go(w, 0.0, 5, 15)[0] == ""
    assert w.constraints == [] and w.check() == ""


def test_opening_lifts_the_vertex_off_and_turns_the_box_about_the_tip() -> None:
    w = world()
    go(w, 0.0, 0, 15)
    end, _, left, right, _ = go(w, 0.01, 0, 15)
    assert (end, left, right) == ("", 0, -1)
    assert kinds(w) == [("left", "tip"), ("right", "vertex")]
    # The tip keeps its place on the bottom, 75 mm from the left vertex, on the level of the palm.
    dx, dy = w.contact_vector
    tilt = -dy / math.hypot(dx, dy)
    assert w.lift[0] == pytest.approx(0.075 * tilt, abs=1e-15)
    assert w.contacts[0] + 0.075 == pytest.approx(0.075 * dx / math.hypot(dx, dy), abs=1e-15)


def test_the_vertex_comes_down_again() -> None:
    w = world()
    start = w.contacts
    for change, left, right in ((0, 0, 15), (0.01, 0, 15), (-0.01, 0, 15), (0, 15, 15)):
        assert go(w, change, left, right)[0] == ""
    assert w.constraints == [] and w.lift == (0.0, 0.0)
    # The right vertex slid down and up again, the tip stuck all the time.
    assert w.contacts == pytest.approx(start, abs=1e-12)


def test_two_level_palms_slide_alike() -> None:
    """Which of them slides is not determined; by rule both do where that is in balance."""
    w = world()
    assert go(w, 0.0, 0, 0)[0] == ""
    assert go(w, -0.02, 0, 0)[0] == ""
    assert w.contacts == pytest.approx((0.01, 0.01), abs=1e-12)
    assert len(w.constraints) == 4 and w.contact_vector[1] == pytest.approx(0, abs=1e-15)
    assert go(w, 0.3, 0, 0)[:1] == ("off-palm",)


def test_an_object_between_two_tips_jams() -> None:
    """A keel hangs down between the palms; closing drives the tips of both against it."""
    keel = [[0, 0], [0.1, 0], [0.1, -0.1], [0.15, -0.1], [0.15, 0], [0.25, 0]]
    keys = {"object__vertices_m": [*keel, [0.25, 0.16], [0, 0.16]], "object__contacts": [0, 5]}
    w = world(**keys, palm__length_m=0.2)
    assert go(w, -0.2, 15, 15)[0] == "jammed"
    assert go(w, 0.002, 15, 15)[0] == ""


def test_a_bump_into_the_palm_is_the_end() -> None:
    w = world(palm__shallow_deg=1, palm__steep_deg=3, palm__friction=0.5, palm__length_m=0.6)
    assert w.shift(1, 0.02) == ""
    assert w.shift(0, 0.29) == "flush"


# --- Against the independent world ----------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    thing: dict
    keys: dict
    script: list[Step]


def case(seed: int) -> Case:
    rng = np.random.default_rng(seed)
    keys = {
        "palm.friction": float(rng.choice([0.08, 0.15, 0.3, 0.5])),
        "palm.right": {"friction": float(rng.choice([0.2, 0.3, 0.45]))},
        "palm.pivot_offset_m": float(rng.choice([0.0, 0.01])),
        "start.left_m": float(rng.uniform(-0.04, 0.04)),
        "start.right_m": float(rng.uniform(-0.04, 0.04)),
    }
    script = []
    for _ in range(4):
        left, right = (float(a) for a in rng.choice(ANGLES, 2))
        # Parallel palms under a level object leave open which contact slides.
        right = 3.0 if left + right == 0 else right
        script.append((float(rng.choice([0.0, rng.uniform(-0.02, 0.02)])), left, right, 0.0))
    return Case(OBJECTS[int(rng.integers(len(OBJECTS)))], keys, script)


@pytest.mark.slow
@pytest.mark.parametrize("cases", amounts(7, 16))
def test_motion_is_that_of_an_independent_world(cases: int) -> None:
    seen = {"further": 0, "lifted": 0, "ended": 0}
    for seed in range(cases):
        chosen = case(seed)
        spec = to_spec(load_scene(chosen.thing, chosen.keys))
        fast = _core.World(spec)
        if fast.check():
            continue
        slow = SlowWorld(Oracle(spec, None), Moment.of(fast), on_both=True)
        for change, left, right, _ in chosen.script:
            palms = (math.radians(left), math.radians(right))
            end, fraction, *_ = fast.advance(change, palms)
            by = ((-change / 2, 0.0), (change / 2, 0.0))
            reason, done = slow.move(by, palms, pace=1e-4)
            assert (reason, done) == (end, pytest.approx(fraction, abs=0.001)), seed
            if end:
                seen["ended"] += 1
                break
            assert fast.pose == pytest.approx(slow.at.pose, abs=1e-5), seed
            seen["further"] += len(fast.constraints) > 0
            seen["lifted"] += max(fast.lift) > 1e-4
    assert min(seen.values()) > 0, seen


# --- Laws -----------------------------------------------------------------------------------------

scenes = st.builds(
    load_scene,
    st.sampled_from(OBJECTS),
    st.fixed_dictionaries(
        {
            "palm.friction": st.sampled_from([0.15, 0.25, 0.3, 0.5]),
            "palm.right": st.fixed_dictionaries({"friction": st.sampled_from([0.2, 0.3, 0.45])}),
            "palm.pivot_offset_m": st.sampled_from([0.0, 0.01]),
            "start.left_m": st.floats(-0.04, 0.04),
            "start.right_m": st.floats(-0.04, 0.04),
        }
    ),
)
scripts = st.lists(
    st.tuples(
        st.sampled_from([0.0, 0.004]) | st.floats(-0.02, 0.02),
        st.sampled_from(ANGLES),
        st.sampled_from(ANGLES),
        st.sampled_from([0.0]) | st.floats(-0.03, 0.03),
    ),
    max_size=8,
)


def moved(w: _core.World, script: list[Step], mirror: bool = False):
    for change, left, right, push in script:
        if mirror:
            left, right, push = right, left, -push
        step = w.advance(change, (math.radians(left), math.radians(right)), push)
        yield step
        if step[0]:
            return


# Palms that turn through level with both contacts at their pivots differ in nothing but friction.
AT_PIVOTS = load_scene(
    {"object": "box"},
    {
        "palm.friction": 0.15,
        "palm.right.friction": 0.2,
        "start.left_m": 0.0,
        "start.right_m": 0.0,
    },
)


# Contacts that start apart slide until they are equal, and then turn through level.
EQUAL_BY_SLIDING = load_scene(
    AT_PIVOTS,
    {"palm.friction": 0.3, "palm.right.friction": 0.3, "start.right_m": 0.001953125},
)
# In each of these one thing alone distinguishes left from right: a push, the last bit of an
# outline, the order of its edges.
PUSHED = load_scene(EQUAL_BY_SLIDING, {"start.right_m": 0.0, "palm.pivot_offset_m": 0.0})
STRIPS = load_scene(
    {"object": "box-strips"},
    {"palm.friction": 0.3, "palm.pivot_offset_m": 0.0, "start.left_m": 0.0, "start.right_m": 0.0},
)
BENT = load_scene(
    {
        "object": {
            "vertices_m": [[0, 0], [0.06, -0.01], [0.25, 0], [0.25, 0.1], [0, 0.1]],
            "contacts": [0, 2],
            "com_m": [0.125, 0.05],
        }
    },
    {
        "palm.friction": 0.15,
        "palm.right.friction": 0.3,
        "palm.pivot_offset_m": 0.01,
        "start.left_m": 0.0,
        "start.right_m": 0.0,
    },
)
TO_AND_FRO = [(0.0, 15, 15, 0.0), (0.004, -5, -5, 0.0), (0.004, 25, 25, 0.0), (0.004, -5, -5, 0.0)]


def is_its_own_mirror_image(spec: _core.Spec) -> bool:
    """Whether left and right differ in the contact positions only."""
    names = [name for name in dir(_core.PalmSpec) if not name.startswith("_")]
    left, right = (
        [value for name in names if not callable(value := getattr(palm, name))]
        for palm in spec.palms
    )
    alike = left == right and spec.com_left == spec.com_right
    swapped = {(from_right, from_left, *rest) for from_left, from_right, *rest in spec.outline}
    return alike and spec.slope == 0 and swapped == set(spec.outline)


@settings(max_examples=75)
@example(AT_PIVOTS, [(0.0, -5.0, -5.0, 0.0)])
@example(load_scene(AT_PIVOTS, {"palm.right.friction": 0.15}), [(0.0, -5.0, -5.0, 0.0)])
@example(EQUAL_BY_SLIDING, [(0.004, -5.0, -5.0, 0.0)])
@example(PUSHED, [(0.0, -5.0, -5.0, 0.015625)])
@example(STRIPS, [(0.0, -5.0, -5.0, 0.0)])
@example(BENT, TO_AND_FRO)
@given(scenes, scripts)
def test_a_mirrored_world_moves_mirrored_to_the_bit(scene: Scene, script: list[Step]) -> None:
    there, back = _core.World(to_spec(scene)), _core.World(to_spec(scene.mirrored()))
    assert there.check() == back.check()
    if there.check():
        return
    image = is_its_own_mirror_image(to_spec(scene))
    palms = there.palms
    worlds = zip(moved(there, script), moved(back, script, mirror=True), strict=True)
    for (_, left, right, push), (a, b) in zip(script, worlds, strict=False):
        assert a[:2] == b[:2]
        alike = image and palms[0] == palms[1] and left == right and push == 0
        if alike and there.contacts == back.contacts != back.contacts[::-1]:
            # Both came through a state that is its own mirror image: there nothing distinguishes
            # left from right, and left leads by rule.
            return
        assert there.contacts == back.contacts[::-1]
        assert there.lift == back.lift[::-1]
        assert there.separation == back.separation
        palms = there.palms


# A corner of the object passes the tip on which it rests, and then nothing touches that palm.
PAST_A_TIP = load_scene(BENT, {"palm.right.friction": 0.2, "start.left_m": 0.005859375})


@settings(max_examples=75)
@example(PAST_A_TIP, [(0.0, -5.0, -5.0, 0.0)] + 4 * [(0.004, -5.0, -5.0, 0.0)])
@given(scenes, scripts)
def test_the_object_stays_rigid_held_and_outside_the_palms(
    scene: Scene, script: list[Step]
) -> None:
    spec = to_spec(scene)
    w = _core.World(spec)
    if w.check():
        return
    for end, fraction, *_, pieces in moved(w, script):
        assert math.hypot(*w.contact_vector) == pytest.approx(spec.width, abs=1e-13)
        assert 0 <= fraction <= 1
        assert pieces < 1500
        # A palm never ends up in the object, whatever it meets.
        assert end not in ("flush", "tip")
        if not end:
            assert w.check() == ""


@pytest.mark.parametrize("seed", range(60))
def test_steps_of_any_size_end_alike(seed: int) -> None:
    chosen = case(seed)
    once, often = world(chosen.thing, **chosen.keys), world(chosen.thing, **chosen.keys)
    if once.check():
        return
    for change, left, right, _ in chosen.script:
        one = go(once, change, left, right)
        other = go(often, change, left, right, parts=50)
        assert one[0] == other[0]
        assert once.contacts == pytest.approx(often.contacts, abs=1e-6)
        assert once.lift == pytest.approx(often.lift, abs=1e-6)
        if one[0]:
            break


def test_no_drift_at_rest_upon_three_contacts_and_in_common_motion() -> None:
    w = world()
    go(w, 0.0, 0, 15)
    go(w, -0.01, 0, 15)
    before = (w.contacts, w.lift, w.separation, w.palms)
    for _ in range(20_000):
        w.advance(0.0, w.palms, 0.01)
    assert (w.contacts, w.lift, w.separation, w.palms) == before


# --- Carries --------------------------------------------------------------------------------------

LEVEL = {"palm.shallow_deg": 0, "palm.length_m": 0.2, "task.distance_m": 0.6}


def test_carry_continues_after_a_further_contact_and_logs_it(tmp_path) -> None:
    done = pb.carry("paper", controller="distributed", seed=3, overrides=LEVEL, record=True)
    assert done.contact_events
    assert {t.kind for t in done.contact_events} <= {"flush", "tip"}
    for a, b in zip(done.contact_events, done.contact_events[1:], strict=False):
        assert a.start_s <= a.end_s <= b.start_s <= b.end_s <= done.time_s
    event = done.summary()["contact_events"][0]
    assert set(event) == {"robot", "kind", "start_s", "end_s"}
    assert done.trace is not None
    lifted = done.trace["vertex_height"].max(dim="side") > 0
    during = np.zeros(lifted.sizes["time"], bool)
    for t in done.contact_events:
        during |= ((done.trace.time >= t.start_s) & (done.trace.time <= t.end_s)).to_numpy()
    assert not (lifted.to_numpy() & ~during).any()
    log = tmp_path / "carry.mcap"
    pb.write_log(done, log)
    assert pb.read_log(log).contact_events == done.contact_events
    assert pb.replay(log).identical


@settings(max_examples=25)
@given(
    scenes,
    st.sampled_from(["none", "centralized", "distributed"]),
    st.integers(0, 2**32),
    st.sampled_from(ANGLES),
    st.sampled_from([15, 20]),
    st.sampled_from(["double", "float"]),
)
def test_no_valid_scene_crashes(
    scene: Scene, controller: str, seed: int, shallow: float, steep: float, precision: str
) -> None:
    keys = {"palm.shallow_deg": min(shallow, 8), "palm.steep_deg": steep, "task.distance_m": 0.5}
    done = pb.carry(
        scene, controller=controller, seed=seed, precision=precision, overrides=keys, record=False
    )
    assert done.outcome in ("delivered", "dropped", "stalled")
    assert all(map(math.isfinite, done.contact_rms_m.values()))
