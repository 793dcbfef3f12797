# SPDX-License-Identifier: Apache-2.0
"""Nothing ends a carry that mechanics do not force to end; tests/soak runs 10⁵ scripts."""

from collections import Counter

import pytest

from contact_scripts import KEEL, Runner, Script, scripts
from script_ends import Ends, compare

KEEL_OBJECT = {"object": {"vertices_m": KEEL, "contacts": [0, 2], "com_m": [0.125, 0.05]}}
NEVER = {"flush", "tip", "jammed"}
"""Reasons that no script has: a palm that is not pushed into the object never ends up in it, and
an object on two palms is never without a possible motion."""

# A corner of the keel passes the tip of the left palm.
CORNER_PASSES_TIP = Script(
    KEEL_OBJECT,
    {
        "palm.friction": 0.15,
        "palm.right.friction": 0.2,
        "palm.pivot_offset_m": 0.0,
        "start.left_m": -0.015625,
        "start.right_m": 0.0,
    },
    [*[(0.0, -5.0, -5.0)] * 5, (-0.015625, -5.0, -5.0)],
)
# Both palms turn through level while the contacts slide alternately.
THROUGH_LEVEL = Script(
    KEEL_OBJECT,
    {
        "palm.friction": 0.5,
        "palm.right.friction": 0.3,
        "palm.pivot_offset_m": 0.0,
        "start.left_m": 0.016956904254141224,
        "start.right_m": 0.0368140769788386,
    },
    [(0.01261234059007971, -2.0, -2.0), (-0.0024433585536023684, 1.0, 1.0)],
)
# The slip of the left contact changes its direction just when the right palm is level.
SLIP_TURNS_AT_LEVEL = Script(
    KEEL_OBJECT,
    {
        "palm.friction": 0.5,
        "palm.right.friction": 0.3,
        "palm.pivot_offset_m": 0.0,
        "start.left_m": -0.02292114424248255,
        "start.right_m": 0.019785130892821308,
    },
    [(0.0, 0.0, -5.0), (0.0, 0.0, 2.0)],
)
# A slide stops where palm and strip touch at three points. There the three contacts together stick
# or slide for an instant only; then one of those that slide leaves.
SLIDING_CONTACT_LEAVES = Script(
    {"object": "box-strips"},
    {
        "palm.friction": 0.15,
        "palm.right.friction": 0.2,
        "palm.pivot_offset_m": 0.0,
        "start.left_m": -0.006510551275426983,
        "start.right_m": 0.031789398100849416,
    },
    [(0.0, 0.0, -5.0), (0.0, 1.0, -5.0), (0.0, -5.0, 3.0), (-0.012034651951893113, -5.0, 8.0)],
)
SLIDING_CONTACT_OF_THE_OTHER_PALM_LEAVES = Script(
    {"object": "box-strips"},
    {
        "palm.friction": 0.3,
        "palm.right.friction": 0.45,
        "palm.pivot_offset_m": 0.01,
        "start.left_m": -0.038600201041983015,
        "start.right_m": -0.009120690580751763,
    },
    [
        (0.01970341564495631, -5.0, -3.0),
        (0.006284046715293035, 25.0, 1.0),
        (-0.016866022146781123, -5.0, -5.0),
    ],
)
# Both palms, at equal friction, pass through level at the same instant. There both sides may slide;
# an instant later the forces of two slides balance far away only, where contacts are symmetric.
BOTH_THROUGH_LEVEL = Script(
    {"object": "box-strips"},
    {
        "palm.friction": 0.3,
        "palm.right.friction": 0.3,
        "palm.pivot_offset_m": 0.0,
        "start.left_m": 0.03997198277245977,
        "start.right_m": 0.0329829123286176,
    },
    [
        (0.0, -2.0, 5.0),
        (0.01885940253602916, 0.0, -2.0),
        (0.0, -2.0, -2.0),
        (0.018199311931163486, 5.0, 5.0),
    ],
)
# The tip of the left palm slides along an edge to its corner; the next edge is too steep to rest
# on. Exactly at the corner the plate's normal would balance the object, but it lies outside the
# normal cone of the corner.
CORNER_SLIDES_OFF = Script(
    KEEL_OBJECT,
    {
        "palm.friction": 0.08,
        "palm.right": {"friction": 0.2},
        "palm.pivot_offset_m": 0.01,
        "start.left_m": 0.02517613806537323,
        "start.right_m": 0.029369142075846864,
    },
    [
        (0.0, -2.0, 0.0),
        (-0.004965455877562412, 1.0, 3.0),
        (0.017142361495337672, 3.0, 1.0),
        (0.0, 3.0, 3.0),
        (0.017881022107362584, 3.0, -5.0),
        (0.0, 5.0, 5.0),
        (0.0, -5.0, 1.0),
    ],
)


@pytest.mark.parametrize(
    "script",
    [
        CORNER_PASSES_TIP,
        THROUGH_LEVEL,
        SLIP_TURNS_AT_LEVEL,
        SLIDING_CONTACT_LEAVES,
        SLIDING_CONTACT_OF_THE_OTHER_PALM_LEAVES,
        BOTH_THROUGH_LEVEL,
    ],
)
def test_carry_continues_where_an_edge_passes_a_tip_or_level(script: Script) -> None:
    assert Runner().end(script) is None


def test_carry_ends_where_a_corner_slides_off_a_tip() -> None:
    runner = Runner()
    end = runner.end(CORNER_SLIDES_OFF)
    assert end is not None and (end.reason, int(end.at)) == ("sliding", 6)
    assert runner.course(CORNER_SLIDES_OFF).is_forced(end)


def test_random_scripts_end_only_where_the_slow_world_ends() -> None:
    runner, reasons = Runner(), Counter[str]()
    ends = Ends()
    for n, script in enumerate(scripts(seed=22, count=700)):
        end = runner.end(script)
        reasons[end.reason if end else ""] += 1
        assert end is None or end.reason not in NEVER, (n, end)
        if n % 40 == 0:
            compare(f"script {n}", runner.course(script), ends)
    assert min(reasons[name] for name in ("sliding", "lifting", "off-palm")) >= 10, reasons
    assert ends.faults == ends.missed == []
    assert ends.agreed > 12
