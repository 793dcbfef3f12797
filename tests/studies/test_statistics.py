# SPDX-License-Identifier: Apache-2.0
"""Exact sums, confidence intervals, and early stopping."""

import itertools
import math
import random
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import wilson
from palmbots.studies.chunk_task import Block
from palmbots.studies.exact_sums import WIDTH, count_of, exact_sums_of, sum_of
from palmbots.studies.statistics import pooled_counts, statistics_of
from palmbots.studies.stopping import is_precise_enough
from palmbots.studies.study_file import Stop, load_plan
from palmbots.studies.study_runner import run_study
from palmbots.studies.variables import VARIABLES


def block_of(outcome: NDArray[Any], **columns: NDArray[Any]) -> Block:
    """A block with these columns and 0 elsewhere."""
    block = {
        name: np.zeros(variable.shape(outcome.shape), variable.dtype)
        for name, variable in VARIABLES.items()
    }
    for name, values in (columns | {"outcome": outcome}).items():
        block[name][...] = values
    return block


def random_block(points: int, controllers: int, seeds: int, seed: int) -> Block:
    rng = np.random.default_rng(seed)
    shape = (points, controllers, seeds)
    return block_of(
        rng.integers(0, 4, shape),
        contact_rms_m=10 ** rng.uniform(-7, 0, (*shape, 2)),
        contact_peak_m=10 ** rng.uniform(-5, 0, (*shape, 2)),
        time_s=10 ** rng.uniform(-2, 5, shape),
        corrections=rng.integers(0, 500, shape),
        messages=rng.integers(0, 50_000, shape),
        waiting_s=rng.uniform(0, 10, (*shape, 2)),
    )


def piece(block: Block, part: slice) -> Block:
    return {name: column[:, :, part] for name, column in block.items()}


@given(cuts=st.lists(st.integers(0, 60), max_size=6), seed=st.integers(0, 20))
def test_exact_sums_do_not_depend_on_the_division(cuts: list[int], seed: int) -> None:
    block = random_block(2, 2, 60, seed)
    whole = exact_sums_of(block)
    ends = [0, *sorted(cuts), 60]
    parts = [exact_sums_of(piece(block, slice(a, b))) for a, b in itertools.pairwise(ends)]
    random.Random(seed).shuffle(parts)
    assert (sum(parts, np.zeros_like(whole)) == whole).all()


def test_sums_are_exact() -> None:
    block = random_block(1, 2, 500, 0)
    sums = exact_sums_of(block)
    done = block["outcome"][0] != 0
    for name, power in (("mean_time_s", 1), ("mean_time_s²", 2)):
        for c in range(2):
            times = block["time_s"][0, c][block["outcome"][0, c] == 1]
            exact = sum(Fraction(float(t) ** power) for t in times)
            assert sum_of(sums, name)[0, c] == pytest.approx(float(exact), rel=1e-15)
    rms = block["contact_rms_m"][0].astype(float)
    square = (rms * rms).mean(axis=2)
    both = done[0] & done[1]
    excess = [float(x) for x in (square[1] - square[0])[both]]
    assert sum_of(sums, "square_difference")[0, 1] == pytest.approx(
        float(sum(map(Fraction, excess))), rel=1e-14
    )
    assert sum_of(sums, "square_difference")[0, 0] == 0
    assert count_of(sums, "pairs")[0].tolist() == [done[0].sum(), both.sum()]


def cover(make: Callable[[np.random.Generator], bool], times: int = 1000) -> float:
    rng = np.random.default_rng(1)
    return sum(make(rng) for _ in range(times)) / times


def test_interval_of_a_paired_difference_covers() -> None:
    """Drops that are correlated, as common seeds make them."""

    rng = np.random.default_rng(1)
    first, both = rng.random((1000, 2, 200)), rng.random((1000, 1, 200))
    drops = np.where(both < 0.7, first[:, :1], first) < np.array([[0.1], [0.16]])
    sums = exact_sums_of(block_of(np.where(drops, 2, 1)))
    _, ends = statistics_of(sums)["drop_rate_difference"]
    assert ends is not None
    covers = (ends[:, 1, 0] <= 0.06) & (ends[:, 1, 1] >= 0.06)
    assert 0.925 < covers.mean() < 0.98


