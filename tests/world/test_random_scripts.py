# SPDX-License-Identifier: Apache-2.0
"""Whatever palms do: nothing sinks in, there are forces for every motion, and no end is early."""

from dataclasses import replace

import numpy as np
import pytest

from motion_oracle import Moment, slipperier
from palm_scripts import BALANCED, SUNK, Drive, Found, run, world_of
from script_ends import STEPS, compare_scripts

SCRIPTS = 12
COMPARED = 12


def test_nothing_sinks_in_and_forces_balance() -> None:
    found = Found()
    for seed in range(SCRIPTS):
        run(seed, found)
    assert found.faults == []
    assert found.checked > 10 * SCRIPTS
    assert found.judged_events > 0.8 * found.events > SCRIPTS
    assert found.ends["gave up"] == 0


def test_the_oracle_notices_a_wrong_friction_and_a_wrong_place() -> None:
    """The same motions, judged with less friction than the world has, and with the object lower."""
    seen = {"balance": 0, "depth": 0}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        world, oracle, on_floor = world_of(rng)
        slippery = slipperier(oracle, 0.5)
        here = Moment.of(world)
        drive = Drive(rng, on_floor)
        lower: list[Moment] = []
        for k in range(120):
            reason, *_, pieces = world.move(*drive.next(k, world.palms))
            before, here = here, Moment.of(world)
            if reason:
                break
            x, y, turn = here.pose
            lower.append(replace(here, pose=(x, y - 3e-6, turn)))
            if pieces == 1:
                seen["balance"] += (slippery.imbalance(before, here) or 0.0) > BALANCED
        seen["depth"] += int((oracle.deepest(lower) > SUNK).sum())
    assert min(seen.values()) > 50


def test_scripts_end_as_in_the_slow_world() -> None:
    ends = compare_scripts(range(COMPARED))
    assert ends.faults == ends.missed == []
    assert ends.clear_share >= 0.7 and ends.agreed > 0.7 * COMPARED


@pytest.mark.parametrize(
    ("seed", "end"),
    [
        (
            3100332,
            "toppled",
        ),  # COM comes over the tip of a palm while another one pushes from beside
        (3100371, "completed"),  # both rounded contacts slide, period after period
    ],
)
def test_what_goes_on_alike_has_no_events(seed: int, end: str) -> None:
    """The first object fell by a few micrometres in each period instead of turning about the tip.
    The second one began each period anew."""
    found = Found()
    run(seed, found)
    assert found.ends == {end: 1}
    assert found.events < 30


def test_no_corner_slips_under_a_heel() -> None:
    """Within one period a corner on the floor meets the face of a rising palm and its heel. At the
    end of the period it would be beyond the ends of both, so neither would show that it sank in."""
    found = Found()
    run(3105877, found)
    assert found.faults == [] and found.ends["completed"] == 0


def test_what_passes_by_or_leaves_slowly_ends_nothing() -> None:
    """An acute corner passes beside the end of a palm (88, 111). The tip of a palm leaves the arc
    that it has pushed along the floor, at first without any speed (222, 544). The tip of a palm
    approaches an edge by 5 nm per period (6337)."""
    ends = compare_scripts((88, 111, 222, 544, 6337))
    assert (ends.agreed, ends.faults, ends.missed) == (5, [], [])


def test_the_outer_end_of_a_palm_lifts_an_edge_that_it_passes_within_a_period() -> None:
    """At the end of the period the end of the heel would be far inside a box that stands at a wall.
    The world finds where it begins to lift it; it called that the end of the script (483)."""
    world, _, _ = world_of(np.random.default_rng(483))
    pivots = ((-0.04354877540720281, -0.02515352784903682), (1000.0, 0.01))
    world.put(pivots, (0.041236112420693756, 0.2831), (0.007023874581267243, 0.055), 0.0)
    ways = ((0.0006175903344992599, 0.0), (0.0, 0.0))
    assert world.move(ways, (0.046472100176676745, 0.2831))[0] == ""
    assert world.pose[2] < -1e-3


def test_a_tip_beside_an_arc_does_not_sink_into_it() -> None:
    found = Found()
    run(1102676, found)
    assert found.faults == []


def test_after_ambiguous_events_the_larger_margin_decides() -> None:
    """A corner of the object is caught between a palm and the floor, on either side: its contacts
    stick, and those of the other corner slide (2015). Two noses push up an edge (2448)."""
    ends = compare_scripts((2015, 2448), steps=STEPS[:1])
    assert (ends.ambiguous, ends.ambiguous_agreed) == (2, 2)


def test_the_slow_world_notices_a_wrong_friction() -> None:
    """With less friction it ends scripts elsewhere, or leaves the object in another pose."""
    ends = compare_scripts(range(6), lambda oracle: slipperier(oracle, 0.9), STEPS[:1])
    assert len(ends.faults) > 2
