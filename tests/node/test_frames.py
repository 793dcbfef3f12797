# SPDX-License-Identifier: Apache-2.0
"""Connections between processes, over real sockets."""

import threading
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.node.frames import Connection, ConnectionLost, connect, listen


def pair_of(address: str) -> tuple[Connection, Connection]:
    door = listen(address)
    if not address.startswith("unix:"):
        address = "{}:{}".format(*door.getsockname())
    near = connect(address, "far", within_s=10)
    stream, _ = door.accept()
    door.close()
    return near, Connection(stream, "near")


@pytest.fixture(params=["127.0.0.1:0", "unix"])
def ends(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Connection, Connection]:
    address = f"unix:{tmp_path / 's'}" if request.param == "unix" else request.param
    return pair_of(address)


def test_frames_arrive_whole_and_in_order(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    frames = [["left", 1], "end", None, {"long": "x" * 300_000}, 5]
    sender = threading.Thread(target=lambda: [near.send(frame) for frame in frames])
    sender.start()
    assert [far.receive(10) for _ in frames] == frames
    sender.join()
    far.send([1])
    assert near.receive(10) == [1]
    near.close()
    far.close()


def test_a_closed_end_and_silence_are_named(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    with pytest.raises(ConnectionLost, match=r"^near: no answer within 0.01 s$"):
        far.receive(0.01)
    near.close()
    with pytest.raises(ConnectionLost, match=r"^near: has closed the connection$"):
        far.receive(10)
    far.close()
    with pytest.raises(ConnectionLost, match=r"^near: "):
        far.send(1)


def test_what_is_no_frame_is_refused(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    near._stream.sendall(b"\xff\n")
    with pytest.raises(ConnectionLost, match=r"^near: sends no frames$"):
        far.receive(10)
    near.close()
    far.close()


@pytest.mark.parametrize("address", ["", "7400", "host:", ":7400", "host:port", "h:99999", "unix:"])
def test_addresses_are_checked(address: str) -> None:
    for use in (listen, lambda a: connect(a, "world", 0)):
        with pytest.raises(pb.PalmbotsError, match=r"^address: value is .*; allowed: HOST:PORT, "):
            use(address)


def test_nobody_listens(tmp_path: Path) -> None:
    with pytest.raises(ConnectionLost, match=r"^world: nobody listens at unix:.*: No such file"):
        connect(f"unix:{tmp_path / 's'}", "world", 0.05)
    with pytest.raises(pb.PalmbotsError, match=r"cannot listen: "):
        listen(f"unix:{tmp_path / 'no' / 's'}")
