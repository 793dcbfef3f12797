# SPDX-License-Identifier: Apache-2.0
"""The measured radio against the one that was simulated, and what it means for the controllers."""

import math
from pathlib import Path

import pytest

import palmbots as pb
from palmbots._types import Side
from palmbots._util.plain_values import plain
from palmbots.pair.link_check import PERIOD_S, LinkFigures, measure, needs_of
from palmbots.station.simulated_pair import Air, SimulatedPair


def measured(folder: Path, air: Air, seconds: float = 60.0) -> dict[Side, LinkFigures]:
    pair = SimulatedPair(folder, "resilient", air)
    pair.station.step = lambda: None  # the measurement takes its place
    link = air.link("station")
    return measure(
        pair.pair,
        link,
        epoch=2,
        seconds=seconds,
        clock=lambda: 0.01 * air.now,
        wait=lambda: pair.run(round(PERIOD_S / 0.01)),
    )


def test_a_perfect_radio_has_no_losses(tmp_path: Path) -> None:
    for one in measured(tmp_path, Air(delay_ms=30), 5).values():
        assert (one.lost, one.loss, one.mode) == (0, 0.0, "disarmed")
        # There and back, and until the robot answers and the station looks.
        assert all(0.06 <= trip <= 0.06 + 0.11 for trip in one.round_trips_s)


def test_losses_are_those_of_the_radio(tmp_path: Path) -> None:
    for one in measured(tmp_path, Air(delay_ms=20, loss=0.2, seed=3)).values():
        sent = one.received + one.lost
        assert sent > 1000
        assert one.loss == pytest.approx(0.2, abs=4 * math.sqrt(0.2 * 0.8 / sent))


def test_copies_of_packets_are_not_counted(tmp_path: Path) -> None:
    for one in measured(tmp_path, Air(delay_ms=20, duplicate=0.5, seed=3), 10).values():
        assert one.lost == 0
        assert one.received == len(one.arrivals)


def test_a_robot_that_is_not_there_has_no_figures(tmp_path: Path) -> None:
    air = Air()
    air.cut(("left", "station"))
    figures = measured(tmp_path, air, 3)
    assert figures["left"].received == 0
    assert math.isnan(figures["left"].round_trip_s(0.5))
    assert figures["right"].received > 10
    assert plain(figures["left"])["round_trip_median_s"] is None


def test_quantiles_are_those_of_the_sorted_times() -> None:
    one = LinkFigures(round_trips_s=[0.01 * n for n in range(100, 0, -1)])
    assert one.round_trip_s(0.5) == pytest.approx(0.50)
    assert one.round_trip_s(0.99) == pytest.approx(0.99)
    assert one.round_trip_s(1.0) == pytest.approx(1.00)


def test_what_a_radio_means_for_the_controllers() -> None:
    scene = pb.load_scene("paper")
    good = needs_of(scene, 0.01, 0.0)
    assert set(good.verdicts.values()) == {"suffices"}
    assert good.lease_s == pytest.approx(2 * (0.01 + scene.radio.beacon_s + 0.01))
    lossy = needs_of(scene, 0.01, 0.1)
    assert lossy.verdicts["distributed"] == "a lost message can make it hang"
    assert lossy.verdicts["silent"] == "suffices"
    # In an hour of beacons, a run of losses that long is expected at most once.
    in_a_row = round((lossy.lease_s - good.lease_s) / scene.radio.beacon_s)
    beacons = 3600 / scene.radio.beacon_s
    assert beacons * 0.1**in_a_row <= 1 < beacons * 0.1 ** (in_a_row - 1)
    # With more loss the partner is silent for longer than its news counts.
    assert lossy.verdicts["shared-sign"] == "suffices" and lossy.lease_s < 0.5
    bad = needs_of(scene, 0.04, 0.2)
    assert bad.lease_s > 0.5 and bad.verdicts["shared-sign"] == "suffices"
    stops = needs_of(scene, 0.04, 0.2, stops_without_partner=True)
    assert 'set limits.partner_lost = "controller"' in stops.verdicts["shared-sign"]
    assert stops.verdicts["silent"] == "suffices"
    slow = needs_of(scene, 1.0, 0.0)
    assert slow.verdicts["resilient"] != "suffices"
    assert slow.verdicts["silent"] == "suffices"
