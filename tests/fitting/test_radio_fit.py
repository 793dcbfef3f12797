# SPDX-License-Identifier: Apache-2.0
"""The radio, found again: from simulated links with hidden values, by other ways of computing the
same, and from recordings of others where they are there."""

import io
import itertools
import lzma
import tarfile
import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog, minimize
from scipy.stats import binom

import palmbots as pb
from palmbots.fitting.fit import write_fit
from palmbots.fitting.fitted_values import Estimate
from palmbots.fitting.loss_likelihood import Floats, LossFit, burst_log_density
from palmbots.fitting.radio_fit import RadioFit, fit_radio
from palmbots.fitting.recorded_packets import above_line
from recordings import gilbert, packets_csv

DATA = Path(__file__).parents[3] / "shared" / "data" / "radio"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="needs ../shared/data/radio")


def counted(lost: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Numbers of packets lost between arrivals, and how often each occurs."""
    gaps = np.diff(np.flatnonzero(~lost)) - 1
    counts, times = np.unique(gaps, return_counts=True)
    return counts.astype(float), times.astype(float)


def logit(p: float) -> float:
    return float(np.log(p / (1 - p)))


def by_key(found: RadioFit) -> dict[str, Estimate]:
    return {one.key: one for one in found.estimates}


def test_the_density_is_that_of_a_walk_through_the_states() -> None:
    """Sums over all 2ᵏ⁺¹ sequences of states, from the probabilities of the scene's radio."""
    for loss, share, length in ((0.01, 0.1, 3.0), (0.3, 0.02, 0.4), (0.001, 0.6, 20.0)):
        kept = np.exp(-1 / ((1 - share) * length))
        stays = {(x, 1): share + (x - share) * kept for x in (0, 1)}
        stays |= {(x, 0): 1 - stays[x, 1] for x in (0, 1)}
        wanted = []
        for k in range(7):
            total = 0.0
            for word in range(2**k):
                states = [0, *((word >> j) & 1 for j in range(k)), 0]
                steps = [stays[a, b] for a, b in itertools.pairwise(states)]
                fates = [1.0 if x else loss for x in states[1:-1]]
                total += float(np.prod(steps) * np.prod(fates)) * (1 - loss)
            wanted.append(np.log(total))
        parameters = np.array([[logit(loss), logit(share), np.log(length)]])
        found = burst_log_density(parameters, np.arange(7.0))[0]
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9)
        many = np.exp(burst_log_density(parameters, np.arange(5000.0)))
        assert many.sum() == pytest.approx(1, abs=1e-6)


def test_the_fit_is_the_one_of_scipy() -> None:
    counts, times = counted(gilbert(np.random.default_rng(1), 30000, 0.01, 0.05, 4.0))
    found = LossFit(counts, times)
    assert found.best is not None

    def cost(x: Floats) -> float:
        return -float(burst_log_density(x[None], counts)[0] @ times)

    other = minimize(cost, [logit(0.02), logit(0.02), 1.0], method="Nelder-Mead")
    assert found.best.value == pytest.approx(-other.fun, abs=2e-3)
    assert found.best.place == pytest.approx(other.x, abs=0.03)


HIDDEN = 0.02, 0.08, 5.0


def test_intervals_cover_the_hidden_values() -> None:
    """Of 30 links. Each bound fails for a right interval in one of 1000 tests."""
    fits, hits = 30, np.zeros(3)
    for seed in range(fits):
        lost = gilbert(np.random.default_rng(100 + seed), 6000, *HIDDEN)
        found = LossFit(*counted(lost)).values()
        hits += [low <= truth <= high for truth, (_, low, high) in zip(HIDDEN, found, strict=True)]
    assert (hits >= binom.ppf(1e-3, fits, 0.95)).all(), hits


def test_independent_losses_give_no_bursts(tmp_path: Path) -> None:
    """At most 5 % of links seem to have bursts."""
    seem = 0
    for seed in range(30):
        lost = np.random.default_rng(seed).random(3000) < 0.1
        seem += LossFit(*counted(lost)).gain >= 3.0
    assert seem <= binom.ppf(0.999, 30, 0.05)
    index = np.flatnonzero(np.random.default_rng(0).random(3000) >= 0.1).astype(float)
    found = by_key(fit_radio([packets_csv(tmp_path, "one.csv", "index", index)]))
    loss = found["radio.loss"]
    assert loss.low is not None and loss.high is not None
    assert loss.low < 0.1 < loss.high < loss.low + 0.04
    assert not found["radio.burst_s"].is_identified


def test_the_line_of_the_clocks_is_the_one_of_a_linear_program() -> None:
    random = np.random.default_rng(2)
    x = np.sort(random.uniform(0, 100, 300))
    y = 3 + 1.0001 * x + random.exponential(0.01, 300)
    a = np.column_stack([np.ones(300), x])
    best = linprog(-a.sum(axis=0), A_ub=a, b_ub=y, bounds=[(None, None)] * 2).x
    assert above_line(x, y) == pytest.approx(y - a @ best, abs=1e-6)


