# SPDX-License-Identifier: Apache-2.0
"""Comparisons of controllers: rows, their statistics, and refusals."""

import json
import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import rate_interval, wilson
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds
from palmbots.viz.sweep_figure import draw_sweep


def test_rows_are_ordered_by_controller_and_value() -> None:
    values: list[float] = []
    comparison = pb.compare(
        values=(0.0, 0.1),
        carries=20,
        seed=7,
        controllers=("none", "distributed"),
        on_progress=values.append,
    )
    assert [(r.controller, r.value) for r in comparison.rows] == [
        ("none", 0.0),
        ("none", 0.1),
        ("distributed", 0.0),
        ("distributed", 0.1),
    ]
    assert {r.key for r in comparison.rows} == {"radio.latency_s"}
    assert {r.n for r in comparison.rows} == {20}
    assert comparison.seed == 7
    assert values == sorted(values)
    assert {0.25, 0.5, 0.75, 1.0} <= set(values)


def test_carries_of_another_world_are_those_of_carry() -> None:
    near = {"task.distance_m": 0.05, "task.path.kind": "arc"}
    (row,) = pb.compare(
        key="robot.noise_m_s", values=[0.01], controllers=["silent"], carries=2, world="mujoco",
        overrides=near,
    ).rows  # fmt: skip
    carries = [
        pb.carry(controller="silent", seed=s, world="mujoco", record=False, overrides=near)
        for s in (0, 1)
    ]
    squares = [p**2 for c in carries for p in c.contact_rms_m.values()]
    assert row.rms_m == pytest.approx(math.sqrt(np.mean(squares)), rel=1e-12)
    assert row.n == 2 and row.messages_per_m == 0


def test_row_aggregates_single_carries() -> None:
    """The carries of a row are those of `carry` with the same seeds."""
    key, value, seeds = "robot.noise_m_s", 0.01, range(5, 25)
    (row,) = pb.compare(
        key=key, values=[value], controllers=["none"], carries=len(seeds), seed=seeds[0]
    ).rows
    carries = [
        pb.carry(controller="none", seed=s, record=False, overrides={key: value}) for s in seeds
    ]
    drops = sum(c.outcome == "dropped" for c in carries)
    squares = [p**2 for c in carries for p in c.contact_rms_m.values()]
    assert 0 < drops < len(seeds)
    assert row.drop_rate == drops / len(seeds)
    assert row.interval == wilson(drops, len(seeds))
    assert row.stall_rate == 0
    assert row.stall_interval == (0.0, pytest.approx(1 - 0.05 ** (1 / len(seeds))))
    means = [np.mean([p**2 for p in c.contact_rms_m.values()]) for c in carries]
    half = 1.959963984540054 * np.std(means, ddof=1) / math.sqrt(len(seeds))
    squares_ends = tuple(end**2 for end in row.rms_interval_m)
    assert squares_ends == pytest.approx((np.mean(means) - half, np.mean(means) + half))
    assert (row.messages_per_m, row.bytes_per_s) == (0, 0)
    assert row.rms_m == pytest.approx(math.sqrt(np.mean(squares)), rel=1e-12)
    (row,) = pb.compare(values=[0.05], controllers=["distributed"], carries=10).rows
    carries = [pb.carry(seed=s, record=False) for s in range(10)]
    assert row.corrections == pytest.approx(np.mean([len(c.corrections) for c in carries]))
    sent, way = sum(c.messages for c in carries), sum(c.distance_m for c in carries)
    assert row.messages_per_m == pytest.approx(sent / way)
    assert row.bytes_per_s == pytest.approx(32 * sent / sum(c.time_s for c in carries))


