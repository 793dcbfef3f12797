# SPDX-License-Identifier: Apache-2.0
"""Real processes whose station is heard late: somebody in the middle, without the key, holds its
packets back. Orders act only while they are young, and late words do not keep a carry going."""

from pathlib import Path

import pytest

from stepped_processes import SteppedProcesses

SOAK = pytest.mark.soak


@pytest.mark.parametrize("delay_s", [0.1, 1.0, pytest.param(30.0, marks=SOAK)])
def test_orders_act_only_within_their_age(tmp_path: Path, delay_s: float) -> None:
    """`limits.order_age_s` is 1 s, and a robot counts from its own packet that is acknowledged."""
    with SteppedProcesses(tmp_path, overrides={"task.distance_m": 0.1}) as pair:
        pair.packets.hold(delay_s, "station")
        pair.start()
        seen: set[str] = set()

        def goes_on() -> bool:
            seen.update(pair.modes().values())
            return pair.has_ended("station")

        pair.run_until(goes_on, 60.0)
        if delay_s < 1:
            assert pair.finish()["outcome"] == "delivered", pair.report()
            return
        pair.run_until(lambda: goes_on() and pair.packets.wait_s(pair.now_s, 9e9) > 100, 60.0)
        # Only its stop acts, at any age.
        assert seen <= {"off", "disarmed", "stopped"}, pair.report()
        assert pair.says(r"left: .*orders have no effect"), pair.report()
        assert "Traceback" not in pair.report()


def test_a_station_that_is_heard_late_counts_as_lost(tmp_path: Path) -> None:
    """`limits.station_limit_s` is 1 s."""
    with SteppedProcesses(tmp_path) as pair:
        pair.carry()
        pair.packets.hold(1.2, "station")
        pair.run_until(lambda: not pair.carries(), 3.0)
        assert "station_lost" in pair.faults().values(), pair.report()
        assert pair.finish()["outcome"] == "stopped", pair.report()


def test_a_start_is_void_while_the_robots_do_not_hear_each_other(tmp_path: Path) -> None:
    """Both have heard it. A radio that fails between them must not choose when they drive off."""
    with SteppedProcesses(tmp_path, overrides={"task.distance_m": 0.1}) as pair:
        pair.start()
        pair.run_until(lambda: {*pair.modes().values()} == {"armed"}, 20.0)
        pair.packets.cut(("left", "right"), ("right", "left"))
        pair.run(3.0)
        pair.packets.cut()
        pair.run_until(lambda: pair.has_ended("station"), 60.0)
        assert pair.says(r"left: ready"), pair.report()
        assert pair.says(r"left: armed \(partner_lost\)"), pair.report()
        assert not pair.says(r"left: (carrying|holding)"), pair.report()
