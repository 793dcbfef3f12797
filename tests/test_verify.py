"""The model checker on the shipped controllers: the quick runs of verify/, each with its pinned
size or its kept counterexample, and that the checker can see a fault."""

import dataclasses
import functools

import pytest

import explore

QUICK = {name: run for name, run in explore.runs().items() if run.quick}


@functools.cache
def found_by(name: str) -> explore.Finding:
    return explore.explore(QUICK[name])


@pytest.mark.parametrize("name", QUICK)
def test_run(name: str) -> None:
    """It holds over as many states as ever, or fails as the kept counterexample tells."""
    found = found_by(name)
    assert explore.check(found) is None, f"{found.violated}\n{found.transcript}"


def test_every_search_has_a_record() -> None:
    """No pin and no counterexample without its run, and no run without."""
    runs = explore.runs().values()
    assert sorted(explore.pinned()) == sorted(run.name for run in runs if run.fails is None)
    kept = {path.stem for path in (explore.HERE / "counterexamples").glob("*.txt")}
    assert kept == {run.name for run in runs if run.fails is not None}


def test_a_changed_count_shows() -> None:
    """A pin that is not met is a fault, and so is an unmet expectation."""
    found = found_by("prompt")
    assert explore.check(found) is None
    assert explore.check(dataclasses.replace(found, states=found.states + 1)) is not None
    assert explore.check(dataclasses.replace(found, violated="FALL")) is not None
    assert explore.check(dataclasses.replace(found, complete=False)) is not None
