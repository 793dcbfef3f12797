# SPDX-License-Identifier: Apache-2.0
"""The model checker on the shipped controllers: the quick runs of verify/, each with its pinned
size or its stored counterexample, and a test that the checker detects a fault.
"""

import dataclasses
import functools

import pytest

import model_check as explore

QUICK = {name: run for name, run in explore.runs().items() if run.quick}


@functools.cache
def found_by(name: str) -> explore.Finding:
    return explore.explore(QUICK[name])


@pytest.mark.parametrize("name", QUICK)
def test_search_gives_the_recorded_counts(name: str) -> None:
    """The property holds over the recorded number of states, or fails with the stored
    counterexample."""
    result = found_by(name)
    assert explore.check(result) is None, f"{result.violated}\n{result.transcript}"


def test_every_search_has_a_recorded_count() -> None:
    """Every record belongs to a run, and every run has a record."""
    runs = explore.runs().values()
    assert sorted(explore.pinned()) == sorted(run.name for run in runs if run.fails is None)
    table = {path.stem for path in (explore.HERE / "counterexamples").glob("*.txt")}
    assert table == {run.name for run in runs if run.fails is not None}


def test_changed_count_is_reported() -> None:
    """A different count is a fault, and so is an unmet expectation."""
    result = found_by("prompt")
    assert explore.check(result) is None
    assert explore.check(dataclasses.replace(result, states=result.states + 1)) is not None
    assert explore.check(dataclasses.replace(result, violated="FALL")) is not None
    assert explore.check(dataclasses.replace(result, complete=False)) is not None