@pytest.mark.parametrize(
    ("first", "this", "n"), [(0, 0, 3), (3, 0, 3), (0, 3, 3), (9, 2, 40), (0, 1, 1000), (0, 0, 0)]
)
def test_interval_of_a_paired_difference_in_closed_form(first: int, this: int, n: int) -> None:
    """Agresti and Min (2005): Wald's interval with half a pair added to each of four kinds."""
    outcome = np.ones((1, 2, n + 1), int)
    outcome[0, :, n] = 0  # not carried
    outcome[0, 0, :first] = 2
    outcome[0, 1, first : first + this] = 2
    rate, ends = statistics_of(exact_sums_of(block_of(outcome)))["drop_rate_difference"]
    assert ends is not None
    if n == 0:
        assert np.isnan(rate).all() and np.isnan(ends).all()
        return
    assert rate[0].tolist() == [0, (this - first) / n]
    assert ends[0, 0].tolist() == [0, 0]
    shares = [(count + 0.5) / (n + 2) for count in (first, this)]
    centre = shares[1] - shares[0]
    half = 1.959963984540054 * math.sqrt((sum(shares) - centre**2) / (n + 2))
    low, high = max(centre - half, -1), min(centre + half, 1)
    assert ends[0, 1] == pytest.approx([low, high], rel=1e-12)


def test_ends_of_every_interval_in_closed_form() -> None:
    """Of means the normal interval of those carries that count, of rates Wilson's; drops, stalls
    and deliveries are distinguished."""
    block = random_block(1, 2, 300, 4)
    found = statistics_of(exact_sums_of(block))
    outcome = block["outcome"][0]
    done, arrived = outcome != 0, outcome == 1
    square = (block["contact_rms_m"][0].astype(float) ** 2).mean(axis=2)
    excess = square - square[0]
    each = {
        "mean_time_s": (block["time_s"][0], arrived),
        "mean_corrections": (block["corrections"][0], done),
        "mean_peak_m": (block["contact_peak_m"][0].max(axis=2), done),
        "square_difference": (excess, done & done[0]),
    }
    for name, (values, counted) in each.items():
        for c in range(2):
            some = values[c][counted[c]].astype(float)
            half = 1.959963984540054 * some.std(ddof=1) / math.sqrt(some.size)
            mean, ends = found[name]
            assert ends is not None
            assert mean[0, c] == pytest.approx(some.mean(), rel=1e-9, abs=1e-18), name
            expected = pytest.approx([some.mean() - half, some.mean() + half], rel=1e-9, abs=1e-18)
            assert ends[0, c] == expected, name
    for c in range(2):
        some = square[c][done[c]]
        half = 1.959963984540054 * some.std(ddof=1) / math.sqrt(some.size)
        rms, ends = found["rms_m"]
        assert ends is not None
        expected = np.sqrt([some.mean() - half, some.mean(), some.mean() + half])
        assert [ends[0, c, 0], rms[0, c], ends[0, c, 1]] == pytest.approx(expected, rel=1e-9)
    for name, code in (("drop_rate", 2), ("stall_rate", 3)):
        for c in range(2):
            events, n = int((outcome[c] == code).sum()), int(done[c].sum())
            rate, ends = found[name]
            assert ends is not None
            assert rate[0, c] == events / n
            assert ends[0, c] == pytest.approx(wilson(events, n), rel=1e-12)
    counts = [int((outcome == code).sum()) for code in (2, 3)]
    assert counts[0] != counts[1]
    assert pooled_counts(exact_sums_of(block)) == (int(done.sum()), *counts)


def test_common_seeds_narrow_the_difference() -> None:
    rng = np.random.default_rng(0)
    luck = rng.random(1000)
    paired = np.where(np.array([luck < 0.10, luck < 0.13]), 2, 1)[None]
    apart = np.where(np.array([luck < 0.10, rng.random(1000) < 0.13]), 2, 1)[None]
    widths = []
    for outcome in (paired, apart):
        _, ends = statistics_of(exact_sums_of(block_of(outcome)))["drop_rate_difference"]
        assert ends is not None
        widths.append(ends[0, 1, 1] - ends[0, 1, 0])
    assert widths[0] < 0.6 * widths[1]


@pytest.mark.parametrize("rate", [0.01, 0.1, 0.5])
def test_intervals_still_cover_where_cells_stop_early(rate: float) -> None:
    """What the docs say of looking again and again."""
    stop = Stop(block=100, drop_rate=0.02)

    def one(rng: np.random.Generator) -> bool:
        dropped = np.cumsum((rng.random(4000) < rate).reshape(40, 100).sum(axis=1))
        n = 100 * np.arange(1, 41)
        sums = np.zeros((1, 40, WIDTH), np.int64)
        sums[..., 0], sums[..., 3] = n, dropped
        enough = is_precise_enough(sums, stop)[0]
        at = int(np.argmax(enough)) if enough.any() else 39
        low, high = wilson(int(dropped[at]), int(n[at]))
        return low <= rate <= high

    assert cover(one) > 0.9


STOPPING: dict[str, Any] = {
    "controllers": ["centralized", "distributed"],
    "vary": {"robot.noise_m_s": [0.01, 0.02, 0.03]},
    "seeds": {"count": 400},
    "stop": {"block": 40, "drop_rate": 0.045},
}


