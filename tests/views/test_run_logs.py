# SPDX-License-Identifier: Apache-2.0
"""Logs of robots and station: verified bit by bit, aligned, cut off, and on a full disk."""

import contextlib
import copy
import random
import resource
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from logged_pairs import LoggedPair, simulated_clock
from palmbots.cli.station_text import plain_status
from palmbots.control.registry import describe, shipped_names
from palmbots.errors import PalmbotsError
from palmbots.logs.run_channels import LineEvent
from palmbots.logs.run_log_reader import is_run_log, read_run_log, run_log_of
from palmbots.logs.run_log_writer import RunLogWriter
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air
from palmbots.views.log_alignment import ClockFit, Traffic, align, fit, from_station
from palmbots.views.logged_carries import logged_carries
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run, replay_run, verify
from palmbots.wire import decode

CONTROLLERS = shipped_names("robots")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    return simulated_clock(monkeypatch)


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_the_logs_of_a_carry_are_verified(controller: str, tmp_path: Path, clock: Any) -> None:
    air = Air(delay_ms=30, loss=0.1, jitter_ms=20, duplicate=0.1, seed=4)
    clock["air"] = air
    pair = LoggedPair(tmp_path, controller, air, UP, {"task.distance_m": 0.15})
    pair.carry()
    folder = pair.written()
    names = sorted(file.name for file in folder.iterdir())
    assert names == ["left-000001.mcap", "right-000001.mcap", "station-000001.mcap"]
    run = read_run([folder])
    result = replay_run(run)
    assert result.identical, result.logs
    assert [log.verified for log in result.logs[:2]] == [pair.air.now, pair.air.now]
    assert not any(log.is_cut for log in result.logs)
    for one in result.clocks:  # all have the same clock here
        assert one.offset_s == pytest.approx(0, abs=one.uncertainty_s + 1e-9)
        assert one.rate == pytest.approx(1, abs=2e-3)
        assert one.uncertainty_s < 0.08
    carry = carry_of(run, result.clocks)
    if controller != "distributed":  # which a loss can hang
        assert carry.outcome == "delivered"
        assert carry.distance_m == pytest.approx(0.15, abs=0.02)
        assert {(one.robot, one.end) for one in result.carries} == {
            ("left", "done"),
            ("right", "done"),
        }
        assert all(one.covered > 0.9 for one in result.carries)
    assert bool(carry.message_log) == describe(controller).uses_radio


def test_no_packet_of_a_log_has_the_tag_of_the_pair(tmp_path: Path) -> None:
    """A log may be passed on: it holds neither the key nor a packet that a robot accepts."""
    pair = LoggedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.run(100)
    folder = pair.written()
    number = pair.pair.settings.pair.number
    packets = 0
    for file in folder.iterdir():
        assert pair.pair.key not in file.read_bytes()
        assert pair.pair.key.hex().encode() not in file.read_bytes()
        log = read_run_log(file)
        for _, tick in log.messages["ticks"]:
            for data in tick.received:
                packets += 1
                assert decode(data, pair.pair.key, number, log.end).verdict == "bad_tag"
                assert decode(data, bytes.fromhex(log.facts["key"]), number, log.end).packet
    assert packets > 20


