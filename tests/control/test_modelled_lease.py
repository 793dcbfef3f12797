# SPDX-License-Identifier: Apache-2.0
"""The leases for which the model checker's runs of `shared-sign` are stated, with clocks 2 % off.

A robot acts on a message until its age exceeds the lease in ticks of its own clock. A clock that is
2 % slow takes 1.02 times as long for that. A run with a lease of n cycles covers such messages if
they are at most n cycles old.
"""

import math
from fractions import Fraction

import model_check
import palmbots as pb
from palmbots.control.registry import resolve
from palmbots.control.table_timing import transition_table

CYCLE_S = Fraction(1, 10)  # of the runs for the default scene
SLOW = Fraction(102, 100)


def cycles(lease_s: Fraction) -> int:
    """The least number of cycles that covers a lease."""
    return math.ceil(lease_s * SLOW / CYCLE_S)


def modelled(name: str) -> int:
    """The lease of a run."""
    return int(model_check.runs()[name].parameters["LEASE"])


def lease_s(**keys: float) -> Fraction:
    scene = pb.load_scene("paper", {f"radio.{key}": value for key, value in keys.items()})
    table = transition_table(resolve("shared-sign"), scene)
    assert table is not None
    return Fraction(table["lease_s"]).limit_denominator(1000)


def test_run_of_the_default_scene_covers_its_lease() -> None:
    assert lease_s() == Fraction(42, 100)
    assert cycles(lease_s()) == modelled("signs-default") == 5


def test_run_with_the_brake_covers_029_s_and_not_03_s() -> None:
    assert cycles(lease_s(lease_s=0.29)) == modelled("signs-default-brake") == 3
    assert cycles(lease_s(lease_s=0.3)) == 4
    assert pb.load_scene("paper", {"radio.lease_s": 0.29}) is not None


def test_a_lease_of_029_s_is_long_enough_for_a_round_trip() -> None:
    """The radio of the default scene needs 0.22 s, so no robot falls silent for want of time."""
    keys = {"radio.lease_s": 0.29, "robot.noise_m_s": 0.03}
    short = pb.carry("paper", "shared-sign", seed=2, record=False, overrides=keys)
    usual = pb.carry(
        "paper", "shared-sign", seed=2, record=False, overrides={"robot.noise_m_s": 0.03}
    )
    assert short.trace_hash == usual.trace_hash
