# SPDX-License-Identifier: Apache-2.0
"""The covered distance: counted from the start of each carry, and on over a boot."""

import pytest

from palmbots.robot.odometry import Approach, Odometry


def test_each_carry_counts_from_its_start() -> None:
    odometry = Odometry(1.0)
    for distance_m, carries, covered_m in (
        (3.0, False, 0.0), (3.2, False, 0.0), (3.3, True, 0.1), (4.25, True, 1.05),
        (4.3, False, 0.0), (4.8, True, 0.5),
    ):  # fmt: skip
        odometry.take(distance_m, carries)
        assert odometry.covered_m == pytest.approx(covered_m)
        assert odometry.is_covered() == (covered_m >= 1.0)
        assert odometry.is_covered(0.5) == (covered_m >= 0.5)
        assert odometry.share == pytest.approx(min(1.0, covered_m))


@pytest.mark.parametrize("counts_from_m", [0.0, 7.0])
def test_a_carry_goes_on_after_a_boot(counts_from_m: float) -> None:
    """Also if the driver counts anew."""
    before = Odometry(1.0)
    before.take(7.0, False)
    before.take(7.63, True)
    assert 0.6 <= before.to_store_m <= 0.63
    after = Odometry(1.0, before.to_store_m)
    after.take(counts_from_m, True)
    assert after.covered_m == pytest.approx(before.to_store_m)
    after.take(counts_from_m + 0.2, True)
    assert after.covered_m == pytest.approx(before.to_store_m + 0.2)
    after.take(counts_from_m + 0.2, False)
    assert after.covered_m == 0.0


def test_only_the_carrying_phase_of_a_job_counts() -> None:
    """A robot that docks, or leaves, covers no distance."""
    odometry = Odometry(1.0)
    for distance_m, counts, covered_m in (
        (2.0, False, 0.0), (2.3, False, 0.0), (2.4, True, 0.1), (2.9, True, 0.6),
        (2.7, False, 0.6), (2.8, True, 0.7),
    ):  # fmt: skip
        odometry.take(distance_m, True, counts)
        assert odometry.covered_m == pytest.approx(covered_m)


def test_little_is_stored() -> None:
    odometry = Odometry(1.5)
    stored = set()
    for step in range(2500):
        odometry.take(0.0006 * step, step > 0)
        stored.add(odometry.to_store_m)
    assert 40 < len(stored) <= 52


def test_a_robot_stays_below_the_object_until_it_drives_back() -> None:
    approach = Approach(0.1, 0.0)
    for distance_m, carries, backs_off, is_there in (
        (5.0, False, False, False), (5.08, True, False, False), (5.11, True, False, True),
        (5.07, True, False, True), (5.05, True, True, False), (5.0, True, False, False),
        (5.12, True, False, True), (5.1, False, False, False), (5.15, True, False, False),
    ):  # fmt: skip
        approach.drive(distance_m, carries, backs_off)
        assert approach.is_there == is_there


@pytest.mark.parametrize(("driven_m", "stored_m"), [(0.05, 0.04), (0.11, 0.1)])
def test_after_a_boot_a_robot_goes_on_below_the_object(driven_m: float, stored_m: float) -> None:
    before = Approach(0.1, 0.0)
    before.drive(3.0, False, False)
    before.drive(3.0 + driven_m, True, False)
    assert before.to_store_m == stored_m
    after = Approach(0.1, before.to_store_m)
    after.drive(0.0, True, False)
    assert after.is_there == (driven_m > 0.1)
    after.drive(0.07, True, False)
    assert after.is_there
    anew = Approach(0.1, before.to_store_m)  # a carry that does not go on
    anew.drive(0.0, False, False)
    assert not anew.is_there