def test_every_boot_has_a_log_of_its_own(tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "resilient", Air(delay_ms=20), UP)
    pair.start()
    pair.run(100)
    pair.boot("left")
    pair.run(100)
    pair.restart_station()
    pair.run(50)
    folder = pair.written()
    assert sorted(file.name for file in folder.iterdir()) == [
        "left-000001.mcap", "left-000002.mcap", "right-000001.mcap", "station-000001.mcap",
        "station-000002.mcap",
    ]  # fmt: skip
    result = replay_run(read_run([folder]))
    assert result.identical, result.logs
    assert [log.boots for log in result.logs] == [1, 2, 1, 1, 2]


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("sign", lambda tick: -1 if tick.sign == 1 else 1),
        ("palm", lambda tick: 1 - tick.palm),
        ("mode", lambda _: "done"),
        ("wheels", lambda tick: not tick.wheels),
        ("elapsed", lambda tick: tick.elapsed + 3),
        ("covered", lambda tick: not tick.covered),
    ],
)
def test_a_changed_decision_or_input_is_found(field: str, change: Any, tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.run(60)
    log = read_run_log(pair.written() / "left-000001.mcap")
    place = next(k for k, (_, tick) in enumerate(log.messages["ticks"]) if tick.wheels) + 5
    tick = log.messages["ticks"][place][1]
    setattr(tick, field, change(tick))
    found = verify(log)
    assert found.difference is not None
    assert place <= found.verified <= place + 3


def test_a_changed_packet_or_a_gap_is_found(tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "distributed", Air(), UP)
    pair.start()
    pair.run(60)
    path = pair.written() / "right-000001.mcap"
    log = read_run_log(path)
    ticks = log.messages["ticks"]
    place = next(k for k, (_, tick) in enumerate(ticks) if k > 50 and tick.sent)
    sent = ticks[place][1].sent[0]
    ticks[place][1].sent[0] = sent[:-1] + bytes([sent[-1] ^ 1])
    found = verify(log)
    assert found.verified == place
    assert f"tick {place + 1}: sent was " in (found.difference or "")
    log = read_run_log(path)
    del log.messages["ticks"][40:43]
    assert verify(log).difference == "the ticks 41 to 43 are missing"


def test_a_log_without_an_end_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.run(1500)
    file = pair.written() / "left-000001.mcap"
    whole = file.read_bytes()
    count = len(read_run_log(file).messages["ticks"])
    chance = random.Random(3)
    lengths = set()
    for share in (0.4, 0.6, 0.8, 0.95, 0.999):
        file.write_bytes(whole[: int(share * len(whole)) - chance.randrange(50)])
        log = read_run_log(file)
        assert log.is_cut
        found = verify(log)
        assert found.difference is None
        lengths.add(found.verified)
        assert found.verified <= count
        if log.messages["ticks"][-1][1].wheels:
            (carry,) = logged_carries([log], ())
            assert carry.end == "its program was killed, or its disk was full"
    assert len(lengths) > 2
    file.write_bytes(whole[:100])
    with pytest.raises(pb.PalmbotsError, match="is no log of a robot or station"):
        read_run_log(file)


def test_damaged_facts_of_a_log_are_one_line(tmp_path: Path) -> None:
    """Each entry is missing, of another type or out of range, as a right checksum can hide."""
    pair = LoggedPair(tmp_path, "resilient", Air(), UP)
    pair.run(20)
    log = next(log for log in read_run([pair.written()]) if log.end == "left")
    wrong = (None, "x", True, -1, 2**40, 1.5, [], {}, "€")
    usual, names = log.facts, ("end", "epoch", "pair", "key", "scene", "controller", "state")
    nested = [("state", name) for name in usual["state"]]
    nested += [("settings", name) for name in usual["settings"]]
    places = [(name,) for name in (*names, "settings", "controller_source")] + nested
    chance = random.Random(3)
    for place in places:
        for value in (*chance.sample(wrong, 3), "missing"):
            facts = copy.deepcopy(usual)
            table = facts if len(place) == 1 else facts[place[0]]
            if value == "missing":
                del table[place[-1]]
            else:
                table[place[-1]] = value
            with contextlib.suppress(pb.PalmbotsError):
                verify(run_log_of(log.path, facts, log.messages, is_cut=False))


def test_a_packet_to_an_unknown_end_takes_no_part_in_the_alignment(tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "resilient", Air(), UP)
    pair.run(20)
    logs = read_run([pair.written()])
    left = next(log for log in logs if log.end == "left")
    said = next(tick for _, tick in left.messages["ticks"] if tick.receivers)
    said.receivers[:] = [255] * len(said.receivers)
    found = next(one for one in replay_run(logs).logs if one.end == "left")
    assert found.difference is not None and "receivers" in found.difference


def test_other_files_are_no_logs_of_runs(tmp_path: Path) -> None:
    other = tmp_path / "other.mcap"
    other.write_bytes(b"no log")
    assert not is_run_log(other)
    assert not is_run_log(tmp_path / "missing")


def test_logs_of_two_pairs_are_not_one_run(tmp_path: Path) -> None:
    files = []
    for k in (1, 2):
        (tmp_path / str(k)).mkdir()
        pair = LoggedPair(tmp_path / str(k), "silent", Air(), UP | {"pair.number": k})
        pair.run(20)
        files.append(pair.written() / "left-000001.mcap")
    with pytest.raises(pb.PalmbotsError, match="are of the pairs 1, 2; allowed: logs of one pair"):
        replay_run(read_run(files))


def talk(offset_s: float, rate: float, delay: Any, count: int = 2000) -> tuple[Traffic, Traffic]:
    """Two programs that send each other packets; t_other = offset + rate · t_own."""
    own, other = Traffic({}, {}), Traffic({}, {})
    for k in range(count):
        now = 0.01 * k
        there = ("left", "right", 1, k)
        own.sent[there] = now
        other.received[there] = offset_s + rate * (now + delay())
        back = ("right", "left", 1, k)
        other.sent[back] = offset_s + rate * now
        own.received[back] = now + delay()
    return own, other


@pytest.mark.parametrize("rate", [1.0, 1.02, 0.9995])
@pytest.mark.parametrize("offset_s", [0.0, -1234.5])
def test_alignment_finds_offset_and_rate(offset_s: float, rate: float) -> None:
    chance = np.random.default_rng(5)
    own, other = talk(offset_s, rate, lambda: 0.02 + chance.exponential(0.02))
    found = fit(own, other)
    assert found is not None
    got_offset, got_rate, uncertainty_s, packets = found
    assert packets == 4000
    assert got_rate == pytest.approx(rate, abs=2e-4)
    for time_s in (0.0, 10.0, 20.0):  # anywhere in the run
        error = got_offset + got_rate * time_s - (offset_s + rate * time_s)
        assert abs(error) <= uncertainty_s
    assert 0.015 < uncertainty_s < 0.03


def test_alignment_holds_with_delays_in_one_direction_only() -> None:
    """The true offset is within the margin, although it is not in its middle."""
    slow = iter([0.05, 0.0] * 4000)
    own, other = talk(3.0, 1.0, lambda: next(slow))
    found = fit(own, other)
    assert found is not None
    assert abs(found[0] - 3.0) <= found[2] + 1e-9
    assert found[2] == pytest.approx(0.025, abs=1e-3)
    assert fit(Traffic({}, {}), other) is None


def test_logs_without_common_packets_are_of_several_runs(tmp_path: Path) -> None:
    pair = LoggedPair(tmp_path, "silent", Air(loss=1.0), UP)
    pair.run(50)
    logs = read_run([pair.written()])
    clocks = align(logs)
    assert [one.run for one in clocks] == [1, 2, 3]
    with pytest.raises(PalmbotsError, match="no packets connect those of both robots"):
        carry_of(logs, clocks)


def test_each_run_of_a_folder_has_a_clock(tmp_path: Path, clock: Any) -> None:
    """All programs start again, on a clock that starts again; the figure shows the last run."""
    clock["air"] = air = Air(delay_ms=20)
    pair = LoggedPair(tmp_path, "resilient", air, UP, {"task.distance_m": 0.1})
    pair.carry()
    pair.boot("left")
    pair.boot("right")
    pair.restart_station()
    pair.carry()
    logs = read_run([pair.written()])
    clocks = align(logs)
    assert [one.run for one in clocks] == [1, 2, 1, 2, 1, 2]
    assert all(abs(one.offset_s) <= one.uncertainty_s + 1e-9 for one in clocks)
    carries = logged_carries(logs, clocks)
    assert [(one.run, one.end) for one in carries] == [(1, "done")] * 2 + [(2, "done")] * 2
    assert carry_of(logs, clocks).distance_m == pytest.approx(0.1, abs=0.02)


def under_way(folder: Path, clock: Any) -> LoggedPair:
    """A pair that carries."""
    clock["air"] = air = Air(delay_ms=20)
    pair = LoggedPair(folder, "resilient", air, UP)
    pair.start()
    pair.run(100)
    return pair


def test_an_e_stop_and_who_wants_it_are_seen(tmp_path: Path, clock: Any) -> None:
    """In the lines of the station, in what a screen shows, and in the table of a replay."""
    pair = under_way(tmp_path, clock)
    pair.wish("e_stop", "stopped")
    pair.run(20)
    assert [line.split(" s  ")[1] for line in pair.lines if "stopped" in line] == [
        "left: stopped (operator: e-stop)",
        "right: stopped (operator: e-stop)",
    ]
    frame = pair.station.frame()
    assert {robot["reason"] for robot in frame["robots"].values()} == {"operator: e-stop"}
    assert all("stopped (operator: e-stop)" in line for line in plain_status(frame)[:2])
    pair.wish("release", "disarmed")
    pair.run(20)
    frame = pair.station.frame()
    assert {robot["reason"] for robot in frame["robots"].values()} == {""}
    assert (frame["wish"], frame["wish_is_done"]) == ("release", True)
    result = replay_run(read_run([pair.written()]))
    assert [one.end for one in result.carries] == ["stopped (operator: e-stop)"] * 2


def test_a_stop_by_hand_is_not_taken_for_an_order(tmp_path: Path, clock: Any) -> None:
    pair = under_way(tmp_path, clock)
    pair.press("left", "stop")
    pair.run(100)
    pair.wish("stop", "stopped")
    pair.run(20)
    assert {robot["reason"] for robot in pair.station.frame()["robots"].values()} == {""}
    ends = {one.end for one in replay_run(read_run([pair.written()])).carries}
    assert ends == {"stopped by hand, its partner or the station"}


# Writes a log of many lines in a process that may write at most so many bytes to a file, or to a
# disk that is full.
WRITING = """
import sys, time
from pathlib import Path
from palmbots.logs.run_channels import LineEvent
from palmbots.logs.run_log_writer import RunLogWriter
import os
log = RunLogWriter(Path(sys.argv[1]), "station", 1, {"pair": 1}, print)
for _ in range(20000):
    log.add("/station/lines", lambda: LineEvent(text=os.urandom(100).hex()))
    while log._queue.qsize() > 100:  # the disk is full, not slow
        time.sleep(0.001)
log.close()
print("goes on")
"""


def test_a_full_disk_costs_one_warning_and_the_rest_of_the_log(tmp_path: Path) -> None:
    limit = 200_000

    def little_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = subprocess.run(
        [sys.executable, "-c", WRITING, str(tmp_path)], preexec_fn=little_room,
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.stderr == ""
    warning, rest = done.stdout.splitlines()
    assert warning.startswith(f"log: {tmp_path}/station-000001.mcap: File too large; the rest")
    assert rest == "goes on"
    log = read_run_log(tmp_path / "station-000001.mcap")
    assert log.is_cut
    assert len(log.messages["lines"]) > 100


def test_a_folder_that_cannot_be_made_costs_one_warning(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    warnings: list[str] = []
    log = RunLogWriter(tmp_path / "file" / "logs", "left", 1, {}, warnings.append)
    for _ in range(100):
        log.add("/left/lines", lambda: LineEvent(text="a"))
    log.close()
    assert len(warnings) == 1
    assert "the rest of this run is not logged" in warnings[0]


def test_an_older_log_is_kept(tmp_path: Path) -> None:
    for text in ("first", "second"):
        log = RunLogWriter(tmp_path, "station", 7, {"pair": 1}, print)
        log.add("/station/lines", lambda text=text: LineEvent(text=text))
        log.close()
    texts = [
        read_run_log(tmp_path / name).messages["lines"][0][1].text
        for name in ("station-000007.mcap", "station-000007-1.mcap")
    ]
    assert texts == ["first", "second"]


def test_nothing_is_drawn_where_the_log_of_a_robot_has_a_gap(tmp_path: Path, clock: Any) -> None:
    """The program of the right robot was killed in the carry; the left one drives on."""
    clock["air"] = air = Air()
    pair = LoggedPair(tmp_path, "resilient", air, UP)
    pair.start()
    pair.run(400)
    left, right, *others = read_run([pair.written()])
    cut = replace(right, messages=right.messages | {"ticks": right.messages["ticks"][:-100]})
    logs = [left, cut, *others]
    trace = carry_of(logs, replay_run(logs).clocks).trace
    assert trace is not None
    separation = trace["separation"].to_numpy()
    assert np.isfinite(separation[:-100]).all()
    assert np.isnan(separation[-90:]).all()


def test_figures_of_a_damaged_log_are_refused_in_one_line(tmp_path: Path, clock: Any) -> None:
    """A right checksum hides the damage."""
    clock["air"] = air = Air()
    pair = LoggedPair(tmp_path, "resilient", air, UP)
    pair.start()
    pair.run(60)
    logs = read_run([pair.written()])
    clocks = replay_run(logs).clocks
    ticks = next(log for log in logs if log.end == "right").messages["ticks"]
    now_s, usual = ticks[-1]
    assert usual.wheels
    wrong: dict[str, Any] = {
        "palm": 2, "move": 3, "sign": 7, "case": "€", "receivers": [1] * 4, "words": [2**40],
    }  # fmt: skip
    for field, value in wrong.items():
        tick = copy.deepcopy(usual)
        if isinstance(value, list):
            getattr(tick, field)[:] = value
        else:
            setattr(tick, field, value)
        ticks[-1] = (now_s, tick)
        with pytest.raises(pb.PalmbotsError, match=rf"is damaged: its tick {len(ticks)} "):
            carry_of(logs, clocks)
    ticks[-1] = (1e9, usual)
    with pytest.raises(pb.PalmbotsError, match="never turned at once"):
        carry_of(logs, clocks)


def test_times_are_those_that_the_station_prints() -> None:
    """Where the log of a station is in the run, its clock is the reference of all three."""
    clocks = (
        ClockFit("left", 0.0, 1.0, 0.0, 0),
        ClockFit("right", 0.1, 1.001, 0.02, 50),
        ClockFit("station", -0.258, 1.00002, 0.05, 40),
        ClockFit("left", 0.0, 1.0, 0.0, 0, 2),  # of a run without a station
    )
    ends = ("left", "right", "station", "left")
    logs: list[Any] = [SimpleNamespace(end=end) for end in ends]
    found = from_station(clocks, logs)
    assert found[2:] == (ClockFit("station", 0.0, 1.0, 0.0, 0), clocks[3])
    for one, before in zip(found[:2], clocks[:2], strict=True):
        for time_s in (0.0, 7.0, 100.0):
            shown = clocks[2].to_reference(one.to_reference(time_s))
            assert shown == pytest.approx(before.to_reference(time_s), abs=1e-12)
        assert one.uncertainty_s == pytest.approx(before.uncertainty_s + 0.05, rel=1e-3)
        assert one.packets == (before.packets or 40)
