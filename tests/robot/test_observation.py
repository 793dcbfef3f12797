# SPDX-License-Identifier: Apache-2.0
"""A program that watches a robot's program: it comes and goes, and never disturbs."""

import os
import signal
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.pair.stored_state import StateFile
from palmbots.robot.observation import Observation, Observations, Observer, observation_socket

SEEN = Observation(
    time_s=1.0, mode="carrying", fault="none", sign=-1, has_contact=True, palm_at_target=False,
    palm_rad=0.25, speed_m_s=0.06, distance_m=None, battery_v=7.4, overruns=3,
    received={"accepted": 5, "stale": 1},
)  # fmt: skip
LOOKS = 51  # ticks after which the robot's program has looked once more


def watched(observer: Observer) -> bool:
    return any(observer.is_watched for _ in range(LOOKS))


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """In a folder whose name alone is longer than an address of a socket may be."""
    folder = tmp_path / ("long" * 30)
    folder.mkdir()
    return observation_socket(StateFile(folder / "left.json", 0, "left"))


def test_watching_begins_and_ends_at_any_time(place: Path) -> None:
    observer = Observer(place)
    assert not watched(observer)
    observer.send(SEEN)  # to nobody
    for _ in range(2):
        watcher = Observations(place)
        assert watched(observer)
        observer.send(SEEN)
        observer.send(replace(SEEN, distance_m=0.5))
        first, second = watcher.receive(5)
        assert (first, second.distance_m) == (SEEN, 0.5)
        assert watcher.receive(0) == []
        watcher.close()
        assert not place.exists()
        observer.send(SEEN)
        assert not watched(observer)
    observer.close()


def test_a_watching_program_that_is_frozen_does_not_hold_up_the_robot(place: Path) -> None:
    watcher, observer = Observations(place), Observer(place)
    assert watched(observer)
    for tick in range(5000):  # more than the queue of a socket holds
        observer.send(replace(SEEN, time_s=float(tick)))
    arrived = watcher.receive(1)
    assert [one.time_s for one in arrived] == [float(i) for i in range(len(arrived))]
    assert 0 < len(arrived) < 5000
    observer.send(SEEN)
    assert watcher.receive(1) == [SEEN]
    observer.close()
    watcher.close()


def test_a_second_watching_program_is_refused(place: Path) -> None:
    watcher = Observations(place)
    with pytest.raises(pb.PalmbotsError) as caught:
        Observations(place)
    assert str(caught.value) == f"{place}: another program watches this robot already"
    watcher.close()


def test_a_killed_watching_program_is_replaced(place: Path) -> None:
    program = (
        "import pathlib, sys, time; from palmbots.robot.observation import Observations; "
        "w = Observations(pathlib.Path(sys.argv[1])); print('up', flush=True); time.sleep(60)"
    )
    killed = subprocess.Popen(
        [sys.executable, "-c", program, str(place)], stdout=subprocess.PIPE, text=True
    )
    assert killed.stdout is not None
    assert killed.stdout.readline() == "up\n"
    observer = Observer(place)
    assert watched(observer)
    os.kill(killed.pid, signal.SIGKILL)
    killed.communicate()
    assert place.exists()
    observer.send(SEEN)
    assert not watched(observer)
    watcher = Observations(place)
    assert watched(observer)
    observer.send(SEEN)
    assert watcher.receive(5) == [SEEN]
    observer.close()
    watcher.close()


@pytest.mark.parametrize(
    "data", [b"", b"x", b"[]", b"{}", b"[" * 60_000, b'{"mode": "carrying"}', b"\xff"]
)
def test_other_datagrams_are_ignored(data: bytes, tmp_path: Path) -> None:
    place = tmp_path / "w"
    watcher = Observations(place)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as stranger:
        stranger.sendto(data, str(place))
    assert watcher.receive(0.1) == []
    watcher.close()


def test_an_unknown_mode_is_ignored(place: Path) -> None:
    watcher, observer = Observations(place), Observer(place)
    assert watched(observer)
    unknown: Any = "dancing"
    observer.send(replace(SEEN, mode=unknown))
    observer.send(replace(SEEN, fault=unknown))
    observer.send(SEEN)
    assert watcher.receive(5) == [SEEN]
    observer.close()
    watcher.close()


def test_nobody_watches_in_a_folder_that_is_missing(tmp_path: Path) -> None:
    assert not watched(Observer(tmp_path / "none" / "left.watch"))
