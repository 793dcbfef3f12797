# SPDX-License-Identifier: Apache-2.0
"""The time that an assessment says is left is the time that it takes."""

from itertools import pairwise

import pytest

from palmbots._util.time_left import TimeLeft, announced

PARTS = {"counts": 10.0, "load": 30.0, "curve": 60.0}


@pytest.mark.parametrize("guess", [0.5, 1.0, 3.0])
def test_fraction_follows_the_time(guess: float) -> None:
    now = 0.0
    shown: list[tuple[float, float]] = []
    left = TimeLeft(lambda done: shown.append((now, done)), (*PARTS, "friction"), lambda: now)
    left.expect(**{part: guess * seconds for part, seconds in PARTS.items()})
    for part, seconds in PARTS.items():
        start, report = now, left.begin(part)
        for step in range(1, 11):
            now = start + 0.1 * step * seconds
            report(0.1 * step)
        assert left.spent_s() == pytest.approx(seconds)
        if part == "load":  # a better guess
            left.expect(curve=PARTS["curve"])
    assert shown[-1] == pytest.approx((100.0, 1.0))
    assert all(a[1] <= b[1] for a, b in pairwise(shown))
    for time, done in shown:
        if time > 40.0:
            assert done == pytest.approx(time / 100.0, abs=1e-9 if guess >= 1 else 0.2)
        elif time > 0:  # the rest is known up to the factor of the guess
            said_s = time * (1 - done) / done
            assert 0.99 * min(guess, 1.0) <= said_s / (100.0 - time) <= 1.01 * max(guess, 1.0)


def test_nothing_is_claimed_before_anything_is_known() -> None:
    """An assessment that knows nothing yet of how long its parts take showed 100 % at once."""
    now, shown = 0.0, list[float]()
    left = TimeLeft(shown.append, ("counts", "load"), lambda: now)
    now = 0.1
    report = left.begin("counts")
    now = 1.0
    report(0.01)
    assert shown == [0.0, 0.0]
    left.expect(load=6.0)
    now = 2.0
    report(0.5)
    assert shown[-1] == pytest.approx(2.0 / (2.0 + 1.9 + 6.0))
    now = 4.0
    report(1.0)
    report = left.begin("load")
    assert shown[-1] == pytest.approx(0.4)
    now = 9.0  # it takes longer than expected
    report(0.0)
    assert shown[-1] == pytest.approx(9.0 / (9.0 + 0.2 * 6.0))


def test_total_contains_what_is_expected() -> None:
    now = 5.0
    left = TimeLeft(lambda done: None, ("a", "b"), lambda: now)
    left.expect(a=3.0, b=4.0, unknown=100.0)
    assert left.total_s == 7.0
    left.begin("a")
    now = 7.0
    assert left.total_s == 6.0


@pytest.mark.parametrize(("total_s", "said"), [(1.9, []), (52.34, ["it takes about 52.0 s"])])
def test_time_of_the_whole_work_is_stated_once(total_s: float, said: list[str]) -> None:
    now, lines, shown = 3.0, list[str](), list[float]()
    report = announced(shown.append, lines.append, "it", lambda: now)
    for step in range(101):
        now = 3.0 + 0.01 * step * total_s
        report(0.01 * step)
        assert lines == (said if step >= 4 else [])
    assert shown == [0.01 * step for step in range(101)]
