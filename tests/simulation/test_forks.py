# SPDX-License-Identifier: Apache-2.0
"""Forks: the same carry until a time, other random numbers from then on; logs know them."""

from pathlib import Path

import numpy as np
import pytest

import palmbots as pb
from palmbots.control.registry import shipped_names

SHORT = {"task.distance_m": 0.4, "radio.loss": 0.1}


def contacts(result: pb.simulation.Carry) -> np.ndarray:
    assert result.trace is not None
    return result.trace["contact"].to_numpy()


@pytest.mark.parametrize("at_s", [0.01, 1.28, 2.5])
def test_a_fork_changes_only_what_comes_after(at_s: float) -> None:
    plain = pb.carry("paper", seed=3, overrides=SHORT)
    forked = pb.carry("paper", seed=3, forks=[(at_s, 99)], overrides=SHORT)
    tick = round(at_s / 0.01)
    one, two = contacts(plain), contacts(forked)
    assert one[: tick + 1].tobytes() == two[: tick + 1].tobytes()
    assert one[tick + 1].tobytes() != two[tick + 1].tobytes()


@pytest.mark.parametrize("controller", shipped_names())
def test_a_fork_to_the_same_seed_changes_nothing(controller: str) -> None:
    plain = pb.carry("paper", controller, seed=5, overrides=SHORT)
    forked = pb.carry("paper", controller, seed=5, forks=[(1.03, 5), (2.0, 5)], overrides=SHORT)
    assert plain.trace_hash == forked.trace_hash


def test_a_second_fork_takes_over_from_the_first() -> None:
    first = pb.carry("paper", seed=1, forks=[(1.0, 7)], overrides=SHORT)
    both = pb.carry("paper", seed=1, forks=[(1.0, 7), (2.0, 8)], overrides=SHORT)
    assert contacts(first)[:201].tobytes() == contacts(both)[:201].tobytes()
    assert first.trace_hash != both.trace_hash
    assert both.forks == ((1.0, 7), (2.0, 8))
    assert ", 7 from 1 s, 8 from 2 s" in both.headline()


def test_a_log_is_replayed_with_its_forks(tmp_path: Path) -> None:
    carried = pb.carry("paper", seed=1, forks=[(1.0, 7)], overrides=SHORT)
    pb.write_log(carried, tmp_path / "carry.mcap")
    found = pb.replay(tmp_path / "carry.mcap")
    assert found.identical
    assert found.log.forks == ((1.0, 7),)