def test_all_rows_use_the_same_seeds() -> None:
    """A row does not depend on the other rows, and it has the requested precision."""
    options: dict[str, Any] = {"carries": 8, "seed": 3, "overrides": {"robot.noise_m_s": 0.02}}
    for precision in ("double", "float"):
        options |= {"precision": precision}
        several = pb.compare(values=[0.0, 0.1], controllers=["none", "distributed"], **options)
        for row in several.rows:
            alone = pb.compare(values=[row.value], controllers=[row.controller], **options)
            assert alone.rows == (row,)
            scene = {"radio.latency_s": row.value, **options["overrides"]}
            single = [
                pb.carry(
                    "paper", row.controller, seed=s, precision=precision, record=False,
                    overrides=scene,
                ).contact_rms_m.values()
                for s in range(3, 11)
            ]  # fmt: skip
            squares = [rms**2 for pair in single for rms in pair]
            assert row.rms_m == pytest.approx(math.sqrt(np.mean(squares)), rel=1e-12)


def test_outcomes_are_counted_separately() -> None:
    """Some carries arrive, some drop, and some time out."""
    keys = {"robot.noise_m_s": 0.025, "task.timeout_s": 25.2}
    (row,) = pb.compare(values=[0.05], controllers=["distributed"], carries=60, overrides=keys).rows
    keys |= {"radio.latency_s": 0.05}
    single = [pb.carry(seed=s, record=False, overrides=keys).outcome for s in range(60)]
    drops, stalls = single.count("dropped"), single.count("stalled")
    assert 0 < drops != stalls > 0
    assert drops + stalls < 60
    assert (row.drop_rate, row.interval) == (drops / 60, wilson(drops, 60))
    assert (row.stall_rate, row.stall_interval) == (stalls / 60, wilson(stalls, 60))


def test_interval_of_messages_with_different_distances() -> None:
    """Carries that end early send fewer messages over a shorter distance. The interval depends on
    the deviation of each carry from the common ratio. The reference is the jackknife, which uses no
    formula."""
    keys = {"robot.noise_m_s": 0.03}
    (row,) = pb.compare(
        values=[0.05], controllers=["distributed"], carries=400, overrides=keys
    ).rows
    scene = pb.load_scene("paper", keys | {"radio.latency_s": 0.05})
    run = run_seeds(to_spec(scene), "distributed", 0, 400)
    sent, way = run["messages"].astype(float), run["distance_m"]
    assert np.std(way) > 0.1 * np.mean(way)
    without = (sent.sum() - sent) / (way.sum() - way)
    half = 1.959963984540054 * math.sqrt(399 / 400 * np.sum((without - without.mean()) ** 2))
    low, high = row.messages_interval_per_m
    assert (high - low) / 2 == pytest.approx(half, rel=0.03)
    assert (high + low) / 2 == pytest.approx(row.messages_per_m)


def test_refusals_of_resilient_are_listed() -> None:
    result = pb.compare(values=[0.05, 0.5], controllers=["none", "resilient"], carries=2)
    values = [(row.controller, row.value) for row in result.rows]
    assert values == [("none", 0.05), ("none", 0.5), ("resilient", 0.05)]
    (why,) = result.refused
    assert why.startswith("radio.latency_s = 0.5: ") and "radio.lease_s" in why
    assert result.summary()["refused"] == [why]


def test_interval_of_messages_covers_the_mean() -> None:
    """About 95 % of the intervals of many small comparisons contain the ratio of very many
    carries."""
    whole = pb.compare(values=[0.05], controllers=["distributed"], carries=4000, seed=10**6).rows[0]
    inside, tries = 0, 100
    for i in range(tries):
        (row,) = pb.compare(
            values=[0.05], controllers=["distributed"], carries=20, seed=20 * i
        ).rows
        low, high = row.messages_interval_per_m
        inside += low <= whole.messages_per_m <= high
    assert 85 <= inside <= 99


def test_stalled_carries_are_no_drops() -> None:
    (row,) = pb.compare(
        values=[0.05], controllers=["distributed"], carries=5, overrides={"task.timeout_s": 2.0}
    ).rows
    assert (row.stall_rate, row.drop_rate) == (1.0, 0.0)


def test_controller_none_sends_no_messages() -> None:
    rows = pb.compare(controllers=["none"], values=[0.0, 0.5], carries=50).rows
    assert rows[0].drop_rate == rows[1].drop_rate
    assert rows[0].rms_m == rows[1].rms_m


