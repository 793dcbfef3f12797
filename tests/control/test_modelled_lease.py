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


def test_runs_of_the_default_scene_cover_its_lease() -> None:
    assert lease_s() == Fraction(37, 100)
    for name in ("signs-default", "signs-default-brake", "signs-arrive-default"):
        assert modelled(name) == cycles(lease_s()) == 4, name


def test_runs_with_the_brake_cover_039_s_and_not_04_s() -> None:
    assert cycles(lease_s(lease_s=0.39)) == modelled("signs-default-brake")
    assert cycles(lease_s(lease_s=0.4)) == modelled("signs-lease-brake")