def test_uniform_delays_give_their_width_and_reordering_is_seen(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    sent = 0.01 * np.arange(20000)
    arrived = 1.0002 * sent + random.uniform(0, 0.03, len(sent)) + 77
    order = np.argsort(arrived)
    kept = order[random.random(len(order)) > 0.05]
    rows = np.repeat(kept, np.where(np.arange(len(kept)) % 100 == 0, 2, 1))
    file = packets_csv(tmp_path, "one.csv", "index,time_s", rows.astype(float), arrived[rows])
    result = fit_radio([file])
    found = by_key(result)
    jitter = found["radio.jitter_s"]
    assert jitter.low is not None and jitter.high is not None
    assert jitter.low < 0.03 < jitter.high < jitter.low + 0.002
    assert result.keys["radio.reorder"] is True
    assert result.reordered > 1000
    assert result.duplicates == 190 or result.duplicates == 191
    assert not found["radio.latency_s"].is_identified
    paused = packets_csv(tmp_path, "paused.csv", "index,time_s", rows.astype(float),
                         np.sort(arrived[rows] + 5.0 * (rows > 9000)))  # fmt: skip
    assert "record sent_s" in by_key(fit_radio([paused]))["radio.jitter_s"].reason


def test_round_trips_give_halves_and_tails_with_intervals(tmp_path: Path) -> None:
    """Both ways have a latency of 4 ms and a jitter of 6 ms; one of 500 packets takes 0.2 s."""
    random = np.random.default_rng(4)
    files, count = [], 4000
    for run in range(6):
        trips = 0.008 + random.uniform(0, 0.006, (2, count)).sum(axis=0)
        slow = random.random(count) < 0.002
        trips[slow] = 0.2 + 0.001 * random.random(int(slow.sum()))
        files.append(packets_csv(tmp_path, f"{run}.csv", "index,round_trip_s",
                                 np.arange(count * 1.0), trips))  # fmt: skip
    found = by_key(fit_radio(files))
    assert found["radio.latency_s"].value == pytest.approx(0.004, rel=0.03)
    assert found["radio.jitter_s"].value == pytest.approx(0.006, rel=0.1)
    tail = found["round_trip_p99_9_s"]
    assert tail.low is not None and 0.2 <= tail.low < 0.201
    few = by_key(fit_radio([packets_csv(tmp_path, "f.csv", "round_trip_s", trips[:900])]))
    assert few["round_trip_p99_9_s"].reason == "needs 5,000 packets; there are 900"


def test_the_fragment_is_a_part_of_a_scene(tmp_path: Path) -> None:
    lost = gilbert(np.random.default_rng(5), 5000, 0.02, 0.05, 4.0)
    index = np.flatnonzero(~lost).astype(float)
    file = packets_csv(tmp_path, "p.csv", "index,time_s", index, 0.05 * index)
    result = pb.fit([file], radio=True)
    assert isinstance(result, RadioFit)
    written, picture, *_ = write_fit(result, tmp_path / "radio")
    assert isinstance(written, Path) and isinstance(picture, Path)
    text = written.read_text()
    keys = {f"radio.{key}": value for key, value in tomllib.loads(text)["radio"].items()}
    assert keys == result.keys
    assert "# latency_s: times of one way" in text
    assert picture.stat().st_size > 10000
    burst = by_key(result)["radio.burst_s"]
    assert burst.low is not None and burst.high is not None
    assert burst.low < 0.2 < burst.high
    assert pb.load_scene("paper", keys).radio.burst_s == keys["radio.burst_s"]


@needs_data
def test_packets_of_an_nrf24_are_lost_nearly_alone(tmp_path: Path) -> None:
    """At 50 m and 1 Mbit/s: 0.32 %, in bursts of 1.04 packets."""
    with lzma.open(DATA / "nrf24-19032025-50m1mbps.csv.xz", "rt") as text:
        table = np.loadtxt(text, delimiter=",", skiprows=1, usecols=(1, 2))
    file = packets_csv(tmp_path, "n.csv", "index,time_s", table[:, 1], table[:, 0] / 1000)
    found = fit_radio([file])
    assert by_key(found)["packets_lost"].value == pytest.approx(0.0032, abs=5e-5)
    assert found.burst_packets == pytest.approx(1.04, abs=0.005)


@needs_data
def test_round_trips_of_a_moving_robot(tmp_path: Path) -> None:
    """ROS 2: the median is 4.9 ms, and p99 59 ms."""
    with lzma.open(DATA / "ros2-round-trips-036.csv.xz", "rt") as text:
        trips = np.loadtxt(text)
    found = by_key(fit_radio([packets_csv(tmp_path, "r.csv", "round_trip_s", trips / 1000)]))
    assert found["round_trip_median_s"].value == pytest.approx(0.0049, abs=5e-5)
    assert found["round_trip_p99_s"].value == pytest.approx(0.059, abs=1e-3)
    tail = found["round_trip_p99_9_s"]
    assert tail.low is not None and tail.high is not None
    assert tail.low > 0.5


@needs_data
def test_packets_of_wifi_at_a_tenth_of_a_second_are_lost_nearly_independently() -> None:
    """Of 4060 links: where 5 to 50 % of 300 packets were lost, a burst is in the median less than
    a third longer than with independent losses."""
    ratios = []
    with tarfile.open(DATA / "wifi-rutgers-4060-links.tar.xz") as links:
        for member in links:
            if not Path(member.name).name.startswith("sdec"):
                continue
            stored = links.extractfile(member)
            text = stored.read().decode() if stored is not None else ""
            if text.count("\n") < 50:
                continue
            index = np.unique(np.loadtxt(io.StringIO(text), usecols=0, ndmin=1).astype(int))
            gaps = np.diff(index) - 1
            lost = gaps.sum()
            rate = lost / (lost + len(gaps))
            if 0.05 < rate < 0.5:
                ratios.append(lost / (gaps > 0).sum() * (1 - rate))
    assert len(ratios) > 50
    assert 0.95 < np.median(ratios) < 1.33