@pytest.mark.slow
def test_cells_stop_at_the_first_precise_block(tmp_path: Path) -> None:
    """Each at the first block end at which its interval is narrow enough, and not before."""
    done = run_study(load_plan(STOPPING), tmp_path / "study")
    full = run_study(
        load_plan({**STOPPING, "stop": {"block": 40, "drop_rate": 1e-6}}), tmp_path / "f"
    )
    found, whole = done.dataset().load(), full.dataset().load()
    counts = set()
    assert int(whole.carries.min()) == 400
    for noise in range(3):
        for c in range(2):
            drops = whole.outcome.values[noise, c] == 2
            ends = {n: wilson(int(drops[:n].sum()), n) for n in range(40, 401, 40)}
            n = next((n for n, (low, high) in ends.items() if (high - low) / 2 <= 0.045), 400)
            cell = found.isel({"robot.noise_m_s": noise, "controller": c})
            assert int(cell.carries) == n
            counts.add(n)
            assert (cell.outcome.values[:n] == whole.outcome.values[noise, c, :n]).all()
            assert not cell.outcome.values[n:].any(), "left out, not missing"
    assert len(counts) >= 3
    assert done.carries == int(found.carries.sum()) < 2400


SOON: dict[str, Any] = {
    **STOPPING, "seeds": {"count": 160}, "stop": {"block": 40, "drop_rate": 0.08}
}  # fmt: skip


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The hash of a study that stops early, carried backward by one thread."""
    root = tmp_path_factory.mktemp("stopped") / "study"
    plan = load_plan(SOON)

    def backward(chunks: Iterable[int]) -> list[int]:
        return sorted(chunks, reverse=True)

    done = run_study(plan, root, order=backward, threads=1)
    assert len(set(done.dataset().carries.values.flat)) > 1  # some cells stop, others do not
    return done.hash


@pytest.mark.slow
@pytest.mark.parametrize("chunk", [66, 500, 10**6])
def test_stopping_does_not_depend_on_chunks(tmp_path: Path, chunk: int, stopped: str) -> None:
    assert run_study(load_plan(SOON), tmp_path / "study", chunk_size=chunk).hash == stopped


def test_stopping_by_rms() -> None:
    stop = Stop(block=10, rms=0.05)
    rng = np.random.default_rng(0)
    outcome = np.ones((1, 1, 400))
    rms = np.abs(rng.normal(0.005, 0.001, (1, 1, 400, 2)))
    reached = [
        n
        for n in range(10, 401, 10)
        if is_precise_enough(
            exact_sums_of(piece(block_of(outcome, contact_rms_m=rms), slice(n))), stop
        )[0, 0]
    ]
    square = (rms[0, 0].astype(np.float32).astype(float) ** 2).mean(axis=1)
    for n in (reached[0] - 10, reached[0]):
        mean, spread = square[:n].mean(), 1.96 * square[:n].std(ddof=1) / math.sqrt(n)
        half = (math.sqrt(mean + spread) - math.sqrt(mean - spread)) / 2
        assert (half <= 0.05 * math.sqrt(mean)) == (n == reached[0])


def test_stopping_by_two_conditions_needs_both() -> None:
    """Drops that are rare are known before the rms is, and the other way round."""
    rng = np.random.default_rng(0)
    scattered = np.abs(rng.normal(0.005, 0.004, (1, 1, 2000, 2)))
    even = np.full((1, 1, 2000, 2), 0.005)
    sure, unsure = np.ones((1, 1, 2000)), 1 + (rng.random((1, 1, 2000)) < 0.5)
    for outcome, rms in ((sure, scattered), (unsure, even)):
        sums = exact_sums_of(piece(block_of(outcome, contact_rms_m=rms), slice(600)))
        one, other = ({"drop_rate": 0.01}, {"rms": 0.01})
        each = [bool(is_precise_enough(sums, Stop(block=10, **k))[0, 0]) for k in (one, other)]
        assert sorted(each) == [False, True]
        assert not is_precise_enough(sums, Stop(block=10, **one, **other))[0, 0]


def test_refused_cells_stay_empty_with_early_stopping(tmp_path: Path) -> None:
    """A cell that may not be carried is never precise enough, and is not carried for that."""
    table = {
        "controllers": ["distributed", "resilient"],
        "vary": {"radio.latency_s": [0.05, 0.5]},
        "seeds": {"count": 40},
        "stop": {"block": 10, "drop_rate": 0.2},
    }
    done = run_study(load_plan(table), tmp_path / "study")
    assert done.values["carries"][0].tolist() == [[10, 10], [10, 0]]
