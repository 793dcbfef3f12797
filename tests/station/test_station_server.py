# SPDX-License-Identifier: Apache-2.0
"""Screens of a station over real sockets, on a clock of the test."""

import json
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from palmbots.station.station_client import StationClient
from palmbots.station.station_server import SILENT_S, StationServer
from waiting import wait_until

FACTS = {"pair": 7, "controller": "resilient", "scene": "paper", "process": 1}


class Place:
    """A station's server, and its clock."""

    def __init__(self, folder: Path) -> None:
        self.now = 0.0
        # Longer than a socket's path may be.
        long = folder / ("f" * 120)
        long.mkdir()
        self.path = long / "station.socket"
        self.server = StationServer(f"unix:{self.path}", FACTS, lambda: self.now)
        self.clients: list[StationClient] = []
        self.wished: list[str] = []

    def client(self, role: Any = "operator") -> StationClient:
        import threading

        opened: list[StationClient] = []
        thread = threading.Thread(
            target=lambda: opened.append(StationClient(f"unix:{self.path}", role, 10))
        )
        thread.start()
        wait_until(lambda: (self.step(), opened)[1])
        thread.join()
        self.step()  # takes in what it wants to be
        self.clients += opened
        return opened[0]

    def step(self, state: Any = None) -> None:
        self.wished += self.server.wishes()
        self.server.publish(state or {"time_s": self.now})


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Place]:
    made = Place(tmp_path)
    yield made
    made.server.close({"done": True}, within_s=0.1)
    for client in made.clients:
        client.close()


def test_only_the_user_may_connect(place: Place) -> None:
    assert stat.S_IMODE(os.stat(place.path).st_mode) == 0o600


def test_wishes_states_and_lines_pass(place: Place) -> None:
    place.server.lines += ["first", "second"]
    client = place.client()
    assert client.facts == FACTS
    client.wish("arm")
    client.wish("quit")
    wait_until(lambda: (place.step(), len(place.wished) == 2)[1])
    assert place.wished == ["arm", "quit"]
    place.server.lines.append("third")
    wait_until(lambda: (place.step({"n": 5}), client.poll(), client.state == {"n": 5})[2])
    wait_until(lambda: (place.step({"n": 5}), client.poll(), len(client.lines) == 3)[2])
    assert client.lines == ["first", "second", "third"]


def test_a_screen_that_reads_nothing_holds_nobody_up_and_misses_no_line(place: Place) -> None:
    slow, fast = place.client("viewer"), place.client()
    state = {"text": "x" * 5000}
    for k in range(400):  # much more than a socket holds
        place.server.lines.append(f"line {k}")
        place.step(state)
        fast.poll()
    wait_until(lambda: (place.step(), fast.poll(), len(fast.lines) == 400)[2])
    wait_until(lambda: (place.step(), slow.poll(), len(slow.lines) == 400)[2])
    assert slow.lines == fast.lines == [f"line {k}" for k in range(400)]


def test_an_operator_that_is_silent_or_gone_does_not_count(place: Place) -> None:
    assert not place.server.had_operator
    first = place.client()
    wait_until(lambda: (place.step(), place.server.has_operator)[1])
    place.now += SILENT_S + 0.1
    assert not place.server.has_operator
    first.wish("arm")  # it has only been slow
    wait_until(lambda: (place.step(), place.server.has_operator)[1])
    place.client("viewer")
    first.close()
    wait_until(lambda: (place.step(), not place.server.has_operator)[1])
    assert place.server.had_operator


@pytest.mark.parametrize(
    "frames",
    [
        [{"screen": "viewer"}, {"wish": "start"}],
        [{"wish": "start"}],
        [{"screen": "operator"}, {"wish": "fly"}],
        [{"screen": "operator"}, {"wish": ["arm"]}],
        [{"screen": "king"}, {"wish": "arm"}],
        [["screen"]],
        [5],
    ],
)
def test_what_a_screen_may_not_say_ends_its_connection(place: Place, frames: list[Any]) -> None:
    good = place.client()
    stranger = socket.socket(socket.AF_UNIX)
    folder = os.open(place.path.parent, os.O_RDONLY)
    stranger.connect(f"/proc/self/fd/{folder}/station.socket")
    os.close(folder)
    stranger.sendall(b"".join(json.dumps(frame).encode() + b"\n" for frame in frames))
    stranger.settimeout(0.01)

    def is_closed() -> bool:
        place.step()
        try:
            while stranger.recv(65536):
                pass
        except TimeoutError:
            return False
        except ConnectionResetError:
            pass
        return True

    wait_until(is_closed)
    stranger.close()
    assert place.wished == []
    good.wish("arm")
    wait_until(lambda: (place.step(), place.wished == ["arm"])[1])


def test_the_end_reaches_every_screen(place: Place) -> None:
    clients = [place.client(), place.client("viewer")]
    place.server.lines.append("last")
    place.server.close({"done": False}, within_s=5)
    for client in clients:
        wait_until(lambda client=client: (client.poll(), not client.is_connected)[1])
        assert client.end == {"done": False}
        assert client.lines == ["last"]
    assert not place.path.exists()


def test_a_screen_that_reads_only_half_of_the_end_is_left(place: Place) -> None:
    place.client()
    place.server.close({"done": True, "lines": ["x" * 10_000_000]}, within_s=0.05)