@pytest.mark.parametrize("n", [1, 12, 200])
def test_wilson_solves_the_score_equation(n: int) -> None:
    """The ends are the rates p whose distance from events / n is 1.96 √(p (1 − p) / n)."""
    for events in range(n + 1):
        low, high = wilson(events, n)
        assert 0 <= low <= events / n <= high <= 1
        for end in (low, high):
            distance = abs(events / n - end)
            spread = 1.959963984540054 * math.sqrt(end * (1 - end) / n)
            if 0 < end < 1:
                assert distance == pytest.approx(spread, abs=1e-9)
    assert wilson(0, n)[0] == 0
    assert wilson(n, n)[1] == 1


@pytest.mark.parametrize("n", [1, 12, 200])
def test_the_interval_without_events_is_the_exact_one_sided_bound(n: int) -> None:
    """At its end, none of n trials is an event with a probability of 5 %."""
    low, high = rate_interval(0, n)
    assert low == 0
    assert (1 - high) ** n == pytest.approx(0.05)
    assert rate_interval(n, n) == (1 - high, 1)
    for events in range(1, n):
        assert rate_interval(events, n) == wilson(events, n)


def test_numpy_numbers_are_accepted() -> None:
    """Seeds may be elements of np.arange, and counts elements of arrays."""
    two, seven, three = (np.array([2, 7, 3], np.int64)[i] for i in range(3))
    (row,) = pb.compare(values=[0.0], controllers=["none"], carries=two, seed=seven).rows
    assert row == pb.compare(values=[0.0], controllers=["none"], carries=2, seed=7).rows[0]
    carry = pb.carry(seed=three, overrides={"task.distance_m": 0.05})
    assert (carry.seed, type(carry.seed)) == (3, int)


def test_single_carry_has_no_interval() -> None:
    """An interval of zero width would state that one carry is certain."""
    result = pb.compare(values=[0.0], controllers=["distributed"], carries=1)
    (row,) = result.rows
    assert all(math.isnan(end) for end in (*row.rms_interval_m, *row.messages_interval_per_m))
    summary = json.loads(json.dumps(result.summary(), allow_nan=False))["rows"][0]
    assert summary["rms_interval_m"] == summary["messages_interval_per_m"] == [None, None]
    assert summary["interval"] == [0.0, pytest.approx(0.95)]


def test_entry_of_a_list_can_be_swept() -> None:
    """As in a study, for example one coordinate of the COM."""
    swept: Any = {
        "key": "object.com_m[0]",
        "values": [0.1],
        "controllers": ["none"],
        "carries": 3,
    }
    (row,) = pb.compare(**swept).rows
    given = pb.compare(
        controllers=["none"], values=[0.05], carries=3, overrides={"object.com_m": [0.1, 0.04]}
    )
    assert (row.rms_m, row.drop_rate) == (given.rows[0].rms_m, given.rows[0].drop_rate)


def test_figure_sorts_values_and_cuts_nothing_off() -> None:
    values = [0.03, 0.01, 0.02]
    given = pb.compare(
        key="robot.noise_m_s", values=values, controllers=["none", "distributed"], carries=10,
        overrides={"task.distance_m": 0.2},
    )  # fmt: skip
    figure: Any = draw_sweep(given)
    labels = ["dropped [%]", "stalled [%]", "contact rms [mm]", "messages per metre"]
    assert [axes.get_ylabel() for axes in figure.axes] == labels
    scales = {"drop_rate": 100, "stall_rate": 100, "rms_m": 1e3, "messages_per_m": 1}
    for axes, (field, scale) in zip(figure.axes, scales.items(), strict=True):
        low, high = axes.get_ylim()
        for bars, controller in zip(axes.containers, ("none", "distributed"), strict=True):
            line = bars.lines[0]
            rows = sorted((row.value, row) for row in given.rows if row.controller == controller)
            assert list(line.get_xdata()) == sorted(values)
            shown = [scale * getattr(row, field) for _, row in rows]
            assert list(line.get_ydata()) == pytest.approx(shown)
            assert low < min(shown) or field == "rms_m"
            assert max(shown) < high - 0.02 * (high - low)
